// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd {

/// The flexibility that varies along a curve: that of the law in S = X_epsilon, or that of Stage 2 in P = X_eta.
enum class CurveAxis { epsilon, eta };

/// One end of the spectrum of (S, P) outside ker S at a point of a curve.
struct CurveEnd {
  double lambda = 1, error = 0;  ///< the end lies within `error` of `lambda`
  /// d lambda / d log x of the Rayleigh quotient of a vector; the quotient, too, lies within `error` of `lambda`.
  double slope = not_a_number, slope_error = 0;  ///< NaN without a vector
};

/// A point of a curve: the flexibility x, 1/kg, and the ends of its spectrum.
struct CurvePoint {
  double x = 1;
  double radius = 0;                                 ///< the subdominant one, as found
  std::optional<std::array<CurveEnd, 2>> ends = {};  ///< low and high; empty if no eigenvalue is outside ker S
};

struct CurveLaw {
  CurveAxis axis = CurveAxis::epsilon;
  double stiffest = 1;    ///< bound of the eigenvalues of M_E^-1 K_E, 1/kg; K_E of the operator that changes
  double relaxation = 1;  ///< omega
  bool schwarz = false;   ///< of that scheme; `stiffest` then bounds the eigenvalues of W and D
};

/// The ends at x of a contraction operator with omega = 1 and a converged spectrum. Errors come from the intervals of
/// its certificate or, without one, from its residual. The slope of each end takes a product with S and P, a bound of
/// the residual of its vector (or, of schwarz, its quotient), and one local solve per subdomain.
CurvePoint curve_point(const Contraction& b, const SpectralRadius& plain, CurveAxis axis);

/// An upper bound of g^T X_eta^-1 g, eta > 0, without a solve with X_eta: X_inf^-1 times `generic_at_most`.
double inverse_at_most(const InterfaceOperator& x, const Vector& g);

/// Uncertainty of the radius at a point, from its ends; no band is narrower there.
double uncertainty(const CurveLaw& law, const CurvePoint& point);

/// Largest deviation of the radius from the straight line, over log x, between two neighbouring points.
struct Deviation {
  double below = 0, above = 0;  ///< line - below <= radius <= line + above, all along
  double place = 0.5;           ///< of the larger of both: 0 at the first point, 1 at the second
};

/// Proved deviations of rho = max(1 - omega lambda_low, omega lambda_high - 1) between two points (docs/theory.md,
/// sections 12 and 17). Of each end a function F(u) is concave: it lies above its chords and below its tangents.
///     along epsilon   lambda_low over  x / (x + L)       1 / lambda_high over  1 / x
///     along eta       lambda_low over  1 / x             1 / lambda_high over  x / (x + L)
///     of schwarz      lambda_low over  x / (x + L)       1 / lambda_high over  x / (x + L)
/// with L = law.stiffest. Every chord and tangent gives a bound of rho that is a Moebius function of x. So the
/// deviations are exact, not sampled: they occur at the ends, at crossings of bounds and at stationary points.
Deviation deviation(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to);

/// Bounds of the radius at an x between the points.
std::array<double, 2> radius_bounds(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to, double x);

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
