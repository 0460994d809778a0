// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/factor.hpp"

namespace nscdd {

/// Lower triangle of  [I B; B^T D],  D = `diagonal` I.
SparseMatrix saddle_point(const SparseMatrix& b, double diagonal);

/// Symbolic analysis of such a matrix. The multiplier of a column of B is eliminated with the last row that it ties.
SymmetricAnalysis saddle_point_analysis(const SparseMatrix& matrix, const SparseMatrix& b);

}  // namespace nscdd
