// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/optimal_eta.hpp>
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// The best flexibility of Stage 2 for a case at one epsilon: a row of a table of optima. It has not converged
/// where the choice of contacts is uncertain.
struct OptimumResult {
  CaseSummary of_case;
  double epsilon = 0;  ///< 1/kg
  Optimum best;
  double relative_epsilon = 0;  ///< epsilon / scale
  double scale = 1;             ///< flexibility_scale of the case, 1/kg
};

/// Columns of these results, described in docs/formats.md. `relative`: also of flexibilities in multiples of
/// the scale of the case.
ResultColumns<OptimumResult> optimum_columns(bool relative);

/// The optima for every epsilon of `sweep` (its other lists are not looked at) from number `first` on;
/// returns how many did not converge. Stops early where the monitor asks for it. Throws Error where the active
/// set is asked for and nothing is prescribed.
Index optima(const Model& model, const SweepParameters& sweep, const Sink<OptimumResult>& sink,
             const Monitor& monitor = {}, Index first = 0);
/// The same with a choice of contacts that was made before.
Index optima(const Model& model, const Selection& selection, const SweepParameters& sweep,
             const Sink<OptimumResult>& sink, const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
