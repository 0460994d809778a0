// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Calls visit(row, column, value) for the stored entries of a sparse matrix, column by column.
void for_entries(const SparseMatrix& matrix, auto&& visit) {
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(matrix, j); e; ++e) visit(e.row(), j, e.value());
}

/// Entries of a sparse matrix, gathered in any order. Entries at one position add up; zeros are stored.
class SparseEntries {
 public:
  void reserve(std::size_t entries) { entries_.reserve(entries); }
  void add(Index row, Index column, double value) {
    entries_.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
  }
  void add_block(const SparseMatrix& block, Index row, Index column) {
    for_entries(block, [&](Index i, Index j, double value) { add(row + i, column + j, value); });
  }
  SparseMatrix matrix(Index rows, Index columns) const {
    SparseMatrix result(rows, columns);
    result.setFromTriplets(entries_.begin(), entries_.end());
    return result;
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
};

/// diag(d); zeros are stored. (Eigen 3.4 ends the program where it makes a sparse matrix of an empty diagonal.)
inline SparseMatrix diagonal_matrix(const Vector& d) {
  SparseMatrix result(d.size(), d.size());
  result = d.asDiagonal();
  return result;
}

inline SparseMatrix selected_columns(const SparseMatrix& matrix, const std::vector<Index>& columns) {
  SparseEntries entries;
  for (Index j = 0; j < count(columns); ++j)
    for (SparseMatrix::InnerIterator e(matrix, columns[at(j)]); e; ++e) entries.add(e.row(), j, e.value());
  return entries.matrix(matrix.rows(), count(columns));
}

/// The matrix with each row divided by its entry of `scale`.
inline SparseMatrix over_rows(SparseMatrix matrix, const Vector& scale) {
  for (Index j = 0; j < matrix.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(matrix, j); e; ++e) e.valueRef() /= scale[e.row()];
  return matrix;
}

}  // namespace nscdd
