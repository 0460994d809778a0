// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/analysis.hpp"

namespace nscdd {

/// Bytes that factors of one analysis take, from the sizes of its fronts.
struct FactorMemory {
  double held = 0;     ///< by a factor, its interior included
  double border = 0;   ///< by another factor with the same interior
  double at_once = 0;  ///< at most, during the first factorisation, on any number of threads
};

enum class FactorShape { symmetric, full };  ///< triangles of a front in a factor: the lower one, or both

FactorMemory factor_memory(const FrontTree& tree, FactorShape shape);

}  // namespace nscdd
