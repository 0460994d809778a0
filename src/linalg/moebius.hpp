// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Moebius function x -> (a x + b) / (c x + d), monotone between its poles.
struct Moebius {
  double a = 0, b = 0, c = 0, d = 1;

  double operator()(double x) const { return (a * x + b) / (c * x + d); }
};

/// 1 - factor m, and factor / m - 1.
Moebius one_minus(double factor, const Moebius& m);
Moebius over_minus_one(double factor, const Moebius& m);

/// Every x > 0, at most two, where m(x) - slope log x is stationary.
std::vector<double> stationary_places(const Moebius& m, double slope);

/// Every x > 0, at most two, where m(x) = n(x).
std::vector<double> crossings(const Moebius& m, const Moebius& n);

}  // namespace nscdd
