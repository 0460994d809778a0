// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_solvers/contact_matrix.hpp"

#include "linalg/sparse_entries.hpp"

#include <Eigen/LU>

namespace nscdd {
namespace {

constexpr int most_refinements = 5;
constexpr double refined = 1e-11;  // of b: a solver sees the rest and takes another step if it matters

// W in whole blocks, zeros where it has none, and the blocks of all contacts with themselves.
SparseMatrix whole_blocks(const SparseMatrix& w) {
  SparseEntries entries;
  const auto add_block = [&](Index c, Index d) {
    for (const Index j : {2 * d, 2 * d + 1})
      for (const Index i : {2 * c, 2 * c + 1}) entries.add(i, j, 0);
  };
  for_entries(w, [&](Index i, Index j, double value) {
    if (i % 2 == 0 || j % 2 != 0) add_block(i / 2, j / 2);
    entries.add(i, j, value);
  });
  for (Index c = 0; c < w.rows() / 2; ++c) add_block(c, c);
  return entries.matrix(w.rows(), w.cols());
}

std::vector<Index> rows_of(const SparseMatrix& h, Index contact) {
  std::vector<Index> rows;
  for (const Index j : {2 * contact, 2 * contact + 1})
    for (SparseMatrix::InnerIterator e(h, j); e; ++e) rows.push_back(e.row());
  std::ranges::sort(rows);
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

// M with a place for every product of two rows of H that share a contact.
SparseMatrix with_places(const SparseMatrix& mass, const SparseMatrix& h) {
  SparseEntries entries;
  entries.add_block(mass, 0, 0);
  for (Index c = 0; c < h.cols() / 2; ++c) {
    const std::vector<Index> rows = rows_of(h, c);
    for (const Index j : rows)
      for (const Index i : rows) entries.add(i, j, 0);
  }
  return entries.matrix(mass.rows(), mass.cols());
}

}  // namespace

Vector rest_of(const std::vector<ContactRelation>& relations, const Vector& b, const Vector& r, const Vector& u) {
  Vector rest = b;
  for (Index c = 0; c < count(relations); ++c)
    rest.segment<2>(2 * c) -= relations[at(c)].p * r.segment<2>(2 * c) + relations[at(c)].q * u.segment<2>(2 * c);
  return rest;
}

ContactMatrix::ContactMatrix(const LocalFrictionProblem& problem, const SparseMatrix& w) : problem_(problem), w_(w) {
  if (problem.h.cols() > 0) constant_ = with_places(problem.mass, problem.h);
  if (problem.h.cols() > 0 && constant_.nonZeros() < w.nonZeros())
    bodies_.resize(at(problem.contacts()));
  else
    constant_ = whole_blocks(w);
  matrix_ = constant_;
  for (Index c = 0; c < count(bodies_); ++c) {
    Bodies& own = bodies_[at(c)];
    own.rows = rows_of(problem.h, c);
    own.h.resize(count(own.rows), 2);
    for (Index i = 0; i < count(own.rows); ++i)
      for (const Index k : {0, 1}) own.h(i, k) = problem.h.coeff(own.rows[at(i)], 2 * c + k);
    for (const Index j : own.rows)
      for (const Index i : own.rows) own.places.push_back(&matrix_.coeffRef(i, j) - matrix_.valuePtr());
  }
  lu_.emplace(matrix_);
}

void ContactMatrix::assemble_bodies() {
  std::copy_n(constant_.valuePtr(), constant_.nonZeros(), matrix_.valuePtr());
  inverse_.resize(bodies_.size());
  stiffness_.resize(bodies_.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic> products;
  for (std::size_t c = 0; c < bodies_.size(); ++c) {
    const Bodies& own = bodies_[c];
    inverse_[c] = relations_[c].p.inverse();
    stiffness_[c] = inverse_[c] * relations_[c].q;
    products.noalias() = (own.h * stiffness_[c]).lazyProduct(own.h.transpose());
    for (std::size_t k = 0; k < own.places.size(); ++k) matrix_.valuePtr()[own.places[k]] += products.data()[k];
  }
}

void ContactMatrix::assemble_contacts() {
  for (Index j = 0; j < matrix_.cols(); ++j)
    for (Index k = matrix_.outerIndexPtr()[j]; k < matrix_.outerIndexPtr()[j + 1]; k += 2) {
      const Index contact = matrix_.innerIndexPtr()[k] / 2;
      const ContactRelation& relation = relations_[at(contact)];
      Eigen::Vector2d column = relation.q * Eigen::Vector2d::Map(constant_.valuePtr() + k);
      if (contact == j / 2) column += relation.p.col(j % 2);
      Eigen::Vector2d::Map(matrix_.valuePtr() + k) = column;
    }
}

bool ContactMatrix::factorise(std::vector<ContactRelation> relations) {
  relations_ = std::move(relations);
  bodies_.empty() ? assemble_contacts() : assemble_bodies();
  return lu_->factorise(matrix_);
}

Vector ContactMatrix::solve_once(const Vector& b) const {
  if (bodies_.empty()) return lu_->solve(b);
  Vector r(b.size());
  for (Index c = 0; c < count(relations_); ++c) r.segment<2>(2 * c) = inverse_[at(c)] * b.segment<2>(2 * c);
  const Vector u = problem_.h.transpose() * lu_->solve(problem_.h * r);
  for (Index c = 0; c < count(relations_); ++c) r.segment<2>(2 * c) -= stiffness_[at(c)] * u.segment<2>(2 * c);
  return r;
}

Vector ContactMatrix::solve(const Vector& b) const {
  Vector r = solve_once(b), rest = rest_of(relations_, b, r, w_ * r);
  for (int step = 0; step < most_refinements && rest.norm() > refined * b.norm(); ++step) {
    Vector next = r + solve_once(rest), next_rest = rest_of(relations_, b, next, w_ * next);
    if (!(next_rest.norm() < rest.norm())) break;  // what it takes away is less than what it brings
    const bool worth_while = next_rest.norm() < 0.5 * rest.norm();
    r = std::move(next);
    rest = std::move(next_rest);
    if (!worth_while) break;
  }
  return r;
}

double ContactMatrix::take_operations() {
  const double before = std::exchange(taken_, lu_->operations());
  return taken_ - before;
}

}  // namespace nscdd
