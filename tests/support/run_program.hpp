// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <csignal>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

/// Runs the program from outside, as a user does, in folders of its own.
namespace nscdd::testing {

namespace fs = std::filesystem;

/// A fresh empty folder, removed with everything in it at the end of its life.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }
  fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Bytes of a file; throws std::runtime_error where it cannot be read.
std::string read_file(const std::filesystem::path& path);

/// Writes a file, and the folders it lies in where they are missing.
void write_file(const std::filesystem::path& path, const std::string& content);

/// Every file below a folder by its relative name, with its bytes; folders end in '/', and what is neither a
/// file nor a folder (a pipe, a link to a device) is named without being opened.
std::map<std::string, std::string> content_of(const std::filesystem::path& folder);

/// A signal sent once `bytes` have been written to files whose names match a pattern of the shell. After SIGSTOP
/// `while_stopped` is called, and the program is killed.
struct SignalAt {
  std::string files;
  std::size_t bytes = 1;
  int signal = SIGKILL;
  std::function<void()> while_stopped = {};
};

/// How to run the program; as a user would unless told otherwise.
struct RunOptions {
  /// Where standard output or standard error goes instead of being captured, such as a link to /dev/full.
  std::filesystem::path standard_output = {}, standard_error = {};
  /// Standard error is a terminal, captured still.
  bool on_terminal = false;
  /// Bytes that a file may grow to, writing more being an error: a disk that fills up.
  std::optional<std::size_t> largest_file = {};
  /// Permissions hold, even for the superuser.
  bool obey_permissions = false;
  /// A signal that the program is sent as it writes, at the same place on every machine.
  std::optional<SignalAt> signal_at = {};
};

/// What a run came to.
struct Outcome {
  int exit_code = 0;  ///< 128 + signal where a signal ended it, as a shell says it
  std::string standard_output, standard_error;
  std::size_t peak_memory = 0;  ///< bytes resident at most
};

/// Runs $NSCDD_PROGRAM with these arguments in a folder and waits for it. A run that takes longer than four
/// minutes is killed. Throws std::runtime_error where it cannot be started at all.
Outcome run_program(const std::filesystem::path& folder, const std::vector<std::string>& arguments,
                    const RunOptions& options = {});

/// The source tree, $NSCDD_SOURCE.
std::filesystem::path source_folder();

/// A table as the program prints it (no quoted values).
struct CsvTable {
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;

  /// Value of a named column; throws std::runtime_error where there is no such row or column.
  const std::string& text(std::size_t row, const std::string& column) const;
  double number(std::size_t row, const std::string& column) const;
};
CsvTable read_table(const std::string& csv);

}  // namespace nscdd::testing
