// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/saddle_point.hpp"

#include "linalg/sparse_entries.hpp"

#include <numeric>

namespace nscdd {

SparseMatrix saddle_point(const SparseMatrix& b, double diagonal) {
  SparseEntries entries;
  for (Index i = 0; i < b.rows(); ++i) entries.add(i, i, 1.0);
  for (Index j = 0; j < b.cols(); ++j) entries.add(b.rows() + j, b.rows() + j, diagonal);
  entries.add_block(b.transpose(), b.rows(), 0);
  return entries.matrix(b.rows() + b.cols(), b.rows() + b.cols());
}

SymmetricAnalysis saddle_point_analysis(const SparseMatrix& matrix, const SparseMatrix& b) {
  std::vector<Index> group(at(matrix.rows()), -1);
  std::iota(group.begin(), group.begin() + b.rows(), Index{0});
  Index next = b.rows();
  for (Index j = 0; j < b.cols(); ++j)
    if (b.col(j).nonZeros() == 0) group[at(b.rows() + j)] = next++;
  return SymmetricAnalysis(matrix, group);
}

}  // namespace nscdd
