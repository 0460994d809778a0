// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/monitor.hpp>
#include <nscdd/core/table.hpp>
#include <nscdd/study/case.hpp>
#include <nscdd/study/lead_in.hpp>
#include <nscdd/study/sweep.hpp>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nscdd {

/// What a table of a study measures: one word here and one branch in `run_table`.
enum class Observable {
  spectral_radius,     ///< rows of a sweep
  optimum,             ///< best eta per case and epsilon
  observed_rate,       ///< predicted beside fitted rate
  links,               ///< contact network with impulses
  grains,              ///< grains with multiplicities
  indicators,          ///< every iteration of a step of a moving case
  configuration,       ///< disks of a moving case after some steps
  force_chains,        ///< impulses of a moving case after some steps
  predicted_observed,  ///< rate of a step with friction: frozen statuses beside the run
  runs,                ///< whole runs of a moving case with its own solver
};

/// Name and summary of each observable, in the order of the enumeration.
inline constexpr std::array<std::pair<std::string_view, std::string_view>, 10> observables{{
    {"spectral_radius", "spectral radius of the contraction operator at every point of a sweep"},
    {"optimum", "best flexibility eta of the enriched algorithm, with and without relaxation"},
    {"observed_rate", "rate fitted to a run of the algorithm, beside the predicted radius"},
    {"links", "contact network: grains, normal, subdomain, impulse, active"},
    {"grains", "grains: position, radius, mass, multiplicity, prescribed velocity"},
    {"indicators", "indicators of every iteration of a step of a case that moves"},
    {"configuration", "disks of a case that moves after some steps, with their subdomains"},
    {"force_chains", "contacts with their impulses of a case that moves after some steps"},
    {"predicted_observed", "rate of a step with friction, predicted at its frozen statuses and observed"},
    {"runs",
     "runs of a case that moves with its own solver: iterations, residuals, distance from Gauss-Seidel"},
}};

/// Whether an observable is one of cases that move.
bool moves(Observable observable);

/// A case parameter taken through a list of values, such as packing.grains.
struct Variation {
  std::string parameter;
  std::vector<std::string> values;
};

/// One table of a study: cases x variations x sweep, through one observable.
struct StudyTable {
  std::string name;
  Observable observable = Observable::spectral_radius;
  std::vector<Case> cases;
  /// Parameters that change at once, from one place of their lists (of equal lengths) to the next; for each
  /// place there is every combination of `vary`.
  std::vector<Variation> vary_together;
  std::vector<Variation> vary;  ///< every combination, the last one running fastest
  SweepParameters sweep;
  std::uint64_t seed = 1;
  std::vector<Index> steps{1};  ///< of a case that moves: the step examined (from 1), or steps done (from 0)
  LeadInSolver lead_in = LeadInSolver::plain;  ///< of a case that moves: how it gets there
  bool large = false;                          ///< run only where large tables are asked for
  bool baseline = true;  ///< whether the study keeps one (a picture of thousands of disks does not)
  /// What a comparison with the baseline allows for, times max(1, |number|), and for single columns instead
  /// of it (the place of a flat minimum is known less well than its value).
  double check_tolerance = 1e-8;
  std::map<std::string, double> column_tolerance;
  bool check_relative = false;  ///< times |number| alone, for columns that fall over decades
};

/// A study folder, resolved.
struct Study {
  std::string name;
  std::string title;
  std::vector<StudyTable> tables;
};

/// Columns of a study table: those of its observable, with one column per varied parameter (those of
/// `vary_together` first) after `case`.
std::vector<Column> study_columns(const StudyTable& table);

/// Rows of a study table, where they are known before its cases are built: not so for links and grains.
std::optional<Index> row_count(const StudyTable& table);

/// The cells of a row (from 0) that are known before it is computed, by column: case, varied parameters and
/// the coordinates of its point. None for links and grains.
std::vector<std::pair<std::string, Cell>> known_cells(const StudyTable& table, Index row);

/// The case with one combination of the varied parameters, and their cells.
struct VariedCase {
  Case one;
  Row cells;
};

/// The cases of a table with every combination of its varied parameters, from 0, the combinations running
/// fastest.
Index varied_case_count(const StudyTable& table);
VariedCase varied_case(const StudyTable& table, Index number);

/// Rows of a study table from row `first` on, as they come; returns how many of them did not converge. No
/// case is built whose rows are all known. Throws Error naming the case where one cannot be built, and for
/// `first` > 0 where the number of rows is not known beforehand. The monitor counts rows (cases where the
/// number of rows is not known). Tables that look at the same cases on the way may share the `lead_in`.
Index run_table(const StudyTable& table, const RowSink& sink, const Monitor& monitor = {}, Index first = 0,
                LeadIn* lead_in = nullptr);

}  // namespace nscdd
