// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/tables.hpp"

#include <sys/resource.h>

#include <filesystem>

namespace nscdd::app {
namespace {

struct ProcessCounts {
  Index process = 0;
  WorkCount work;
  double seconds = 0, memory = 0;
};

ResultColumns<ProcessCounts> count_columns() {
  const ResultColumns<WorkCount> of_work{
      {"messages", "1", "sent to one other rank", &WorkCount::messages},
      {"message_bytes", "B", "bytes of these messages", &WorkCount::message_bytes},
      {"sums", "1", "exchanges in which all ranks take part", &WorkCount::sums},
      {"sum_bytes", "B", "contributed by this rank to these exchanges", &WorkCount::sum_bytes},
      {"contact_updates", "1", "of single contacts, in sweeps of Algorithm 1", &WorkCount::contact_updates},
      {"flops", "1", "operations of factorisations and of solves with them", &WorkCount::flops},
      {"path_flops", "1", "on the critical path over all ranks", &WorkCount::path_flops}};
  return joined<ProcessCounts>({{{"process", "", "rank, from 0", &ProcessCounts::process}},
                                columns_of(&ProcessCounts::work, of_work),
                                {{"seconds", "s", "from the first work to the last", &ProcessCounts::seconds},
                                 {"memory", "B", "largest resident set of the process", &ProcessCounts::memory}}});
}

double largest_resident_set() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

SharedTable::SharedTable(const Machine& machine, const std::string& path, const TableWork& work, Reopening how)
    : path_(machine.processes.first() ? path : "/dev/null") {
  const Reopening own = machine.processes.first() ? how : Reopening{};
  kept_ = machine.processes.together([&] { return table_.emplace(path_, work, own).kept(); });
  kept_ = machine.processes.sum(kept_);
}

void CountsTable::declare(Command& command, std::string& path) {
  command.add("--counts FILE", path,
              "also a table of what each process did; its messages, bytes, operations, seconds and memory, - for "
              "standard output");
}

CountsTable::CountsTable(const std::string& path, bool force, const Machine& machine)
    : processes_(machine.processes), wanted_(!path.empty()) {
  processes_.together([&] {
    if (wanted_ && processes_.first()) csv_.emplace(path, force, headings(count_columns()));
    return true;
  });
}

void CountsTable::finish() {
  if (!wanted_) return;
  const ProcessCounts own{processes_.rank, *processes_.counts, seconds() - begun_, largest_resident_set()};
  const std::vector<ProcessCounts> all = processes_.gather_each(own);
  if (!csv_) return;
  for (const ProcessCounts& one : all) csv_->write(row(count_columns(), one));
  csv_->finish();
}

void declare_resume(Command& command, bool& resume) {
  command.add("--resume", resume,
              "go on with the rows of an interrupted run; of the same case, options and program: what is missing is "
              "computed");
}

bool nothing_to_resume(const std::string& csv, const std::string& hdf5, const TableWork& work, Reopening how,
                       const Machine& machine) {
  const Processes& all = machine.processes;
  return all.any(all.together([&] {
    if (!all.first() || !how.resume || how.force || !is_complete(csv)) return false;
    if (!hdf5.empty() && !std::filesystem::exists(hdf5))
      fail(
          "{}: expected rows to resume, met a complete table, and nothing tells what work it came from: {} cannot be "
          "made of it; --force computes both again",
          csv, hdf5);
    require_rows_of(work, csv);
    note("{}: already complete, nothing to resume", csv);
    return true;
  }));
}

int leave(ResumableTable& table, const std::string& path) {
  table.leave();
  const auto total = table.total();
  return interrupted("{}: interrupted after {}{} rows{}", name_of_output(path), table.rows(),
                     total ? fmt::format(" of {}", *total) : "",
                     table.resumable() && total ? "; --resume continues" : "");
}

}  // namespace nscdd::app
