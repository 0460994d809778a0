// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/peeling.hpp"

#include "linalg/pencil.hpp"

namespace nscdd {
namespace {

// The least singular value of columns of unit length that are clearly independent.
constexpr double independent = 1e-2;

class Peeling {
 public:
  Peeling(const std::vector<RigidBody>& bodies, const std::vector<char>& grounded, const SparseMatrix& h)
      : bodies_(bodies), body_of_row_(at(h.rows()), -1), columns_of_(bodies.size()), left_(at(h.cols()), 1), h_(h) {
    for (Index b = 0; b < count(bodies); ++b)
      for (Index k = 0; k < bodies[at(b)].rows && (grounded.empty() || !grounded[at(b)]); ++k)
        body_of_row_[at(bodies[at(b)].first_row + k)] = b;
    for (Index c = 0; c < h.cols(); ++c) {
      for (const Index b : bodies_of(c)) columns_of_[at(b)].push_back(c);
      if (bodies_of(c).empty()) left_[at(c)] = 0;  // it is nothing where only grounded bodies have it
    }
    for (Index b = 0; b < count(bodies); ++b) queue_.push_back(b);
    for (std::size_t k = 0; k < queue_.size(); ++k) try_body(queue_[k]);
  }

  Peeled result() && {
    Peeled peeled{std::move(set_aside_), {}};
    for (Index c = 0; c < count(left_); ++c)
      if (left_[at(c)]) peeled.left.push_back(c);
    return peeled;
  }

 private:
  std::vector<Index> bodies_of(Index column) const {
    std::vector<Index> bodies;
    for (SparseMatrix::InnerIterator e(h_, column); e; ++e)
      if (const Index b = body_of_row_[at(e.row())]; b >= 0 && std::ranges::count(bodies, b) == 0) bodies.push_back(b);
    return bodies;
  }

  void try_body(Index b) {
    const RigidBody& body = bodies_[at(b)];
    std::vector<Index>& columns = columns_of_[at(b)];
    std::erase_if(columns, [&](Index c) { return !left_[at(c)]; });
    if (columns.empty() || count(columns) > body.rows) return;
    Matrix block = Matrix::Zero(body.rows, count(columns));
    for (Index j = 0; j < block.cols(); ++j) {
      double square = 0;
      for (SparseMatrix::InnerIterator e(h_, columns[at(j)]); e; ++e) {
        square += e.value() * e.value();
        if (body_of_row_[at(e.row())] == b) block(e.row() - body.first_row, j) = e.value();
      }
      if (!(square > 0)) return;
      block.col(j) *= std::sqrt(2 / square);
    }
    const Vector squares = symmetric_eigen(block.transpose() * block, Eigenvectors::not_wanted).values;
    if (!(squares[0] > independent * independent)) return;
    for (const Index c : columns) {
      left_[at(c)] = 0;
      set_aside_.push_back(c);
      for (const Index other : bodies_of(c))
        if (other != b) queue_.push_back(other);
    }
  }

  const std::vector<RigidBody>& bodies_;
  std::vector<Index> body_of_row_;
  std::vector<std::vector<Index>> columns_of_;
  std::vector<char> left_;
  std::vector<Index> set_aside_, queue_;
  const SparseMatrix& h_;
};

}  // namespace

Peeled peel(const std::vector<RigidBody>& bodies, const std::vector<char>& grounded, const SparseMatrix& h) {
  return Peeling(bodies, grounded, h).result();
}

}  // namespace nscdd
