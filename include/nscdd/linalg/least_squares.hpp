// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Solution of min || A x - b || of least norm, with the numerical rank of A.
struct LeastSquares {
  Vector solution;
  Index rank = 0;
};

/// Dense complete orthogonal decomposition (LAPACK dgelsy), any shape and rank. Pivots below `tolerance` x
/// the largest count as zero.
LeastSquares minimum_norm_least_squares(Matrix a, const Vector& b, double tolerance = 1e-10);

}  // namespace nscdd
