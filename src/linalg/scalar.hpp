// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Least-squares line y = intercept + slope x through points (GSL).
struct LinearFit {
  double intercept = 0;
  double slope = 0;
  double slope_error = 0;  ///< standard error of the slope
};

/// Fits a line to points x, y of the same number. Throws Error for fewer than three.
LinearFit linear_fit(std::span<const double> x, std::span<const double> y);

struct ScalarSearch {
  double x = 0;
  double value = 0;  ///< f(x)
  bool converged = false;
};

/// Root of f between a and b by Brent's method (GSL), to |interval| <= tolerance. Throws Error if no sign changes.
ScalarSearch find_root(const std::function<double(double)>& f, double a, double b, double tolerance);

/// Integral of f from a to b by adaptive Gauss-Kronrod rules of 21 points (GSL), to an estimated error of
/// max(absolute, 10^-12 x the integral); throws Error for a larger one. f may have kinks, and is not called at a or b.
double integral(const std::function<double(double)>& f, double a, double b, double absolute);

/// Minimum of f between a and b by Brent's method (GSL), with f(m) below f(a) and f(b). Throws Error for other m.
ScalarSearch find_minimum(const std::function<double(double)>& f, double a, double m, double b, double tolerance);

}  // namespace nscdd
