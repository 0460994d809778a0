// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "../support/moving_case.hpp"
#include "../support/run_program.hpp"
#include "../support/spoilt.hpp"

#include <doctest/doctest.h>

#include <initializer_list>

namespace nscdd::testing {

using Texts = std::vector<std::string>;

/// The program in a fresh folder, with the files a test puts there: the fixture of these tests. `nscdd ...` is written
/// as one line, whose words are separated by blanks, or word by word.
struct Session {
  TemporaryFolder folder;

  void file(const std::string& name, const std::string& content) const { write_file(folder / name, content); }
  bool has(const std::string& name) const { return std::filesystem::exists(folder / name); }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string read(const std::string& name) const { return read_file(folder / name); }
  CsvTable csv(const std::string& name) const { return read_table(read(name)); }

  Outcome run(const Texts& arguments, const RunOptions& options = {}) const {
    return run_program(folder.path(), arguments, options);
  }
  Outcome run(const std::string& line, const RunOptions& options = {}) const;

  /// A run with this exit code and all of `said` on standard error. Fails the test otherwise.
  Outcome ended(int exit_code, const std::string& line, std::initializer_list<std::string> said = {},
                const RunOptions& options = {}) const;

  /// Output of a run that must do its job: exit code 0 and nothing on standard error. Fails the test otherwise.
  std::string answer(const Texts& arguments) const;
  std::string answer(const std::string& line) const;

  /// Output of a run that must do its job and make one remark on standard error, which has `part`.
  std::string remarked(const std::string& line, const std::string& part) const;

  /// The table of a run with `--csv -`.
  CsvTable table(const std::string& line) const { return read_table(answer(line + " --csv -")); }

  /// A run that must be refused: exit code 2, a line "nscdd: error: ..." on standard error with all of `parts`,
  /// nothing on standard output, and every file as it was before. Fails the test otherwise.
  void check_refused(const Texts& arguments, std::initializer_list<std::string> parts,
                     const RunOptions& options = {}) const;
  void check_refused(const std::string& line, std::initializer_list<std::string> parts,
                     const RunOptions& options = {}) const;
};

/// With a case that moves.
struct MovingSession : Session {
  MovingSession() { file("shear.toml", moving_case()); }
};

std::vector<std::string> words(const std::string& line);

bool contains(const std::string& text, const std::string& part);

/// Exit code of a script of tests/ that Python runs with these arguments; `output`: where what it prints goes.
int run_script(const std::string& script, const Texts& arguments, const std::string& output = "");

/// How often a text holds another one.
std::size_t times(const std::string& text, const std::string& part);

/// The first word behind the name of a line of a report, such as that of `nscdd inspect`; empty without such a line.
std::string value(const std::string& report, const std::string& name);

/// Three touching disks in a row and one that touches nothing, as a packing file.
std::string row_of_three();

}  // namespace nscdd::testing
