// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/resumable_table.hpp"
#include "study/case/lead_in.hpp"
#include "study/tables/coarse_parameters.hpp"
#include <nscdd/study/sweep.hpp>

#include <fmt/format.h>

namespace nscdd {

struct StudyTable;
struct ObservedCase;

/// Cells of a row that are known before it is computed, by column.
using KnownCells = std::vector<std::pair<std::string, Cell>>;

/// What a table of a study measures.
struct Observable {
  std::string_view name, summary;              ///< in study files and in `nscdd list`
  std::array<std::string_view, 10> keys = {};  ///< of a study file, apart from those that every observable uses
  std::vector<Column> (*columns)(const StudyTable&) = nullptr;  ///< of its results, `case` the first
  Index (*run)(const ObservedCase&) = nullptr;  ///< computes the rows of a case; returns how many did not converge
  /// The number of rows of each case, and the known cells of one of them. Null if the case must be built for it.
  Index (*rows)(const StudyTable&) = nullptr;
  KnownCells (*known)(const StudyTable&, Index row) = nullptr;
  bool moving = false;      ///< of cases that move
  Index first_step = 1;     ///< smallest of `steps`: 1 if a step is examined, 0 if steps are done
  bool own_solver = false;  ///< the steps before are solved by the solver of the case
  /// Throws Error for a case to which it does not apply, as far as known before the case is built.
  void (*check)(const CaseSpec&) = nullptr;

  bool uses(std::string_view key) const { return std::find(keys.begin(), keys.end(), key) != keys.end(); }
};

namespace observables {
extern const Observable spectral_radius, optimum, observed_rate, links, grains, indicators, solver_indicators,
    configuration, force_chains, predicted_observed, rate_at_solution, runs, switching, contact_solvers,
    interface_iterations, coarse_space, verdicts;

/// Every observable, in the order of `nscdd list`.
inline constexpr auto all = std::to_array<const Observable*>(
    {&spectral_radius, &optimum, &observed_rate, &links, &grains, &indicators, &solver_indicators, &configuration,
     &force_chains, &predicted_observed, &rate_at_solution, &runs, &switching, &contact_solvers, &interface_iterations,
     &coarse_space, &verdicts});
}  // namespace observables

/// A case parameter, such as packing.grains, and its values.
struct Variation {
  std::string parameter;
  std::vector<std::string> values;
};

/// One table of a study: cases x variations x sweep.
struct StudyTable {
  std::string name;
  const Observable* observable = &observables::spectral_radius;
  std::vector<Case> cases = {};
  std::vector<Variation> vary_together = {};  ///< parameters that change together; their lists have equal lengths
  std::vector<Variation> vary = {};  ///< every combination for each place of `vary_together`, the last running fastest
  SweepParameters sweep = {};
  CoarseParameters coarse = {};
  std::uint64_t seed = 1;
  std::vector<Index> steps{1};  ///< of a case that moves: the step examined (from 1), or steps done (from 0)
  Choice<LeadInSolver> lead_in = LeadInSolver::plain;  ///< of a case that moves: of the steps before
  std::vector<std::string> contact_solvers = {"all"};  ///< by their names
  bool large = false;                                  ///< run only if large tables are asked for
  bool baseline = true;           ///< whether the study keeps one (a picture of thousands of disks does not)
  double check_tolerance = 1e-8;  ///< of a comparison with the baseline, times max(1, |number|)
  std::map<std::string, double> column_tolerance = {};  ///< for single columns instead
  bool check_relative = false;                          ///< times |number|, for columns that fall over decades
};

/// The work of an observable on one case of a table. The monitor counts rows, if their number is known.
struct ObservedCase {
  const Case& one;
  const StudyTable& table;
  LeadIn& lead_in;
  const RowSink& sink;
  const Monitor& monitor;
  Index first = 0;  ///< row of the case to begin with
};

/// A study folder, resolved.
struct Study {
  std::string name;
  std::string title;
  std::vector<StudyTable> tables;
};

/// Columns of a table: those of its observable, with varied parameters after `case`.
std::vector<Column> study_columns(const StudyTable& table);

/// 2 in the plane, 3 in space. It is 3 if no resolved case determines it, as while a study file is read: in space a
/// table has every possible column. Throws Error for cases of both.
Index dimension_of(const StudyTable& table);

/// Rows of a study table, if known before its cases are built: not those of links and grains.
std::optional<Index> row_count(const StudyTable& table);

/// The known cells of a row (from 0). None if the number of rows is not known.
KnownCells known_cells(const StudyTable& table, Index row);

/// The coordinates of a point of the sweep of a table, without an optimal relaxation.
KnownCells known_of_point(const StudyTable& table, Index number);

/// The cases of a table with every combination of its varied parameters, from 0, the combinations running fastest.
struct VariedCase {
  Case one;
  Row cells;  ///< of the varied parameters
};
Index varied_case_count(const StudyTable& table);
VariedCase varied_case(const StudyTable& table, Index number);

/// Computes the rows of a table from `first` on; returns how many did not converge. Throws Error naming a case that
/// cannot be built, and for `first` > 0 if the number of rows is not known. The monitor counts rows, or cases if that
/// number is not known. Tables of the same cases may share the `lead_in`.
Index run_table(const StudyTable& table, const RowSink& sink, const Monitor& monitor = {}, Index first = 0,
                LeadIn* lead_in = nullptr);

/// Names and versions of the libraries, one a line.
std::string libraries();

/// The program, its build and the libraries, on which numbers depend besides their input.
std::string code_identity();

/// All that the rows of a table depend on, and the table for a resumable file; `table` must outlive the latter.
WorkIdentity work_identity(const StudyTable& table);
TableWork table_work(const StudyTable& table);

/// The columns of a vector along x, y and, in space, z. `name` has {} for it; component(result, k) is the k-th number.
template <class Result, class Component>
ResultColumns<Result> vector_columns(Index dimension, std::string_view name, const std::string& unit,
                                     const std::string& description, Component component) {
  ResultColumns<Result> columns;
  for (Index k = 0; k < dimension; ++k)
    columns.push_back({fmt::format(fmt::runtime(name), "xyz"[k]), unit, description,
                       [component, k](const Result& result) { return component(result, k); }});
  return columns;
}

}  // namespace nscdd
