// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/ddm/optimal_eta.hpp>
#include <nscdd/study/sweep.hpp>

namespace nscdd {

struct OptimumParameters {
  double epsilon = 0.0;
  ContactSet contacts = ContactSet::active;
  SpectralOptions spectral = {};
};

/// The best flexibility of Stage 2 for the contacts chosen; not converged where the choice is uncertain.
/// Throws Error where the active set is asked for and nothing is prescribed.
Optimum optimum(const Model& model, const OptimumParameters& parameters = {});

/// Columns and row of a table of optima, described in docs/formats.md.
std::vector<Column> optimum_columns();
Row optimum_row(const Model& model, const OptimumParameters& parameters, const Optimum& best);

/// Rows of the optima for every epsilon of `sweep` (its other lists are not looked at) from row `first` on;
/// returns how many did not converge. Stops early where the monitor asks for it.
Index optima(const Model& model, const SweepParameters& sweep, const RowSink& sink,
             const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
