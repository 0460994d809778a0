// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "../support/moving_case.hpp"
#include "../support/run_program.hpp"
#include "../support/spoilt.hpp"

#include <initializer_list>
#include <string>
#include <vector>

namespace nscdd::testing {

/// The program in a fresh folder, with the files a test puts there.
struct Session {
  TemporaryFolder folder;

  void file(const std::string& name, const std::string& content) const { write_file(folder / name, content); }
  bool has(const std::string& name) const { return std::filesystem::exists(folder / name); }
  std::string path(const std::string& name) const { return (folder / name).string(); }
  std::string read(const std::string& name) const { return read_file(folder / name); }
  Outcome run(const std::vector<std::string>& arguments, const RunOptions& options = {}) const {
    return run_program(folder.path(), arguments, options);
  }
};

using Texts = std::vector<std::string>;

/// `nscdd ...` written as one line; words are separated by blanks.
std::vector<std::string> words(const std::string& line);

bool contains(const std::string& text, const std::string& part);

/// Output of a run that must do its job: exit code 0 and nothing on standard error. Fails the test otherwise.
std::string answer(const Session& session, const std::vector<std::string>& arguments);
std::string answer(const Session& session, const std::string& line);

/// How often a text holds another one.
std::size_t times(const std::string& text, const std::string& part);

/// Output of a run that must do its job and make one remark on standard error, which has `part`.
std::string remarked(const Session& session, const std::string& line, const std::string& part);

/// The table of a run with `--csv -`.
CsvTable table(const Session& session, const std::string& line);

/// The first word behind the name of a line of a report, such as that of `nscdd inspect`; empty if there is no such
/// line.
std::string value(const std::string& report, const std::string& name);

/// A run that must be refused: exit code 2, a line "nscdd: error: ..." on standard error with all of `parts`,
/// nothing on standard output, and every file as it was before. Fails the test otherwise.
void check_refused(const Session& session, const std::vector<std::string>& arguments,
                   std::initializer_list<std::string> parts, const RunOptions& options = {});
void check_refused(const Session& session, const std::string& line, std::initializer_list<std::string> parts,
                   const RunOptions& options = {});

/// Three touching disks in a row and one that touches nothing, as a packing file.
std::string row_of_three();

}  // namespace nscdd::testing
