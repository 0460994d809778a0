// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/linear/inspection.hpp"
#include "study/linear/modes.hpp"
#include "study/linear/optimum.hpp"

namespace nscdd {

/// What the page of one packing shows (`nscdd report`).
struct PackingReportParameters {
  /// The grid of flexibilities, ascending, each value once. Stage 1 is exact and not relaxed; `contacts` is unused.
  SweepParameters sweep;
  std::vector<ContactSet> contact_sets;  ///< of Stage 1, with a grid each
  bool optima = true;                    ///< with the best eta of every epsilon
  Index mode_velocities = 1'500'000;     ///< most velocity components of all modes kept; at least one mode is kept
};

/// The slowest mode at a point of the grid.
struct KeptMode {
  Index epsilon = 0, eta = 0;              ///< places in the lists of flexibilities
  SpectrumSide side = SpectrumSide::high;  ///< `low` or `high`
  double eigenvalue = not_a_number;
  /// x, y and in space z of every copy, by grain and subdomain, relative to the largest speed, with the sign of Mode.
  std::vector<float> velocities;
};

/// Radii over the grid with one set of contacts in Stage 1.
struct RadiusGrid {
  ContactSet contacts = ContactSet::all;
  ContactChoice choice;
  std::vector<SweepResult> points;  ///< in the order of a sweep: eta runs fastest. Without vectors of modes
  std::vector<OptimumResult> best;  ///< of every epsilon; empty if not asked for
  std::vector<KeptMode> modes;      ///< ascending by epsilon and eta
  Index modes_asked = 0;            ///< points of which a mode was to be kept
};

struct PackingReport {
  std::vector<double> epsilon, eta;  ///< of the grid, 1/kg
  double scale = 1;                  ///< flexibility_scale of the case, 1/kg
  DecompositionScheme scheme = DecompositionScheme::nscdd;
  Inspection inspection;  ///< of packings without ranks
  Vector impulses;        ///< of the contacts in the linear rigid problem, kg m/s; empty without a load
  std::vector<RadiusGrid> grids;
};

/// The sets of contacts that a model allows: all, and with a load those active by the paper's rule, without friction.
std::vector<ContactSet> contact_sets_of(const Model& model);

/// Computes the report. None if the monitor stops it. Throws Error as choose_contacts.
std::optional<PackingReport> report_packing(const Model& model, const PackingReportParameters& parameters,
                                            const Monitor& monitor = {});

/// Points of a grid with modes, evenly spread with both ends: at most `most`, at least that of row 0, last column.
struct ModePlaces {
  std::vector<Index> rows, columns;
  bool hold(Index row, Index column) const;
};
ModePlaces mode_places(Index rows, Index columns, Index most);

}  // namespace nscdd
