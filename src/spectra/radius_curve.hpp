// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/spectral_radius.hpp>

namespace nscdd {

/// Which flexibility runs along a curve: that of the law in S = X_epsilon, or that of Stage 2 in P = X_eta.
enum class CurveAxis { epsilon, eta };

/// One end of the spectrum of (S, P) outside ker S at a point of a curve.
struct CurveEnd {
  double lambda = 1, error = 0;  ///< the end lies within `error` of `lambda`
  /// d lambda / d log x of the Rayleigh quotient of one vector, whose value lies within `error` of `lambda` too.
  double slope = not_a_number, slope_error = 0;  ///< NaN where no vector is known
};

/// A point of a curve: the flexibility x, 1/kg, and what is known of the spectrum there.
struct CurvePoint {
  double x = 1;
  double radius = 0;                                 ///< the subdominant one, as found
  std::optional<std::array<CurveEnd, 2>> ends = {};  ///< low and high; none where no eigenvalue is outside ker S
};

/// What holds along a whole curve.
struct CurveLaw {
  CurveAxis axis = CurveAxis::epsilon;
  double stiffest = 1;    ///< no eigenvalue of M_E^-1 K_E is larger, 1/kg; K_E of the operator that changes
  double relaxation = 1;  ///< omega
};

/// The ends at x for a contraction operator with omega = 1 and its converged spectrum: the intervals of its certificate
/// or, without one, its residual; the slopes for each end by a product with S and P, a bound of the residual of the
/// vector, and one local solve per subdomain.
CurvePoint curve_point(const Contraction& b, const SpectralRadius& plain, CurveAxis axis);

/// By how much the radius at a point is uncertain, because its ends are. No band is narrower there.
double uncertainty(const CurveLaw& law, const CurvePoint& point);

/// How far the radius may lie from the straight line, over log x, between two neighbouring points.
struct Deviation {
  double below = 0, above = 0;  ///< line - below <= radius <= line + above, all along
  double place = 0.5;           ///< where the larger of both is met: 0 at the first point, 1 at the second
};

/// Proved deviations of rho = max(1 - omega lambda_low, omega lambda_high - 1) between two points (docs/theory.md,
/// section 12). Four functions F(u) are concave, so that they lie above their chords and below their tangents:
///     along epsilon   lambda_low over  x / (x + L)       1 / lambda_high over  1 / x
///     along eta       lambda_low over  1 / x             1 / lambda_high over  x / (x + L)
/// with L = law.stiffest. Every chord and tangent makes a bound of rho that is a Moebius function of x, so the
/// deviations are not sampled: they are met at the ends, at crossings of bounds and at stationary places.
Deviation deviation(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to);

/// The bounds themselves at an x between the points.
std::array<double, 2> radius_bounds(const CurveLaw& law, const CurvePoint& from, const CurvePoint& to, double x);

}  // namespace nscdd
