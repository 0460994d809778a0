// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/law.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

namespace nscdd {

/// A frictional contact problem in the unknowns of its contacts: find impulses r and velocities u = W r + q that obey
/// Signorini's and Coulomb's laws. Contact c has D rows from D c on: (n, t) in the plane, D = 2, and (n, t_1, t_2) in
/// space, D = 3. W is stored in full. Impulses are in N s and velocities in m/s, or forces in N, displacements in m.
struct LocalFrictionProblem {
  SparseMatrix w;   ///< W, D c x D c, symmetric, 1/kg
  Vector q;         ///< relative velocities without contact impulses, D c entries
  Vector friction;  ///< coefficient of friction >= 0, c entries
  /// M and H if `reduce` computed W = H^T M^-1 H from them; else 0 x 0. Solvers that factorise are faster with them.
  SparseMatrix mass{}, h{};
  Index dimension = 2;  ///< D: 2 or 3
  /// c numbers, m/s: the norm over a contact of |H|^T |M^-1 f| + |w|, the speeds that cancel in q. Their rounding is
  /// the error of q. Empty unless by `reduce`.
  Vector speeds{};

  Index contacts() const { return friction.size(); }
  Index size() const { return dimension * contacts(); }  ///< D c
};

/// The same problem with the velocities v of the bodies as unknowns:
///     M v = H r + f,   u = H^T v + w.
struct GlobalFrictionProblem {
  SparseMatrix mass;    ///< M, n x n, symmetric positive definite, stored in full, kg (kg m^2)
  SparseMatrix h;       ///< H, n x D c
  Vector f;             ///< impulses of the loads and the momentum before, n entries
  Vector w;             ///< relative velocities that moving supports add, D c entries
  Vector friction;      ///< c entries
  Index dimension = 2;  ///< D: 2 or 3

  Index contacts() const { return friction.size(); }
  Index size() const { return dimension * contacts(); }
};

/// Throw Error, beginning with `name`, for sizes that do not fit together, numbers that are not finite, a negative
/// coefficient of friction, W or M that is not symmetric, and a contact whose D x D block of W is not positive
/// definite. `reduce` checks whether M is positive definite.
void check(const LocalFrictionProblem& problem, const std::string& name);
void check(const GlobalFrictionProblem& problem, const std::string& name);

/// The diagonal block W_c of a contact; an off-diagonal entry is the mean of both stored ones.
template <int D>
FullDelassus<D> diagonal_block(const LocalFrictionProblem& problem, Index contact) {
  const Index n = D * contact, t = n + 1;
  const auto mean = [&](Index i, Index j) { return (problem.w.coeff(i, j) + problem.w.coeff(j, i)) / 2; };
  if constexpr (D == 2)
    return {problem.w.coeff(n, n), mean(n, t), problem.w.coeff(t, t)};
  else
    return {problem.w.coeff(n, n),
            {mean(n, t), mean(n, t + 1)},
            {problem.w.coeff(t, t), mean(t, t + 1), problem.w.coeff(t + 1, t + 1)}};
}

/// Eliminates the velocities:  W = H^T M^-1 H,  q = H^T M^-1 f + w. Each connected piece of the pattern of M, in most
/// problems one body, is factorised separately, densely if it is small: W couples only contacts that share a piece.
/// Throws Error, beginning with `name`, for a problem that `check` refuses and an M that is not positive definite.
LocalFrictionProblem reduce(const GlobalFrictionProblem& problem, const std::string& name = "problem");

/// The linear problem of the same bodies: M is diagonal with three rows per body in the plane (two translations and a
/// rotation) and six in space (three of each), V^- = M^-1 f, and each of the D rows of a contact is a link. The
/// velocities w of supports change no operator and are left out. Throws Error, beginning with `name`, for a problem
/// that `check` refuses, an M that is not diagonal and positive, and other numbers of rows per body.
ReferenceProblem reference_problem(const GlobalFrictionProblem& problem, const std::string& name = "problem");

/// v = M^-1 (H r + f), n entries. The problem must be one that `reduce` accepts.
Vector body_velocities(const GlobalFrictionProblem& problem, const Vector& impulses);

}  // namespace nscdd
