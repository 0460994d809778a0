// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/repair_table.hpp"

#include "app/progress.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/files/csv.hpp>
#include <nscdd/files/output_file.hpp>

#include <fmt/format.h>

#include <vector>

namespace nscdd::app {
namespace {

std::string csv_line(const Row& row) {
  std::string line;
  for (const Cell& cell : row) line += (line.empty() ? "" : ",") + to_text(cell);
  return line;
}

// What is known of a row before it is computed: the case and the coordinates of the point.
void require_row_of(const Row& expected_head, const StudyTable& work, Index number,
                    const std::vector<std::string>& values, const std::string& where) {
  const Table layout{headings(sweep_columns(work.sweep)), {}};
  const auto require = [&](std::size_t column, const Cell& expected) {
    if (values[column] != to_text(expected))
      throw Error(fmt::format("{}: {}: expected {} of this sweep, met {}", where, layout.columns[column].name,
                              to_text(expected), values[column]));
  };
  for (std::size_t k = 0; k < expected_head.size(); ++k) require(k, expected_head[k]);
  for (const auto& [column, expected] : known_cells(work, number)) require(layout.column(column), expected);
}

SweepParameters only(const SweepParameters& sweep, Index number) {
  const SweepPoint point = sweep_point(sweep, number);
  SweepParameters one = sweep;
  one.epsilon = {point.epsilon};
  one.eta = {point.eta};
  one.relaxation = {point.relaxation};
  one.gauss_seidel_sweeps = {point.gauss_seidel_sweeps};
  return one;
}

}  // namespace

Redone redo_unproved(const Model& model, const StudyTable& work, const std::string& path,
                     Interruption& interruption) {
  const std::string text = read_text(path);
  CsvReader reader(text, path);
  const ResultColumns<SweepResult> columns = sweep_columns(work.sweep);
  const Table layout{headings(columns), {}};
  const std::string header = csv_header(layout.columns);
  if (std::string met; (met = text.substr(0, text.find('\n'))) != header)
    throw Error(fmt::format("{}:1: expected the columns {}, met {}", path, header, met));
  const std::size_t converged = layout.column("converged");
  const bool certify = work.sweep.spectral.certify;
  const std::size_t certified = certify ? layout.column("certified") : 0;
  const Row head = row(case_columns(), summary(model, select(model, work.sweep.contacts)));
  const Index total = point_count(work.sweep);
  OutputFile file(path, true);
  file.line(header);
  Progress progress("redo", 0);
  const Monitor monitor = interruption.watch(progress.monitor());
  Redone redone;
  Index number = 0;
  while (reader.next()) {
    const std::string where = fmt::format("{}:{}", path, reader.line());
    if (number >= total)
      throw Error(fmt::format("{}: expected {} rows of this sweep, met another", where, total));
    std::vector<std::string> values;
    for (std::size_t k = 0; k < layout.columns.size(); ++k) values.emplace_back(reader.value(k));
    require_row_of(head, work, number, values, where);
    std::string line;
    for (const std::string& value : values) line += (line.empty() ? "" : ",") + value;
    const bool unproved = values[converged] != "true" || (certify && values[certified] != "true");
    if (unproved && interruption.stopped()) ++redone.left;
    if (unproved && !interruption.stopped())
      sweep(model, only(work.sweep, number), [&](const SweepResult& result) {
        ++redone.rows;
        if (!result.radius.converged)
          ++redone.not_converged;
        else if (certify && !result.radius.certified)
          ++redone.not_certified;
        line = csv_line(row(columns, result));
      });
    file.line(line);
    report(monitor, ++number, total);
  }
  if (number < total)
    throw Error(fmt::format("{}: expected {} rows of this sweep, met {}; --resume completes it", path, total,
                            number));
  file.finish();
  return redone;
}

}  // namespace nscdd::app
