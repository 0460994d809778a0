// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_matrix.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/core/processes.hpp>

namespace nscdd {

/// Reductions over all contacts of a problem, called by all ranks together. Vectors have D entries per contact of this
/// rank, which by default has all contacts. Otherwise contacts belong to subdomains, whose sums are added in their
/// order: no bit depends on the number of ranks.
struct ContactSums {
  std::vector<Index> part_of_contact = {};
  Index parts = 0;  ///< 0: all contacts are of this rank
  Processes processes = {};

  /// The sums of `quantities` numbers: add(c, sums) adds those of contact c, for c = 0 ... contacts - 1.
  Vector add_up(Index quantities, Index contacts, const auto& add) const {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(quantities, std::max<Index>(parts, 1));
    for (Index c = 0; c < contacts; ++c) add(c, sums.col(parts == 0 ? 0 : part_of_contact[at(c)]));
    return parts == 0 ? Vector(sums) : processes.sum_of_parts(std::move(sums));
  }
  double dot(const Vector& a, const Vector& b) const {
    if (parts == 0) return a.dot(b);
    const Index size = part_of_contact.empty() ? 0 : a.size() / count(part_of_contact);
    return add_up(1, count(part_of_contact),
                  [&](Index c, auto&& sum) { sum[0] += a.segment(size * c, size).dot(b.segment(size * c, size)); })[0];
  }
  double squared_norm(const Vector& a) const { return parts == 0 ? a.squaredNorm() : dot(a, a); }
  double norm(const Vector& a) const { return parts == 0 ? a.norm() : std::sqrt(dot(a, a)); }

  Index total(Index own) const { return processes.sum(own); }
  bool any(bool own) const { return processes.any(own); }
  bool all_zero(const Vector& a) const { return !any(!a.isZero(0)); }
  /// Of entries >= 0; infinite if one is not a number.
  double largest(const Vector& entries) const {
    double own = 0;
    for (const double entry : entries) own = std::isnan(entry) ? infinity : std::max(own, entry);
    return processes.maximum(own);
  }
};

/// The impulse that would bring a contact to rest, the others held:  r_c - W_c^-1 u_c.
template <int D>
LocalVector<D> stopping(const FullDelassus<D>& w, LocalVector<D> impulse, LocalVector<D> u) {
  return impulse - w.solve(u);
}

/// Some sweeps of a run. After each, impulses move on by `momentum` times their change since the sweep before:
///     r + momentum (r - r_before),   r_before = r at the first.
struct SweepTurn {
  Index first = 0, many = 0;  ///< numbers first, ..., first + many - 1
  double momentum = 0;        ///< in [0, 1)
};

/// The contacts of a problem u = W r + q. Vectors have D entries per contact of this rank; sums are over all ranks.
struct ContactData {
  Vector q, friction;             ///< as those of a LocalFrictionProblem
  Vector normal;                  ///< W_nn of its contact at each component, 1/kg
  double product_operations = 0;  ///< of a product with W and of a sweep, on all ranks
  ContactSums sums = {};
  double alone = 0;    ///< || r^1 ||, each impulse as if its contact were the only one, N s
  double momenta = 0;  ///< p, of the bodies that meet at the contacts, N s
  double trace = 0;    ///< of W, 1/kg

  Index contacts() const { return friction.size(); }  ///< of this rank

  /// Sets `alone`, `momenta` and `trace`. diagonal(c): the diagonal block of W of contact c. `speeds`, m/s: of each
  /// contact, of both bodies without contact impulses, or |q_c|.
  template <int D>
  void set_sums(const auto& diagonal, const Vector& speeds) {
    const Vector totals = sums.add_up(3, contacts(), [&](Index c, auto&& sum) {
      const FullDelassus<D> w = diagonal(c);
      sum[0] += squared(Coulomb{}.impulse(stopping(w, {}, component<D>(q, c)), w, friction[c]));
      const double momentum = speeds[c] / normal[D * c];
      sum[1] += momentum * momentum;
      if constexpr (D == 2)
        sum[2] += w.nn + w.tt;
      else
        sum[2] += w.nn + w.tt.first + w.tt.second;
    });
    alone = std::sqrt(totals[0]);
    momenta = std::sqrt(totals[1]);
    trace = totals[2];
  }
};

/// A contact problem for contact solvers, with any storage of W. All ranks call its functions together. The linear
/// systems have W_s, where W = W_s + W_a with a symmetric W_s: W of a file with six digits is not symmetric. One matrix
/// is factorised at a time; `solve` returns numbers that are not finite if it fails.
template <class P>
concept ContactProblem = requires(P& problem, const P& fixed, const Vector& r, Index number,
                                  const FrictionSolverOptions& options,
                                  std::vector<ContactRelation<P::dimension>> relations) {
  { fixed.data } -> std::convertible_to<const ContactData&>;
  { fixed.product(r) } -> std::same_as<Vector>;  // W r
  // A function of r and a SweepTurn that returns the impulses after these sweeps from r.
  { problem.sweeps(options)(r, SweepTurn{number, number}) } -> std::same_as<Vector>;
  { problem.symmetric_product(r) } -> std::same_as<Vector>;           // W_s r
  { problem.rest(r) } -> std::same_as<Vector>;                        // W_a r
  { problem.factorise(std::move(relations)) } -> std::same_as<bool>;  // as ContactMatrix
  { problem.factorise_shifted(r) } -> std::same_as<bool>;             // W_s + diag(r), r > 0
  { problem.solve(r) } -> std::same_as<Vector>;
  { problem.take_operations() } -> std::same_as<double>;
  { problem.determinant_sign() } -> std::same_as<int>;
};

/// A ContactProblem that stores W in `rows()` of blocks.
template <class P>
concept StoredProblem = ContactProblem<P> && requires(const P& fixed) {
  { fixed.rows() } -> std::convertible_to<const ContactBlocks<P::dimension>&>;
  { fixed.knows_bodies() } -> std::same_as<bool>;  // M and H
};

}  // namespace nscdd
