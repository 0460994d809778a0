// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/linalg/range_projector.hpp>

#include <Eigen/SPQRSupport>

#include <algorithm>

namespace nscdd {

class RangeProjector::Implementation {
 public:
  Implementation(const SparseMatrix& a, double tolerance) : rows(a.rows()) {
    double largest = 0;
    for (Index j = 0; j < a.outerSize(); ++j) largest = std::max(largest, a.col(j).norm());
    if (largest == 0) return;  // SuiteSparseQR takes no empty matrix
    factorisation.cholmodCommon()->print = 0;
    factorisation.setPivotThreshold(tolerance * largest);
    factorisation.compute(a);
    rank = factorisation.rank();
  }

  Eigen::SPQR<SparseMatrix> factorisation;
  Index rows;
  Index rank = 0;
};

RangeProjector::RangeProjector(const SparseMatrix& a, double tolerance)
    : implementation_(std::make_shared<const Implementation>(a, tolerance)) {}

Index RangeProjector::rank() const { return implementation_->rank; }

Vector RangeProjector::apply(const Vector& x) const {
  const auto& [factorisation, rows, rank] = *implementation_;
  if (rank == 0) return Vector::Zero(rows);
  Vector coordinates = factorisation.matrixQ().transpose() * x;  // Q^T x
  coordinates.tail(rows - rank).setZero();                       // keep the part on Q_1
  return factorisation.matrixQ() * coordinates;
}

std::vector<Index> independent_columns(const SparseMatrix& a, double tolerance) {
  const RangeProjector::Implementation qr(a, tolerance);
  std::vector<Index> columns;
  if (qr.rank == 0) return columns;
  const SparseMatrix r = qr.factorisation.matrixR();
  const auto& order = qr.factorisation.colsPermutation().indices();
  for (Index j = 0; j < r.cols() && count(columns) < qr.rank; ++j) {
    const auto next_row = static_cast<int>(columns.size());
    for (SparseMatrix::InnerIterator e(r, j); e; ++e)
      if (e.row() == next_row && e.value() != 0) {
        columns.push_back(order[j]);
        break;
      }
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

Index sparse_rank(const SparseMatrix& a, double tolerance) { return RangeProjector(a, tolerance).rank(); }

}  // namespace nscdd
