// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_entries.hpp"

namespace nscdd {

SparseMatrix SparseEntries::matrix(Index rows, Index columns) const {
  SparseMatrix result(rows, columns);
  result.setFromTriplets(entries_.begin(), entries_.end());
  return result;
}

SparseMatrix selected_columns(const SparseMatrix& matrix, const std::vector<Index>& columns) {
  SparseEntries entries;
  for (Index j = 0; j < count(columns); ++j)
    for (SparseMatrix::InnerIterator e(matrix, columns[at(j)]); e; ++e) entries.add(e.row(), j, e.value());
  return entries.matrix(matrix.rows(), count(columns));
}

SparseMatrix over_rows(SparseMatrix matrix, const Vector& scale) {
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(matrix, j); e; ++e) e.valueRef() /= scale[e.row()];
  return matrix;
}

}  // namespace nscdd
