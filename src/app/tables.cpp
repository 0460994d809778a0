// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/tables.hpp"

#include "core/fail.hpp"

#include <filesystem>

namespace nscdd::app {

void declare_resume(Command& command, bool& resume) {
  command.add("--resume", resume,
              "go on with the rows of an interrupted run; of the same case, options and program: what is missing is "
              "computed");
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
  kept_ = machine.processes.sum(kept_);
}

int leave(ResumableTable& table, const std::string& path) {
  table.leave();
  const auto total = table.total();
  note("{}: interrupted after {}{} rows{}", path == "-" ? "standard output" : path, table.rows(),
       total ? fmt::format(" of {}", *total) : "", table.resumable() && total ? "; --resume continues" : "");
  return interrupted_exit_code;
}

void require_rows_of(const StudyTable& work, const std::string& path) {
  const Table layout{study_columns(work), {}};
  const std::string text = read_text(path), header = csv_header(layout.columns);
  if (const std::string met = text.substr(0, text.find('\n')); met != header)
    fail("{}:1: expected the columns {}, met {}", path, header, met);
  const std::optional<Index> total = row_count(work);
  if (!total) return;
  CsvReader reader(text, path);
  Index number = 0;
  for (; reader.next() && number < *total; ++number)
    for (const auto& [column, expected] : known_cells(work, number))
      if (const std::string met(reader.value(layout.column(column))); met != to_text(expected))
        fail("{}:{}: {}: expected {} of this work, met {}", path, reader.line(), column, to_text(expected), met);
  if (number < *total || reader.next()) fail("{}: expected {} rows of this work, met another number", path, *total);
}

}  // namespace nscdd::app
