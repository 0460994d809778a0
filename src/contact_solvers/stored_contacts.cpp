// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/stored_contacts.hpp"

#include "core/fail.hpp"
#include "core/memory.hpp"

namespace nscdd {

template <int D>
StoredContacts<D>::StoredContacts(const LocalFrictionProblem& problem)
    : data{.q = problem.q,
           .friction = problem.friction,
           .normal = Vector(D * problem.contacts()),
           .product_operations = 2.0 * static_cast<double>(problem.w.nonZeros())},
      problem_(problem),
      rows_(problem.w) {
  for (Index c = 0; c < problem.contacts(); ++c)
    data.normal.segment<D>(D * c).setConstant(problem.w.coeff(D * c, D * c));
  const Vector own = problem.q.reshaped(D, problem.contacts()).colwise().norm().transpose();  // |q_c|
  data.set_sums<D>([&](Index c) { return diagonal_block<D>(problem, c); },
                   problem.speeds.size() > 0 ? problem.speeds : own);
}

template <int D>
typename StoredContacts<D>::Systems& StoredContacts<D>::systems() {
  if (systems_) return *systems_;
  // W_s, W_a, the transpose while they are made, and rows of blocks.
  require_memory(static_cast<double>(problem_.w.nonZeros()) * (3 * 12 + 8),
                 fmt::format("linear systems of {} contacts", problem_.contacts()), "fewer contacts");
  SparseMatrix symmetric = 0.5 * (problem_.w + SparseMatrix(problem_.w.transpose()));
  SparseMatrix rest = problem_.w - symmetric;
  ContactBlocks<D> blocks(symmetric);
  return systems_.emplace(Systems{std::move(symmetric), std::move(rest), std::move(blocks)});
}

template <int D>
bool StoredContacts<D>::factorise_shifted(const Vector& shift) {
  if (problem_.h.cols() > 0) return factorise(ContactRelation<D>::shifted(shift));
  Systems& of = systems();
  if (!of.analysis) of.analysis.emplace(of.symmetric);
  SparseMatrix matrix = of.symmetric;
  matrix.diagonal() += shift;
  of.cholesky.emplace(*of.analysis, matrix);
  of.operations += of.cholesky->factorisation_operations();
  return of.cholesky->positive_definite();
}

void require_moderate(const LocalFrictionProblem& problem, const std::string& name) {
  if (problem.contacts() == 0 || problem.q.isZero(0)) return;
  constexpr double most = 1e140;
  const auto require = [&](double size, std::string_view what) {
    if (!(size <= most && size >= 1 / most))
      fail("{}: {}: expected a number from {} to {}, met {}", name, what, 1 / most, most, size);
  };
  const double largest = problem.q.cwiseAbs().maxCoeff();
  require(largest, "largest |q|");
  require(largest / problem.w.diagonal().minCoeff(), "largest |q| over the least of W_nn and W_tt");
  require(largest / problem.w.diagonal().maxCoeff(), "largest |q| over the largest of W_nn and W_tt");
}

template class StoredContacts<2>;
template class StoredContacts<3>;

}  // namespace nscdd
