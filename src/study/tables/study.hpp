// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/resumable_table.hpp"
#include "study/case/lead_in.hpp"
#include <nscdd/study/sweep.hpp>

#include <fmt/format.h>

namespace nscdd {

struct StudyTable;
struct ObservedCase;

/// Cells of a row that are known before it is computed, by column.
using KnownCells = std::vector<std::pair<std::string, Cell>>;

/// What a table of a study measures.
struct Observable {
  std::string_view name, summary;             ///< in study files and of `nscdd list`
  std::array<std::string_view, 8> keys = {};  ///< of a study file, apart from those that every observable uses
  std::vector<Column> (*columns)(const StudyTable&) = nullptr;  ///< of its results, `case` the first
  Index (*run)(const ObservedCase&) = nullptr;  ///< computes the rows of a case; returns how many did not converge
  /// How many rows each case has, and what is known of one of them (counted within its case). Null if the number is
  /// not known before the case is built.
  Index (*rows)(const StudyTable&) = nullptr;
  KnownCells (*known)(const StudyTable&, Index row) = nullptr;
  bool moving = false;      ///< of cases that move
  Index first_step = 1;     ///< smallest of `steps`: 1 where a step is examined, 0 where steps are done
  bool own_solver = false;  ///< cases get there with their own solver only
  /// Throws Error for a case to which it does not apply, as far as that is known before the case is built.
  void (*check)(const CaseSpec&) = nullptr;

  bool uses(std::string_view key) const { return std::find(keys.begin(), keys.end(), key) != keys.end(); }
};

namespace observables {
extern const Observable spectral_radius, optimum, observed_rate, links, grains, indicators, solver_indicators,
    configuration, force_chains, predicted_observed, rate_at_solution, runs, switching, contact_solvers,
    interface_iterations;

/// Every observable, in the order of `nscdd list`.
inline constexpr std::array all{&spectral_radius,
                                &optimum,
                                &observed_rate,
                                &links,
                                &grains,
                                &indicators,
                                &solver_indicators,
                                &configuration,
                                &force_chains,
                                &predicted_observed,
                                &rate_at_solution,
                                &runs,
                                &switching,
                                &contact_solvers,
                                &interface_iterations};
}  // namespace observables

/// A case parameter taken through a list of values, such as packing.grains.
struct Variation {
  std::string parameter;
  std::vector<std::string> values;
};

/// One table of a study: cases x variations x sweep.
struct StudyTable {
  std::string name;
  const Observable* observable = &observables::spectral_radius;
  std::vector<Case> cases;
  /// Parameters that change at once; their lists have equal lengths.
  std::vector<Variation> vary_together;
  std::vector<Variation> vary;  ///< every combination for each place of `vary_together`, the last one running fastest
  SweepParameters sweep;
  std::uint64_t seed = 1;
  std::vector<Index> steps{1};  ///< of a case that moves: the step examined (from 1), or steps done (from 0)
  LeadInSolver lead_in = LeadInSolver::plain;          ///< of a case that moves: how it gets there
  std::vector<std::string> contact_solvers = {"all"};  ///< by their names
  bool large = false;                                  ///< run only where large tables are asked for
  bool baseline = true;           ///< whether the study keeps one (a picture of thousands of disks does not)
  double check_tolerance = 1e-8;  ///< of a comparison with the baseline, times max(1, |number|)
  std::map<std::string, double> column_tolerance;  ///< for single columns instead of it
  bool check_relative = false;                     ///< times |number| alone, for columns that fall over decades
};

/// The work of an observable on one case of a table. The monitor counts rows, where their number is known.
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

/// 2 in the plane, 3 in space. Throws Error if a table of grains or contacts has cases of both. It is 3 if no resolved
/// case determines it, as while a study file is read: in space a table has every possible column.
Index dimension_of(const StudyTable& table);

/// Rows of a study table, where they are known before its cases are built: not so for links and grains.
std::optional<Index> row_count(const StudyTable& table);

/// What is known of a row (from 0). Nothing where the number of rows is not known.
KnownCells known_cells(const StudyTable& table, Index row);

/// The coordinates of a point of the sweep of a table, but for an optimal relaxation.
KnownCells known_of_point(const StudyTable& table, Index number);

/// The cases of a table with every combination of its varied parameters, from 0, the combinations running fastest.
struct VariedCase {
  Case one;
  Row cells;  ///< of the varied parameters
};
Index varied_case_count(const StudyTable& table);
VariedCase varied_case(const StudyTable& table, Index number);

/// Computes the rows of a table from `first` on; returns how many did not converge. Throws Error naming a case that
/// cannot be built, and for `first` > 0 if the number of rows is not known beforehand. The monitor counts rows, or
/// cases if that number is not known. Tables that look at the same cases on the way may share the `lead_in`.
Index run_table(const StudyTable& table, const RowSink& sink, const Monitor& monitor = {}, Index first = 0,
                LeadIn* lead_in = nullptr);

/// The program, its build and the libraries: what numbers depend on beside their input.
std::string code_identity();

/// What the rows of a table come from, and the table as a resumable file takes it; `table` must outlive the latter.
WorkIdentity work_identity(const StudyTable& table);
TableWork table_work(const StudyTable& table);

/// The columns of a vector, one along x, one along y and in space one along z: `name` has {} for the direction, and
/// component(result, k) is the k-th number.
template <class Result, class Component>
ResultColumns<Result> vector_columns(Index dimension, std::string_view name, const std::string& unit,
                                     const std::string& description, Component component) {
  ResultColumns<Result> columns;
  for (Index k = 0; k < dimension; ++k)
    columns.push_back({fmt::format(fmt::runtime(name), "xyz"[k]), unit, description,
                       [component, k](const Result& result) { return component(result, k); }});
  return columns;
}

/// The k-th coordinate of a grain of a packing or a state, m.
double coordinate(const auto& of, Index grain, Index k) { return (k == 0 ? of.x : k == 1 ? of.y : of.z)[at(grain)]; }

}  // namespace nscdd
