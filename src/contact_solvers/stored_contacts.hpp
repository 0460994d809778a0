// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "contact_solvers/sweep_rows.hpp"
#include "linalg/sparse_cholesky.hpp"

namespace nscdd {

/// A ContactProblem that stores W on one rank. If M and H are not known, W_s plus a positive diagonal is factorised.
template <int D>
class StoredContacts {
 public:
  static constexpr int dimension = D;

  /// `problem` must outlive this.
  explicit StoredContacts(const LocalFrictionProblem& problem);

  ContactData data;

  const ContactBlocks<D>& rows() const { return rows_; }
  bool knows_bodies() const { return problem_.h.cols() > 0; }
  Vector product(const Vector& r) const { return rows_ * r; }
  auto sweeps(const FrictionSolverOptions& options) const {
    return [rows = SweepRows<D>(problem_, options.order, options.seed), omega = options.relaxation](
               const Vector& r, const SweepTurn& turn) { return rows.swept(r, turn, omega); };
  }

  Vector symmetric_product(const Vector& r) { return systems().blocks * r; }
  Vector rest(const Vector& r) { return systems().rest * r; }
  bool factorise(std::vector<ContactRelation<D>> relations) {
    Systems& of = systems();
    of.cholesky.reset();
    if (!of.matrix) of.matrix.emplace(problem_, of.symmetric);
    return of.matrix->factorise(std::move(relations));
  }
  bool factorise_shifted(const Vector& shift);
  Vector solve(const Vector& b) {
    Systems& of = systems();
    if (!of.cholesky) return of.matrix->solve(b);
    of.operations += of.cholesky->solve_operations();
    return of.cholesky->solve(b);
  }
  double take_operations() {
    Systems& of = systems();
    return std::exchange(of.operations, 0.0) + (of.matrix ? of.matrix->take_operations() : 0.0);
  }
  int determinant_sign() const { return systems_->matrix->determinant_sign(); }

 private:
  struct Systems {
    SparseMatrix symmetric, rest;  // W_s and W_a
    ContactBlocks<D> blocks;       // W_s
    std::optional<ContactMatrix<D>> matrix{};
    std::optional<CholeskyAnalysis> analysis{};
    std::optional<SparseCholesky> cholesky{};  // of the last matrix, if it was factorised by Cholesky's method
    double operations = 0;                     // of Cholesky's method, not yet taken
  };
  Systems& systems();  // made on first use: sweeps and gradients need none

  const LocalFrictionProblem& problem_;
  ContactBlocks<D> rows_;
  std::optional<Systems> systems_;
};

/// Throws Error if squares of velocities or impulses overflow or vanish: then no impulse at all has a residual of 0.
void require_moderate(const LocalFrictionProblem& problem, const std::string& name);

}  // namespace nscdd
