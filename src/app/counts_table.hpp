// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "files/csv.hpp"

namespace nscdd::app {

/// A table with a row for each process: what it has done, see WorkCount, and what it took. The first one writes it.
class CountsTable {
 public:
  static void declare(Command& command, std::string& path);

  /// Nothing is written where `path` is empty. Throws Error in all processes if the first cannot open it.
  CountsTable(const std::string& path, bool force, const Machine& machine);
  /// All processes together.
  void finish();

 private:
  Processes processes_;
  bool wanted_;
  double begun_ = seconds();
  std::optional<CsvWriter> csv_;  // the first process has it
};

}  // namespace nscdd::app
