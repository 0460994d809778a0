// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/tables/study.hpp"

#include "core/fail.hpp"
#include "core/text.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

std::optional<Index> rows_per_case(const StudyTable& table) {
  return table.observable->rows == nullptr ? std::nullopt : std::optional(table.observable->rows(table));
}

// The value at a place of a list: a number if all values of the list are numbers, because a column has one type.
Cell cell_of(const std::vector<std::string>& values, Index place) {
  try {
    std::vector<double> numbers;
    for (const std::string& value : values) numbers.push_back(parse_number(value, "value"));
    return numbers[at(place)];
  } catch (const Error&) {
    return values[at(place)];
  }
}

// The length of the lists of parameters that change together.
Index places_together(const StudyTable& table) {
  return table.vary_together.empty() ? 1 : count(table.vary_together[0].values);
}

// A case with a place in the list of each varied parameter, in the order of their columns.
struct Combination {
  const Case& base;
  std::vector<std::pair<const Variation&, Index>> places;
};

Combination combination_of(const StudyTable& table, Index number) {
  Index stride = varied_case_count(table) / count(table.cases);
  Combination combination{table.cases[at(number / stride)], {}};
  Index rest = number % stride;
  stride /= places_together(table);
  for (const Variation& variation : table.vary_together) combination.places.emplace_back(variation, rest / stride);
  for (const Variation& variation : table.vary) {
    rest %= stride;
    stride /= count(variation.values);
    combination.places.emplace_back(variation, rest / stride);
  }
  return combination;
}

constexpr Index shown_values = 64;  // longer lists are identified by their fingerprint

std::string list_text(const std::vector<std::string>& items) {
  const std::string text = fmt::format("{}", fmt::join(items, ", "));
  if (count(items) <= shown_values) return fmt::format("[{}]", text);
  return fmt::format("[{}, ..., {}], {} values, content {}", items.front(), items.back(), items.size(),
                     fingerprint(text));
}

// The text of a list of numbers, with `empty` for empty ones.
std::string number_list(const auto& values, const char* empty = "") {
  std::vector<std::string> texts;
  for (const std::optional value : values) texts.push_back(value ? field_text(*value) : empty);
  return list_text(texts);
}

std::string options_text(const StudyTable& table) {
  const SweepParameters& sweep = table.sweep;
  std::string text = fmt::format("observable = {}\n", table.observable->name);
  for (const Variation& variation : table.vary_together)
    text += fmt::format("together {} = {}\n", variation.parameter, list_text(variation.values));
  for (const Variation& variation : table.vary)
    text += fmt::format("{} = {}\n", variation.parameter, list_text(variation.values));
  text += fmt::format("epsilon = {}{}\neta = {}{}\nrelaxation = {}\ngauss_seidel_sweeps = {}\ncontacts = {}\n",
                      number_list(sweep.epsilon), sweep.relative_epsilon ? " W" : "", number_list(sweep.eta),
                      sweep.relative_eta ? " W" : "", number_list(sweep.relaxation, "optimal"),
                      number_list(sweep.gauss_seidel_sweeps, "inf"), to_string(sweep.contacts));
  if (table.observable->uses("coarse_space"))
    for (const CoarseMethod& method : methods_of(table.coarse))
      text +=
          fmt::format("coarse = {} {} {} {} {}\n", method.preconditioner ? to_string(*method.preconditioner) : "counts",
                      method.scaling ? to_string(*method.scaling) : "none", to_string(method.space),
                      field_text(table.coarse.kappa.value_or(0)), field_text(table.coarse.threshold.value_or(0)));
  if (sweep.schwarz()) text += "scheme = schwarz\n";
  if (table.observable->moving)
    text += fmt::format("steps = {}\nlead_in = {}\n", fmt::join(table.steps, ", "), to_string(table.lead_in));
  if (table.observable->uses("contact_solvers"))
    text += fmt::format("contact_solvers = {}\n", fmt::join(table.contact_solvers, ", "));
  return text + fmt::format("seed = {}\n", table.seed);
}

// All members of SpectralOptions but the factorisation, which no study chooses.
std::string effort_text(const SpectralOptions& options) {
  return field_lines(options) +
         fmt::format("dense_limit = {}\nbasis = {}\nmaximum_restarts = {}\narpack_tolerance = {}\n",
                     options.dense_limit, options.arpack.basis, options.arpack.maximum_restarts,
                     options.arpack.tolerance);
}

}  // namespace

