// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/counts_table.hpp"

#include <sys/resource.h>

namespace nscdd::app {
namespace {

struct ProcessCounts {
  Index process = 0;
  WorkCount work;
  double seconds = 0, memory = 0;
};

template <class Count>
ResultColumn<ProcessCounts> counted(std::string name, std::string unit, std::string description, Count count) {
  return {std::move(name), std::move(unit), std::move(description),
          [count](const ProcessCounts& one) { return one.work.*count; }};
}

ResultColumns<ProcessCounts> columns() {
  return {{"process", "", "from 0", &ProcessCounts::process},
          counted("messages", "1", "sent to one other process", &WorkCount::messages),
          counted("message_bytes", "B", "in these", &WorkCount::message_bytes),
          counted("sums", "1", "exchanges in which all processes take part", &WorkCount::sums),
          counted("sum_bytes", "B", "that this process put into these", &WorkCount::sum_bytes),
          counted("contact_updates", "1", "of single contacts, in sweeps of Algorithm 1", &WorkCount::contact_updates),
          counted("flops", "1", "operations of factorisations and of solves with them", &WorkCount::flops),
          counted("path_flops", "1", "of these one after the other, over all processes", &WorkCount::path_flops),
          {"seconds", "s", "from the first work to the last", &ProcessCounts::seconds},
          {"memory", "B", "largest resident set of the process", &ProcessCounts::memory}};
}

double largest_resident_set() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

}  // namespace

void CountsTable::declare(Command& command, std::string& path) {
  command.add("--counts FILE", path,
              "also a table of what each process did; its messages, bytes, operations, seconds and memory, - for "
              "standard output");
}

CountsTable::CountsTable(const std::string& path, bool force, const Machine& machine)
    : processes_(machine.processes), wanted_(!path.empty()) {
  processes_.together([&] {
    if (wanted_ && processes_.first()) csv_.emplace(path, force, headings(columns()));
    return true;
  });
}

void CountsTable::finish() {
  if (!wanted_) return;
  const ProcessCounts own{processes_.rank, *processes_.counts, seconds() - begun_, largest_resident_set()};
  const std::vector<ProcessCounts> all = processes_.gather_each(own);
  if (!csv_) return;
  for (const ProcessCounts& one : all) csv_->write(row(columns(), one));
  csv_->finish();
}

}  // namespace nscdd::app
