// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

/// Text of matrices in the Matrix Market exchange formats (https://math.nist.gov/MatrixMarket/formats.html). Numbers
/// have 17 significant digits, with which they read back bit for bit. Rows and columns count from 1 there.
namespace nscdd {

/// Takes a text piece by piece, so that no large one has to be held.
using TextSink = std::function<void(std::string_view)>;

/// What stands above the numbers.
struct MatrixMarketHead {
  std::vector<std::string> remarks;  ///< a comment line each
  /// The matrix is symmetric to the last bit: its lower triangle alone is written, and readers mirror it.
  bool symmetric = false;
};

/// "coordinate real": the stored entries, zeros among them, column by column.
void write_matrix_market(const SparseMatrix& matrix, const MatrixMarketHead& head, const TextSink& sink);

/// "array real": every entry, column by column.
void write_matrix_market(const Matrix& matrix, const MatrixMarketHead& head, const TextSink& sink);

/// "array integer": one column.
void write_matrix_market(const std::vector<Index>& numbers, const MatrixMarketHead& head, const TextSink& sink);

}  // namespace nscdd
