// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/contact_matrix.hpp"

#include "linalg/sparse_entries.hpp"

#include <Eigen/LU>

namespace nscdd {
namespace {

constexpr int most_refinements = 5;
constexpr double refined = 1e-11;  // of b: a solver sees a larger residual and takes another step if it matters

// W in whole blocks with explicit zeros, all diagonal blocks included.
template <int D>
SparseMatrix whole_blocks(const SparseMatrix& w) {
  SparseEntries entries;
  const auto add_block = [&](Index c, Index d) {
    for (Index j = D * d; j < D * (d + 1); ++j)
      for (Index i = D * c; i < D * (c + 1); ++i) entries.add(i, j, 0);
  };
  std::pair<Index, Index> last{-1, -1};  // contact and column: entries come column by column
  for_entries(w, [&](Index i, Index j, double value) {
    if (std::exchange(last, {i / D, j}) != std::pair(i / D, j)) add_block(i / D, j / D);
    entries.add(i, j, value);
  });
  for (Index c = 0; c < w.rows() / D; ++c) add_block(c, c);
  return entries.matrix(w.rows(), w.cols());
}

template <int D>
std::vector<Index> rows_of(const SparseMatrix& h, Index contact) {
  std::vector<Index> rows;
  for (Index j = D * contact; j < D * (contact + 1); ++j)
    for (SparseMatrix::InnerIterator e(h, j); e; ++e) rows.push_back(e.row());
  sort_unique(rows);
  return rows;
}

// M with a place for every product of two rows of H that share a contact.
template <int D>
SparseMatrix with_places(const SparseMatrix& mass, const SparseMatrix& h) {
  SparseEntries entries;
  entries.add_block(mass, 0, 0);
  for (Index c = 0; c < h.cols() / D; ++c) {
    const std::vector<Index> rows = rows_of<D>(h, c);
    for (const Index j : rows)
      for (const Index i : rows) entries.add(i, j, 0);
  }
  return entries.matrix(mass.rows(), mass.cols());
}

}  // namespace

template <int D>
ContactRelation<D> ContactRelation<D>::of(const FrozenContact<D>& frozen, double proximal, double rho) {
  ContactRelation<D> relation;
  if (frozen.status == ContactStatus::open) return relation;
  if (frozen.status == ContactStatus::stick) return {proximal * Block::Identity(), Block::Identity()};
  relation.p(0, 0) = proximal;
  relation.q(0, 0) = 1;
  if constexpr (D == 2) {
    relation.p(1, 0) = -frozen.slope;
  } else {
    const Eigen::Vector2d slope(frozen.slope.first, frozen.slope.second);
    Eigen::Matrix2d across = Eigen::Matrix2d::Zero();  // turning (I - d d^T)
    if (frozen.turning > 0) {
      const Eigen::Vector2d side = Eigen::Vector2d(-slope.y(), slope.x()).normalized();
      across = frozen.turning * side * side.transpose();
    }
    relation.p.template bottomLeftCorner<2, 1>() = -slope;
    relation.q.template bottomRightCorner<2, 2>() = rho * across;
    relation.p.template bottomRightCorner<2, 2>() += (proximal * rho - 1) * across;
  }
  return relation;
}

template <int D>
ContactMatrix<D>::ContactMatrix(const LocalFrictionProblem& problem, const SparseMatrix& w) : problem_(problem), w_(w) {
  if (problem.h.cols() > 0) constant_ = with_places<D>(problem.mass, problem.h);
  if (problem.h.cols() > 0 && constant_.nonZeros() < w.nonZeros())
    bodies_.resize(at(problem.contacts()));
  else
    constant_ = whole_blocks<D>(w);
  matrix_ = constant_;
  for (Index c = 0; c < count(bodies_); ++c) {
    Bodies& own = bodies_[at(c)];
    own.rows = rows_of<D>(problem.h, c);
    own.h.resize(count(own.rows), D);
    for (Index i = 0; i < count(own.rows); ++i)
      for (Index k = 0; k < D; ++k) own.h(i, k) = problem.h.coeff(own.rows[at(i)], D * c + k);
    for (const Index j : own.rows)
      for (const Index i : own.rows) own.places.push_back(&matrix_.coeffRef(i, j) - matrix_.valuePtr());
  }
  lu_.emplace(matrix_);
}

template <int D>
void ContactMatrix<D>::assemble_bodies() {
  std::copy_n(constant_.valuePtr(), constant_.nonZeros(), matrix_.valuePtr());
  inverse_.resize(bodies_.size());
  stiffness_.resize(bodies_.size());
  Matrix products;
  for (std::size_t c = 0; c < bodies_.size(); ++c) {
    const Bodies& own = bodies_[c];
    inverse_[c] = relations_[c].p.inverse();
    stiffness_[c] = inverse_[c] * relations_[c].q;
    products.noalias() = (own.h * stiffness_[c]).lazyProduct(own.h.transpose());
    for (std::size_t k = 0; k < own.places.size(); ++k) matrix_.valuePtr()[own.places[k]] += products.data()[k];
  }
}

template <int D>
void ContactMatrix<D>::assemble_contacts() {
  for (Index j = 0; j < matrix_.cols(); ++j)
    for (Index k = matrix_.outerIndexPtr()[j]; k < matrix_.outerIndexPtr()[j + 1]; k += D) {
      const Index contact = matrix_.innerIndexPtr()[k] / D;
      const ContactRelation<D>& relation = relations_[at(contact)];
      using Column = Eigen::Matrix<double, D, 1>;
      Column column = relation.q * Column::Map(constant_.valuePtr() + k);
      if (contact == j / D) column += relation.p.col(j % D);
      Column::Map(matrix_.valuePtr() + k) = column;
    }
}

template <int D>
bool ContactMatrix<D>::factorise(std::vector<ContactRelation<D>> relations) {
  relations_ = std::move(relations);
  bodies_.empty() ? assemble_contacts() : assemble_bodies();
  return lu_->factorise(matrix_);
}

template <int D>
Vector ContactMatrix<D>::solve_once(const Vector& b) const {
  if (bodies_.empty()) return lu_->solve(b);
  Vector r(b.size());
  for (Index c = 0; c < count(relations_); ++c) r.segment<D>(D * c) = inverse_[at(c)] * b.segment<D>(D * c);
  const Vector u = problem_.h.transpose() * lu_->solve(problem_.h * r);
  for (Index c = 0; c < count(relations_); ++c) r.segment<D>(D * c) -= stiffness_[at(c)] * u.segment<D>(D * c);
  return r;
}

template <int D>
Vector ContactMatrix<D>::solve(const Vector& b) const {
  Vector r = solve_once(b), rest = ContactRelation<D>::rest(relations_, b, r, w_ * r);
  for (int step = 0; step < most_refinements && rest.norm() > refined * b.norm(); ++step) {
    Vector next = r + solve_once(rest), next_rest = ContactRelation<D>::rest(relations_, b, next, w_ * next);
    if (!(next_rest.norm() < rest.norm())) break;
    const bool worth_while = next_rest.norm() < 0.5 * rest.norm();
    r = std::move(next);
    rest = std::move(next_rest);
    if (!worth_while) break;
  }
  return r;
}

template struct ContactRelation<2>;
template struct ContactRelation<3>;
template class ContactMatrix<2>;
template class ContactMatrix<3>;

}  // namespace nscdd
