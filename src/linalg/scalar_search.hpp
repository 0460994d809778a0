// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace nscdd {

/// Abscissa where a scalar search ended.
struct ScalarSearch {
  double x = 0;
  double value = 0;  ///< f(x)
  int evaluations = 0;
  bool converged = false;
};

/// Root of f between a and b by Brent's method (GSL), to |interval| <= tolerance.
/// Throws Error where f(a) and f(b) have the same strict sign.
ScalarSearch find_root(const std::function<double(double)>& f, double a, double b, double tolerance);

/// Minimum of f between a and b by Brent's method (GSL), given an inner point m with f(m) below both ends.
/// Throws Error where (a, m, b) does not bracket a minimum.
ScalarSearch find_minimum(const std::function<double(double)>& f, double a, double m, double b, double tolerance);

}  // namespace nscdd
