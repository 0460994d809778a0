// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "spectra/radius_curve.hpp"
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// Curves of the radius over a range of epsilon or eta, with as few points as their proof takes.
struct CurveParameters {
  /// Its list of the flexibility along the curve holds both ends of the range, ascending; there is one curve for every
  /// value of the other flexibility and every relaxation. Stage 1 is exact, and the relaxation is a number.
  SweepParameters sweep;
  CurveAxis axis = CurveAxis::epsilon;
  double tolerance = 1e-3;  ///< of curve_high - curve_low at a point, times max(1, subdominant radius)
  Index most_points = 1000;
};

/// The curve that texts ask for: of `epsilon` and `eta` one is a range FROM:TO (parse_range), in which points are
/// placed, and the other the values of a sweep. `rest` has everything else. `dashes` stand before the names of what is
/// refused, as on the command line. Throws Error for what no curve can be proved of.
CurveParameters curve_parameters(double tolerance, const std::string& epsilon, const std::string& eta,
                                 SweepParameters rest, std::string_view dashes = "");

/// One point of a curve, which is one row of its table.
struct CurveResult {
  SweepResult found;
  /// Bounds of the subdominant radius: over log x, the straight lines from one point to the next lie below and above it
  /// all along the curve. NaN where a point has not converged, because nothing is proved then.
  double low = not_a_number, high = not_a_number;
};

ResultColumns<CurveResult> curve_columns(const SweepParameters& parameters);

enum class CurveStatus {
  proved,         ///< the band is within the tolerance everywhere
  wide,           ///< the band is proved but wider: the points allowed, or the digits of the spectra, did not do
  not_converged,  ///< a point did not converge: nothing is proved
  stopped,        ///< by the monitor; nothing of this curve was handed over
};

constexpr auto names_of(CurveStatus) {
  return std::to_array<std::string_view>({"proved", "wide", "not_converged", "stopped"});
}

/// What became of one curve.
struct CurveReport {
  CurveStatus status = CurveStatus::proved;
  Index points = 0, factorisations = 0;  ///< the latter of shifted pencils; 0 for dense spectra
  std::string failure = {};              ///< not_converged: SpectralRadius::failure of the point
};

/// Places points until the band of every curve is within the tolerance. The points of a curve are handed over in
/// ascending order when it is done; curves are in the order of a sweep. Throws Error for a problem without the contacts
/// asked for. Bounds hold for any fixed set of contacts in Stage 1 (docs/theory.md, section 12).
std::vector<CurveReport> trace_curves(const Model& model, const CurveParameters& parameters,
                                      const Sink<CurveResult>& sink, const Monitor& monitor = {});

}  // namespace nscdd