std::vector<Column> study_columns(const StudyTable& table) {
  std::vector<Column> columns = table.observable->columns(table);
  auto place = columns.begin() + 1;
  for (const auto& variations : {table.vary_together, table.vary})
    for (const Variation& variation : variations)
      place = columns.insert(place, {variation.parameter, "", "parameter of the case, varied by the study"}) + 1;
  return columns;
}

Index dimension_of(const StudyTable& table) {
  const auto knows = [](const Case& one) { return dimension_of(one).has_value(); };
  const auto first = std::ranges::find_if(table.cases, knows);
  if (first == table.cases.end()) return 3;
  const auto where = [](const Case& one) { return *dimension_of(one) == 2 ? "the plane" : "space"; };
  for (const Case& other : table.cases)
    if (knows(other) && dimension_of(other) != dimension_of(*first))
      fail("table {}: expected cases of one dimension, met {} in {} and {} in {}", table.name, first->spec.name,
           where(*first), other.spec.name, where(other));
  return *dimension_of(*first);
}

std::optional<Index> row_count(const StudyTable& table) {
  const auto rows = rows_per_case(table);
  return rows ? std::optional(*rows * varied_case_count(table)) : std::nullopt;
}

KnownCells known_cells(const StudyTable& table, Index row) {
  const auto rows = rows_per_case(table);
  if (!rows) return {};
  const auto [base, places] = combination_of(table, row / *rows);
  KnownCells cells{{"case", base.spec.name}};
  for (const auto& [variation, place] : places)
    cells.emplace_back(variation.parameter, cell_of(variation.values, place));
  std::ranges::copy(table.observable->known(table, row % *rows), std::back_inserter(cells));
  return cells;
}

Index varied_case_count(const StudyTable& table) {
  Index combinations = places_together(table);
  for (const Variation& variation : table.vary) combinations *= count(variation.values);
  return combinations * count(table.cases);
}

VariedCase varied_case(const StudyTable& table, Index number) {
  const auto [base, places] = combination_of(table, number);
  VariedCase varied{base, {}};
  for (const auto& [variation, place] : places) {
    varied.cells.push_back(cell_of(variation.values, place));
    override_case(varied.one.spec, variation.parameter, variation.values[at(place)]);
  }
  return varied;
}

Index run_table(const StudyTable& table, const RowSink& sink, const Monitor& monitor, Index first, LeadIn* lead_in) {
  const std::optional<Index> rows = rows_per_case(table);
  if (!rows && first > 0)
    fail("table {}: expected to start at row 0, met {}: its rows are not known beforehand", table.name, first);
  const Index cases = varied_case_count(table), total = cases * rows.value_or(1);
  Index failed = 0;
  bool stopped = false;
  LeadIn own;
  LeadIn& states = lead_in == nullptr ? own : *lead_in;
  for (Index number = rows ? first / *rows : 0; number < cases && !stopped; ++number) {
    const auto [one, cells] = varied_case(table, number);
    const RowSink with_varied = [&sink, &varied = cells](const Row& row) {
      Row full = row;
      full.insert(full.begin() + 1, varied.begin(), varied.end());
      sink(full);
    };
    const Monitor within = [&](Index done, Index) {
      stopped = !report(monitor, number * *rows + done, total);
      return !stopped;
    };
    try {
      const Index known = rows ? std::max<Index>(first - number * *rows, 0) : 0;
      failed += table.observable->run({one, table, states, with_varied, within, known});
    } catch (const Error& error) {
      fail("case {}: {}", one.spec.name, error.what());
    }
    if (!rows) stopped = !report(monitor, number + 1, total);
  }
  return failed;
}

std::string libraries() {
  std::string text;
  for (const auto& [name, number] : dependency_versions()) text += fmt::format("{} {}\n", name, number);
  return text;
}

std::string code_identity() {
  return fmt::format("nscdd {}\nbuild {}\n{}", version(), build_fingerprint(), libraries());
}

WorkIdentity work_identity(const StudyTable& table) {
  std::string cases;
  for (const Case& one : table.cases) cases += text_with_contents(one, one.spec);
  return {code_identity(), cases, options_text(table), effort_text(table.sweep.spectral)};
}

TableWork table_work(const StudyTable& table) {
  return {work_identity(table), study_columns(table), row_count(table),
          [&table](Index row) { return known_cells(table, row); }};
}

}  // namespace nscdd
