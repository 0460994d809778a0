// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/lu.hpp"
#include "mechanics/contact_blocks.hpp"
#include "mechanics/contact_law.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// The linear relation of a contact in a step of a solver: P r + Q u = b, u = W r, with an invertible P. Normal first.
template <int D>
struct ContactRelation {
  using Block = Eigen::Matrix<double, D, D>;
  Block p = Block::Identity(), q = Block::Zero();

  /// That of Newton's steps, u = W r + q + proximal (r - r_now). Open: r = 0. Stick: u = 0. Slide: u_n = 0 and the
  /// tangential law of a FrozenContact, with the `rho` of its z (kg; unused in the plane).
  static ContactRelation of(const FrozenContact<D>& frozen, double proximal, double rho);
  /// Those of (W + diag(shift)) r = b, D entries per contact.
  static std::vector<ContactRelation> shifted(const Vector& shift) {
    std::vector<ContactRelation> relations;
    for (Index k = 0; k < shift.size(); k += D)
      relations.push_back({shift.segment<D>(k).asDiagonal(), Block::Identity()});
    return relations;
  }
  /// The residual b - P r - Q u of all contacts, D c entries, for u = W r.
  static Vector rest(const std::vector<ContactRelation>& relations, const Vector& b, const Vector& r, const Vector& u) {
    Vector rest = b;
    for (Index c = 0; c < count(relations); ++c)
      rest.segment<D>(D * c) -= relations[at(c)].p * r.segment<D>(D * c) + relations[at(c)].q * u.segment<D>(D * c);
    return rest;
  }
};

/// The linear system  P r + Q W r = b  of all contacts, P and Q with a D x D block per contact, for many P and Q. It is
/// factorised in this form or, if M and H are known and leave fewer entries, for the velocities v of the bodies:
///     (M + H P^-1 Q H^T) v = H P^-1 b,   r = P^-1 (b - Q H^T v).
/// Iterative refinement of the first form follows as long as it halves the residual. W is its symmetric part.
template <int D>
class ContactMatrix {
 public:
  /// `w`: the symmetric part of problem.w. The problem must outlive this.
  ContactMatrix(const LocalFrictionProblem& problem, const SparseMatrix& w);

  /// Returns false for a matrix that is singular to rounding: `solve` must not be called then.
  bool factorise(std::vector<ContactRelation<D>> relations);
  /// r, D c entries, for b of the same length and the last relations.
  Vector solve(const Vector& b) const;
  /// Of P + Q W with the last relations, 1 or -1, for P with positive determinants.
  int determinant_sign() const { return lu_->determinant_sign(); }
  /// Floating-point operations of factorisations and solves since the last call.
  double take_operations() {
    const double before = std::exchange(taken_, lu_->operations());
    return taken_ - before;
  }

 private:
  using Block = Eigen::Matrix<double, D, D>;

  // The k rows of H of a contact, and the places of their products among the values of the matrix.
  struct Bodies {
    std::vector<Index> rows;
    Eigen::Matrix<double, Eigen::Dynamic, D> h;
    std::vector<std::ptrdiff_t> places;  // k x k, column by column
  };

  void assemble_bodies();
  void assemble_contacts();
  Vector solve_once(const Vector& b) const;

  const LocalFrictionProblem& problem_;
  const ContactBlocks<D> w_;
  std::vector<Bodies> bodies_;  // of each contact; empty if the unknowns are r
  SparseMatrix constant_;       // M or W, with a place for every entry of the matrix: W in whole D x D blocks
  SparseMatrix matrix_;
  std::vector<ContactRelation<D>> relations_;
  std::vector<Block> inverse_, stiffness_;  // P^-1 and P^-1 Q of each contact, if the unknowns are v
  std::optional<SparseLu> lu_;
  double taken_ = 0;  // of its operations
};

}  // namespace nscdd
