// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/analysis.hpp"

namespace nscdd {

/// Bytes that factors of one analysis take, from the sizes of its fronts.
struct FactorMemory {
  double held = 0;     ///< by a factor, its interior included
  double border = 0;   ///< by another factor with the same interior
  double at_once = 0;  ///< during the first factorisation at most, on as many threads as there may be
};

/// What a factor has of a front: the lower triangle, or both.
enum class FactorShape { symmetric, full };

FactorMemory factor_memory(const FrontTree& tree, FactorShape shape);

}  // namespace nscdd
