// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/ldlt/factor.hpp"

#include <numeric>
#include <vector>

namespace nscdd {

/// Lower triangle of [I B; B^T diagonal I].
inline SparseMatrix saddle_point(const SparseMatrix& b, double diagonal) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto rows = static_cast<int>(b.rows());
  for (int i = 0; i < rows; ++i) entries.emplace_back(i, i, 1.0);
  for (int j = 0; j < static_cast<int>(b.cols()); ++j) {
    entries.emplace_back(rows + j, rows + j, diagonal);
    for (SparseMatrix::InnerIterator e(b, j); e; ++e)
      entries.emplace_back(rows + j, static_cast<int>(e.row()), e.value());
  }
  SparseMatrix matrix(b.rows() + b.cols(), b.rows() + b.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// The analysis of such a matrix. The multiplier of a column of B is eliminated with the last of the rows
/// that it ties.
inline SymmetricAnalysis saddle_point_analysis(const SparseMatrix& matrix, const SparseMatrix& b) {
  std::vector<Index> group(at(matrix.rows()), -1);
  std::iota(group.begin(), group.begin() + b.rows(), Index{0});
  Index next = b.rows();
  for (Index j = 0; j < b.cols(); ++j)
    if (b.col(j).nonZeros() == 0) group[at(b.rows() + j)] = next++;
  return SymmetricAnalysis(matrix, group);
}

}  // namespace nscdd
