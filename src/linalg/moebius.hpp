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
inline Moebius one_minus(double factor, const Moebius& m) { return {m.c - factor * m.a, m.d - factor * m.b, m.c, m.d}; }
inline Moebius over_minus_one(double factor, const Moebius& m) {
  return {factor * m.c - m.a, factor * m.d - m.b, m.a, m.b};
}

/// Positive roots of a x^2 + b x + c. Rounding may lose or move a root; bounds of the radius stay valid then.
inline std::vector<double> positive_roots(double a, double b, double c) {
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0)) return {};
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  std::vector<double> roots;
  for (const double root : {q / a, c / q})
    if (std::isfinite(root) && root > 0) roots.push_back(root);
  return roots;
}

/// Every x > 0, at most two, where m(x) - slope log x is stationary: x m'(x) = (a d - b c) x / (c x + d)^2 = slope.
inline std::vector<double> stationary_places(const Moebius& m, double slope) {
  return positive_roots(slope * m.c * m.c, 2 * slope * m.c * m.d - (m.a * m.d - m.b * m.c), slope * m.d * m.d);
}

/// Every x > 0, at most two, where m(x) = n(x).
inline std::vector<double> crossings(const Moebius& m, const Moebius& n) {
  return positive_roots(m.a * n.c - n.a * m.c, m.a * n.d + m.b * n.c - n.a * m.d - n.b * m.c, m.b * n.d - n.b * m.d);
}

}  // namespace nscdd
