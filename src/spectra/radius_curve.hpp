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
};

/// The ends at x of a contraction operator with omega = 1 and a converged spectrum. Errors come from the intervals of
/// its certificate or, without one, from its residual. The slope of each end takes a product with S and P, a bound of
/// the residual of its vector, and one local solve per subdomain.
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
/// section 12). Four functions F(u) are concave: they lie above their chords and below their tangents.
///     along epsilon   lambda_low over  x / (x + L)       1 / lambda_high over  1 / x
///     along eta       lambda_low over  1 / x             1 / lambda_high over  x / (x + L)
/// with L = law.stiffest. Every chord and tangent gives a bound of rho that is a Moebius function of x. So the
/// deviations are exact, not sampled: they occur at the ends, at crossings of bounds and at stationary points.
Deviation deviation(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to);

/// Bounds of the radius at an x between the points.
std::array<double, 2> radius_bounds(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to, double x);

}  // namespace nscdd
