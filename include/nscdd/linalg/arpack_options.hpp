// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Settings of ARPACK, the matrix-free solver.
struct ArpackOptions {
  Index basis = 40;              ///< Krylov vectors kept (ncv), cut to the size of the problem
  Index maximum_restarts = 300;  ///< implicit restarts
  double tolerance = 1e-12;      ///< relative accuracy asked of the Ritz values
};

}  // namespace nscdd
