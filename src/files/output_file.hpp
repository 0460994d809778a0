// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd {

/// Throws Error if the folder of `path` does not exist, or if `path` does and `force` is false. The same holds for the
/// `path.partial` of an interrupted run unless `partial_accepted`. Devices and pipes hold nothing and are accepted.
void require_writable(const std::filesystem::path& path, bool force, bool partial_accepted = false);

/// Throws Error if two outputs would be one file, unless that is a device or a pipe.
void require_distinct(const std::string& first, const std::string& second);

/// Throws Error unless the name ends in .h5 or .hdf5. Readers tell an HDF5 file by these endings.
void require_hdf5_name(const std::string& path);

/// The name under which an output grows until it is complete.
std::filesystem::path partial_path(const std::filesystem::path& path);

/// Whether `path` is a device or a pipe, which holds nothing; "-" (standard output) counts as one.
bool is_stream(const std::filesystem::path& path);

/// An output that appears under its name only when it is complete: it grows as `path.partial`, and `finish` renames it.
/// A killed run leaves the partial file, which can be read. A run that ends by an exception removes it, unless it holds
/// bytes of an earlier run. "-" is standard output; devices and pipes are written to directly. Every function throws
/// Error if the system refuses (no room left, no permission) or another run is writing the same partial file.
class OutputFile {
 public:
  /// With `kept_bytes`, the partial file of an earlier run, if any, is continued behind so many bytes, not refused.
  OutputFile(const std::string& path, bool force, std::optional<std::uintmax_t> kept_bytes = std::nullopt);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Writes text and a line feed. Lines that follow one another quickly are gathered for a tenth of a second
  /// and then written whole. So a killed run loses no line that took longer.
  void line(std::string_view text);
  void bytes(std::string_view text);  ///< writes text as it is, at once
  void flush();                       ///< writes the lines gathered
  void finish();
  void leave();  ///< closes the partial file and keeps it, to be continued by another run

 private:
  void close();
  std::string name_;
  std::filesystem::path growing_;  ///< empty for a stream that is not a file of its own
  bool removable_ = true;          ///< the partial file holds only what this run wrote
  std::FILE* stream_ = nullptr;
  std::string gathered_;                             ///< lines that are not written yet
  std::chrono::steady_clock::time_point flushed_{};  ///< when lines were written last
};

/// Writes a whole file in one piece: in the end it has these bytes, or it is as it was before.
void write_file(const std::string& path, std::string_view bytes, bool force);

/// A file that is changed again and again, and yet is complete under its name at every moment, however the
/// program ends. There are two copies: `path`, which is never touched while it has that name, and the spare
/// copy `path.next`. A change takes three steps. 1. The spare copy gets the change that the other one has
/// already, or the bytes of the other one if copying is faster. 2. It gets the new change. 3. It takes the
/// name by a rename. So a reader of `path` always meets a finished version and does not disturb the writer.
/// `path.lock` keeps a second writer away. If `path` is a symbolic link, it stays one, and all this holds for
/// the file it leads to. Every function throws Error naming the file if the system refuses.
class AlternatingFile {
 public:
  /// Changes the file of the given name; must leave it closed.
  using Change = std::function<void(const std::string& path)>;

  /// The names beside `path`: of the spare copy, of the version before, of the lock.
  static std::vector<std::string> names_beside(const std::string& path);

  /// Takes the lock and removes what a killed run left. Throws Error naming any other file that has such a name.
  explicit AlternatingFile(const std::string& path);
  ~AlternatingFile();  ///< `path` keeps its last complete change
  AlternatingFile(const AlternatingFile&) = delete;
  AlternatingFile& operator=(const AlternatingFile&) = delete;

  void create(const Change& make);  ///< replaces what there is
  void change(Change change);

 private:
  bool copying_is_faster() const;
  void swap();
  std::string path_, spare_, previous_, lock_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> lock_stream_;
  Change missing_;              ///< the change that the spare does not have yet, if there is one
  double missing_seconds_ = 0;  ///< how long that change took
};

}  // namespace nscdd
