// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/options.hpp"
#include "core/fail.hpp"
#include "files/hdf5.hpp"
#include "study/linear/optimum.hpp"

#include <filesystem>

namespace nscdd::app {
namespace {

using Texts = std::vector<std::string>;

// Whether a row says that it can be relied on.
struct Proof {
  bool converged = true, certified = true;
};

Proof proof_of(const std::vector<Column>& columns, const Texts& row) {
  Proof proof;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    if (columns[j].name == "converged") proof.converged = row[j] == "true";
    if (columns[j].name == "status" && row[j] == to_string(OptimumStatus::not_converged)) proof.converged = false;
    if (columns[j].name == "certified") proof.certified = row[j] == "true";
  }
  return proof;
}

Texts texts_of(const Row& row) {
  Texts texts(row.size());
  std::ranges::transform(row, texts.begin(), to_text);
  return texts;
}

// The work that is a single row of another: one case without variations, one point or number of steps.
StudyTable single_row(const StudyTable& work, Index number) {
  const Index per_case = *row_count(work) / varied_case_count(work), k = number % per_case;
  StudyTable one = work;
  one.cases = {varied_case(work, number / per_case).one};
  one.vary.clear();
  one.vary_together.clear();
  if (work.observable->moving) {
    one.steps = {work.steps[at(k)]};
  } else if (work.observable == &observables::optimum) {
    one.sweep.epsilon = {work.sweep.epsilon[at(k)]};
  } else {
    const SweepPoint point = sweep_point(work.sweep, k);
    one.sweep.epsilon = {point.epsilon};
    one.sweep.eta = {point.eta};
    one.sweep.relaxation = {point.relaxation};
    one.sweep.gauss_seidel_sweeps = {point.gauss_seidel_sweeps};
  }
  return one;
}

// Row `number` of the work, computed from the beginning.
Texts computed(const StudyTable& work, Index number, LeadIn& lead_in) {
  Row row;
  run_table(
      single_row(work, number), [&](const Row& found) { row = found; }, {}, 0, &lead_in);
  const Row varied = varied_case(work, number / (*row_count(work) / varied_case_count(work))).cells;
  row.insert(row.begin() + 1, varied.begin(), varied.end());
  return texts_of(row);
}

void require_text(const std::string& met, const std::string& expected, const std::string& where) {
  if (met != expected) fail("{}: expected {} of this work, met {}", where, expected, met);
}

// What a row says of its case must not change: it would be of another partition or of other contacts.
void require_same_case(const std::vector<Column>& columns, const Texts& before, const Texts& after,
                       const std::string& where) {
  for (const Column& known : headings(case_columns()))
    for (std::size_t j = 0; j < columns.size(); ++j)
      if (columns[j].name == known.name) require_text(before[j], after[j], where + ": " + known.name);
}

// A row of the file, which must be row `number` of the work as far as that is known before it is computed.
Texts known_row(const CsvReader& reader, const StudyTable& work, const Table& layout, Index number,
                const std::string& where) {
  Texts row;
  for (std::size_t k = 0; k < layout.columns.size(); ++k) row.emplace_back(reader.value(k));
  for (const auto& [column, expected] : known_cells(work, number))
    require_text(row[layout.column(column)], to_text(expected), where + ": " + column);
  return row;
}

void require_columns(const Table& layout, const std::string& text, const std::string& path) {
  const std::string header = csv_header(layout.columns);
  if (const std::string met = text.substr(0, text.find('\n')); met != header)
    fail("{}:1: expected the columns {}, met {}", path, header, met);
}

// Puts the rows of a CSV file in the place of those of a table, whose types they have. Returns whether they differ.
bool replace_rows(Table& table, const std::string& path) {
  const CsvText csv = parse_csv(read_text(path), path);
  if (table.rows.empty()) return false;
  const std::vector<std::string> types = cell_types(table.rows.front());
  std::vector<Row> rows;
  for (std::size_t i = 0; i < csv.rows.size(); ++i) {
    const std::string where = fmt::format("{}:{}", path, csv.lines[i]);
    Row& row = rows.emplace_back();
    for (std::size_t j = 0; j < types.size(); ++j) row.push_back(parse_cell(csv.rows[i].at(j), types[j], where));
  }
  const bool differ = !std::ranges::equal(rows, table.rows, {}, texts_of, texts_of);
  table.rows = std::move(rows);
  return differ;
}

}  // namespace

void declare_resume(Command& command, bool& resume) {
  command.add("--resume", resume,
              "go on with the rows of an interrupted run; of the same case, options and program: what is missing is "
              "computed");
}

void declare_redo(Command& command, bool& redo) {
  command.add("--redo", redo,
              "compute rows again that did not converge or are not certified; with the present options");
}

bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how) {
  if (!how.resume || how.force || !is_complete(csv)) return false;
  if (!hdf5.empty() && !std::filesystem::exists(hdf5))
    fail(
        "{}: expected rows to resume, met a complete table, and nothing tells what work it came from: {} cannot be "
        "made of it; --force computes both again",
        csv, hdf5);
  note("{}: already complete, nothing to resume", csv);
  return true;
}

