// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "spectra/radius_curve.hpp"
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// Curves of the radius over a range of epsilon or eta, with as few points as their proof needs.
struct CurveParameters {
  /// The flexibility along the curve has the ends of the range, ascending; there is a curve for every value of the
  /// other flexibility and of the relaxation, which is a number. Stage 1 is exact.
  SweepParameters sweep;
  CurveAxis axis = CurveAxis::epsilon;
  double tolerance = 1e-3;  ///< of curve_high - curve_low at a point, times max(1, subdominant radius)
  Index most_points = 1000;
};

/// Parses a curve: of `epsilon` and `eta` one is a range FROM:TO (parse_range), the other has values of a sweep. `rest`
/// has everything else. `dashes` precede names in errors, as in commands. Throws Error if no curve can be proved.
CurveParameters curve_parameters(double tolerance, const std::string& epsilon, const std::string& eta,
                                 SweepParameters rest, std::string_view dashes = "");

/// One point of a curve, which is one row of its table.
struct CurveResult {
  SweepResult found;
  /// Bounds of the subdominant radius: over log x it lies between their lines from point to point. NaN: none.
  double low = not_a_number, high = not_a_number;
};

ResultColumns<CurveResult> curve_columns(const SweepParameters& parameters);

enum class CurveStatus {
  proved,         ///< the band is within the tolerance everywhere
  wide,           ///< the band is proved but wider: too few points allowed, or digits of the spectra
  not_converged,  ///< a point did not converge: nothing is proved
  stopped,        ///< by the monitor; the curve has no rows
};

constexpr auto names_of(CurveStatus) {
  return std::to_array<std::string_view>({"proved", "wide", "not_converged", "stopped"});
}

struct CurveReport {
  CurveStatus status = CurveStatus::proved;
  Index points = 0, factorisations = 0;  ///< the latter of shifted pencils; 0 for dense spectra
  std::string failure = {};              ///< not_converged: SpectralRadius::failure of the point
};

/// Places points until the band of every curve is within the tolerance. `sink` takes the points of a finished curve in
/// ascending order; curves are in the order of a sweep. Bounds hold for any fixed set of contacts in Stage 1
/// (docs/theory.md, sections 12 and 17). Throws Error as choose_contacts.
std::vector<CurveReport> trace_curves(const Model& model, const CurveParameters& parameters,
                                      const Sink<CurveResult>& sink, const Monitor& monitor = {});

}  // namespace nscdd
