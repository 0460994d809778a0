// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/optimal_eta.hpp>
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// The best flexibility of Stage 2 for a case at one epsilon; not converged if the choice of contacts is uncertain.
struct OptimumResult {
  CaseSummary of_case;
  double epsilon = 0;  ///< 1/kg
  Optimum best;
  double relative_epsilon = 0;  ///< epsilon / scale
  double scale = 1;             ///< flexibility_scale of the case, 1/kg
};

/// With sweep.relative_epsilon, there are columns of multiples of the scale of the case, too. The scheme schwarz has
/// columns of the best relaxation: `best` has its radius, relaxation and relaxed radius as those of the generic
/// algorithm, and the relaxation below which it converges as `convergent_from`.
ResultColumns<OptimumResult> optimum_columns(const SweepParameters& sweep);

/// Computes the optima for every epsilon of `sweep` (its other lists are unused) with a choice of contacts from number
/// `first` on. Returns how many did not converge. The monitor may stop it. Throws Error as choose_contacts.
Index optima(const Model& model, const Selection& selection, const SweepParameters& sweep,
             const Sink<OptimumResult>& sink, const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
