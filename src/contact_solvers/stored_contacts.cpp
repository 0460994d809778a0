// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/contact_problem.hpp"
#include "contact_solvers/sweep_rows.hpp"

namespace nscdd {
namespace {

template <int D>
typename ContactProblem<D>::Sweeps stored_sweeps(const LocalFrictionProblem& problem,
                                                 const FrictionSolverOptions& options) {
  const auto rows = std::make_shared<const SweepRows<D>>(sweep_rows<D>(problem, options.order, options.seed));
  return [rows, order = options.order, omega = options.relaxation](const Vector& r, Index first, Index many) {
    Vector impulses = rows->in_order(r);
    for (Index number = first; number < first + many; ++number) sweep_once(*rows, order, omega, number, impulses);
    return rows->by_contact(impulses);
  };
}

// |q_c| of each contact: no less than that meets.
template <int D>
Vector speeds_of(const Vector& q) {
  return q.reshaped(D, q.size() / D).colwise().norm().transpose();
}

template <int D>
Couplings<D> stored_couplings(const LocalFrictionProblem& problem) {
  const auto symmetric = std::make_shared<const SparseMatrix>(0.5 * (problem.w + SparseMatrix(problem.w.transpose())));
  const auto rest = std::make_shared<const SparseMatrix>(problem.w - *symmetric);
  const auto blocks = std::make_shared<const ContactBlocks<D>>(*symmetric);
  const auto matrix = std::make_shared<std::optional<ContactMatrix<D>>>();  // ADMM may not need it
  return {.product = [blocks](const Vector& r) { return *blocks * r; },
          .rest = [rest](const Vector& r) { return Vector(*rest * r); },
          .factorise =
              [matrix, symmetric, &problem](std::vector<ContactRelation<D>> relations) {
                if (!*matrix) matrix->emplace(problem, *symmetric);
                return (*matrix)->factorise(std::move(relations));
              },
          .solve = [matrix](const Vector& b) { return (*matrix)->solve(b); },
          .take_operations = [matrix] { return (*matrix)->take_operations(); },
          .determinant_sign = [matrix] { return (*matrix)->determinant_sign(); },
          .without_bodies = problem.h.cols() == 0 ? symmetric : nullptr};
}

}  // namespace

template <int D>
ContactProblem<D> stored_contacts(const LocalFrictionProblem& problem) {
  Vector normal(D * problem.contacts());
  for (Index c = 0; c < problem.contacts(); ++c) normal.segment<D>(D * c).setConstant(problem.w.coeff(D * c, D * c));
  const auto rows = std::make_shared<const ContactBlocks<D>>(problem.w);
  return {.q = problem.q,
          .friction = problem.friction,
          .speeds = problem.speeds.size() > 0 ? problem.speeds : speeds_of<D>(problem.q),
          .normal = std::move(normal),
          .product = [rows](const Vector& r) { return *rows * r; },
          .diagonal = [&problem](Index contact) { return diagonal_block<D>(problem, contact); },
          .product_operations = 2.0 * static_cast<double>(problem.w.nonZeros()),
          .rows = rows,
          .sweeps = [&problem](const FrictionSolverOptions& options) { return stored_sweeps<D>(problem, options); },
          .couplings = [&problem] { return stored_couplings<D>(problem); }};
}

template ContactProblem<2> stored_contacts(const LocalFrictionProblem&);
template ContactProblem<3> stored_contacts(const LocalFrictionProblem&);

}  // namespace nscdd
