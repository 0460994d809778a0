// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

namespace nscdd {

/// Least-squares line y = intercept + slope x through points (GSL).
struct LinearFit {
  double intercept = 0;
  double slope = 0;
  double slope_error = 0;  ///< standard error of the slope
};

/// Fits at least three points; x and y have the same length. Throws Error for fewer.
LinearFit linear_fit(std::span<const double> x, std::span<const double> y);

}  // namespace nscdd
