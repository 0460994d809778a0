// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/monitor.hpp>
#include <nscdd/core/table.hpp>
#include <nscdd/ddm/spectral_radius.hpp>
#include <nscdd/study/case.hpp>
#include <nscdd/study/contact_choice.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace nscdd {

/// What to vary and how to solve: rows are the product of the lists, the last one running fastest.
struct SweepParameters {
  std::vector<double> epsilon{1.0};
  std::vector<double> eta{infinity};
  std::vector<std::optional<double>> relaxation{1.0};                  ///< empty: the optimal one
  std::vector<std::optional<long>> gauss_seidel_sweeps{std::nullopt};  ///< empty: exact Stage 1
  ContactSet contacts = ContactSet::all;
  SpectralOptions spectral = {};
};

/// One point of a sweep, which is one row of its table.
struct SweepPoint {
  double epsilon = 1.0;
  double eta = infinity;
  std::optional<double> relaxation;         ///< empty: the optimal one
  std::optional<long> gauss_seidel_sweeps;  ///< empty: exact Stage 1
};

/// How many points a sweep has, and the one of row `number`, counted from 0.
Index point_count(const SweepParameters& parameters);
SweepPoint sweep_point(const SweepParameters& parameters, Index number);

/// The decomposition of a model together with what the choice of contacts makes of it.
struct Selection {
  Decomposition stage_one;  ///< with the contacts Stage 1 works with
  Index active_contacts = 0;
  std::string rule;     ///< how they were chosen, see ContactChoice
  bool certain = true;  ///< false where the impulses behind the rule were not found to 1e-8
};

/// Throws Error where the choice depends on impulses and no grain has an arriving velocity.
Selection select(const Model& model, ContactSet contacts);

/// Columns common to every table about a case, and their values.
std::vector<Column> case_columns();
Row case_cells(const Model& model, const Selection& selection, ContactSet contacts);

/// The same followed by the coordinates of a point of a sweep: epsilon, eta, relaxation, sweeps.
std::vector<Column> point_columns();

/// Columns of a sweep, described in docs/formats.md; certificates and further eigenvalues add theirs at the
/// end.
std::vector<Column> sweep_columns(const SpectralOptions& options = {});

/// Takes the rows of a table as they come.
using RowSink = std::function<void(const Row&)>;

/// Spectral radius at every point of a sweep from row `first` on, the rows before it being known. Points that
/// do not converge are rows with converged = false; returns how many there are. Stops early where the monitor
/// asks for it. Rows do not depend on where a sweep starts.
Index sweep(const Model& model, const SweepParameters& parameters, const RowSink& sink,
            const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