bool nothing_to_resume(const std::string& csv, const std::string& hdf5, Reopening how, const Machine& machine) {
  const Processes& all = machine.processes;
  return all.any(all.together([&] { return all.first() && nothing_to_resume(csv, hdf5, how); }));
}

SharedTable::SharedTable(const Machine& machine, const std::string& path, const TableWork& work, Reopening how)
    : path_(machine.processes.first() ? path : "/dev/null") {
  const Reopening own = machine.processes.first() ? how : Reopening{};
  kept_ = machine.processes.together([&] { return table_.emplace(path_, work, own).kept(); });
  kept_ = static_cast<Index>(machine.processes.sum(static_cast<double>(kept_)));
}

int leave(ResumableTable& table, const std::string& path) {
  table.leave();
  const auto total = table.total();
  note("{}: interrupted after {}{} rows{}", path == "-" ? "standard output" : path, table.rows(),
       total ? fmt::format(" of {}", *total) : "", table.resumable() && total ? "; --resume continues" : "");
  return interrupted_exit_code;
}

void repair_table(const StudyTable& work, const std::string& path, Interruption& interruption, LeadIn& lead_in,
                  Repaired& repaired) {
  if (!row_count(work)) return;
  const Table layout{study_columns(work), {}};
  const Index total = *row_count(work), before = repaired.rows;
  const std::string text = read_text(path);
  OutputFile file(path, true);
  file.line(csv_header(layout.columns));
  require_columns(layout, text, path);
  const Monitor monitor = interruption.watch("redo " + work.name);
  CsvReader reader(text, path);
  Index number = 0;
  for (; reader.next(); ++number) {
    const std::string where = fmt::format("{}:{}", path, reader.line());
    if (number >= total) fail("{}: expected {} rows of this work, met another", where, total);
    Texts row = known_row(reader, work, layout, number, where);
    const Proof found = proof_of(layout.columns, row);
    const bool open = !found.converged || !found.certified;
    repaired.left += open && interruption.stopped();
    if (open && !interruption.stopped()) {
      const Texts old = std::exchange(row, computed(work, number, lead_in));
      require_same_case(layout.columns, old, row, where);
      const Proof proof = proof_of(layout.columns, row);
      ++repaired.rows;
      repaired.not_converged += !proof.converged;
      repaired.not_certified += proof.converged && !proof.certified;
    }
    file.line(csv_line({row.begin(), row.end()}));
    report(monitor, number + 1, total);
  }
  if (number < total) fail("{}: expected {} rows of this work, met {}; --resume completes it", path, total, number);
  if (repaired.rows > before) file.finish();
}

void require_rows_of(const StudyTable& work, const std::string& path) {
  const Table layout{study_columns(work), {}};
  const std::string text = read_text(path);
  require_columns(layout, text, path);
  const std::optional<Index> total = row_count(work);
  if (!total) return;
  CsvReader reader(text, path);
  Index number = 0;
  for (; reader.next() && number < *total; ++number)
    known_row(reader, work, layout, number, fmt::format("{}:{}", path, reader.line()));
  if (number < *total || reader.next()) fail("{}: expected {} rows of this work, met another number", path, *total);
}

void update_tables(const std::string& hdf5, const std::string& command_line) {
  TablesFile content = tables_from_hdf5(read_text(hdf5), hdf5);
  const std::filesystem::path folder = std::filesystem::path(hdf5).parent_path();
  bool changed = false;
  for (auto& [name, table] : content.tables)
    changed = replace_rows(table, (folder / (name + ".csv")).string()) || changed;
  if (!changed) return;
  auto redone = std::ranges::find(content.provenance, "redone", &Provenance::value_type::first);
  if (redone == content.provenance.end()) redone = content.provenance.insert(redone, {"redone", ""});
  redone->second += command_line + "\n";
  write_file(hdf5, to_hdf5(content.provenance, content.tables), true);
}

int explain(const Repaired& repaired, const std::string& what) {
  if (repaired.not_converged > 0) note("{} row(s) still did not converge", repaired.not_converged);
  if (repaired.not_certified > 0)
    note("{} row(s) converged but are still not certified: see the column 'certified'", repaired.not_certified);
  if (repaired.rows == 0 && repaired.left == 0) note("{}: no row to compute again", what);
  if (repaired.left == 0) return 0;
  note("{}: interrupted: {} row(s) computed again, {} left as they were; --redo continues", what, repaired.rows,
       repaired.left);
  return interrupted_exit_code;
}

int redo_table(const StudyTable& work, const std::string& path) {
  Interruption interruption;
  LeadIn unused;
  Repaired repaired;
  repair_table(work, path, interruption, unused, repaired);
  return explain(repaired, path);
}

}  // namespace nscdd::app
