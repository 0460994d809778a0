// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <chrono>
#include <cstdio>
#include <filesystem>

namespace nscdd {

namespace fs = std::filesystem;

/// Whether a path exists, and whether it is a regular file; false if the system cannot tell.
bool is_there(const fs::path& path);
bool is_file(const fs::path& path);

/// Throws Error if the folder of `path` does not exist, or if `path` exists and `force` is false; likewise for the
/// `path.partial` of an interrupted run unless `partial_accepted`. Devices and pipes are accepted.
void require_writable(const fs::path& path, bool force, bool partial_accepted = false);

/// Throws Error if two outputs are the same file, unless it is a device or a pipe. Those without a name are not made.
void require_distinct(const std::vector<std::string>& names);

/// Throws Error for a device or a pipe, and unless the name has one of these endings, which tell readers the format.
void require_ending(const std::string& path, const std::array<std::string_view, 2>& endings);
inline constexpr std::array<std::string_view, 2> hdf5_endings{".h5", ".hdf5"};

/// Creates a folder with its parents; returns whether it is new. Throws Error if `path` is a file, if it is a folder
/// with files (unless `force`), and if the system fails.
bool make_folder(const std::string& path, bool force);

/// Name of an output until it is complete.
fs::path partial_path(const fs::path& path);

/// Whether `path` is a device, a pipe or "-" (standard output).
bool is_stream(const fs::path& path);

/// Atomic output file: it grows as `path.partial`, and `finish` renames it to `path`. A killed run leaves the partial
/// file, which is readable. An exception removes it, unless it holds bytes of an earlier run. "-" is standard output;
/// devices and pipes are written to directly. Throws Error if the system fails or another run writes the same file.
class OutputFile {
 public:
  /// With `kept_bytes`, continues the partial file of an earlier run, if any, after so many bytes.
  OutputFile(const std::string& path, bool force, std::optional<std::uintmax_t> kept_bytes = std::nullopt);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;
  /// Writes text and a line feed. Lines are buffered for at most a tenth of a second and written whole.
  void line(std::string_view text);
  void bytes(std::string_view text);  ///< writes text unchanged, at once
  void flush();                       ///< writes the buffered lines
  void close();                       ///< so that many outputs may wait for `finish`
  void finish();  ///< throws Error, and keeps the partial file, if another file got the name meanwhile, without `force`
  void leave();   ///< closes the partial file and keeps it for another run

 private:
  std::string name_;
  fs::path growing_;       ///< empty for a stream
  bool replaces_ = false;  ///< `force`
  bool removable_ = true;  ///< the partial file holds only what this run wrote
  std::FILE* stream_ = nullptr;
  std::string gathered_;                             ///< buffered lines
  std::chrono::steady_clock::time_point flushed_{};  ///< time of the last write
};

/// Writes a whole file atomically: it has these bytes, or is unchanged.
void write_file(const std::string& path, std::string_view bytes, bool force);

/// A file that changes repeatedly and is complete under its name at every moment, however the program ends. There are
/// two copies: `path`, which is never modified under that name, and the spare copy `path.next`. A change brings the
/// spare copy up to date (by the previous change, or a copy of `path` if that is faster), then applies the new change
/// to it, then renames it to `path`. So readers of `path` always find a complete version and do not disturb the writer.
/// `path.lock` excludes a second writer. All this holds for the target of a symbolic link. Errors name the file.
class AlternatingFile {
 public:
  /// Changes the file of the given name; must close it.
  using Change = std::function<void(const std::string& path)>;

  /// Names of the spare copy, the previous version, and the lock of `path`.
  static std::vector<std::string> names_beside(const std::string& path);

  /// Takes the lock and removes the files of a killed run. Throws Error for any other file with such a name.
  explicit AlternatingFile(const std::string& path);
  ~AlternatingFile();  ///< `path` keeps its last complete change
  AlternatingFile(const AlternatingFile&) = delete;
  AlternatingFile& operator=(const AlternatingFile&) = delete;

  void create(const Change& make);  ///< replaces the file
  void change(Change change);

 private:
  bool copying_is_faster() const;
  void swap();
  std::string path_, spare_, previous_, lock_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> lock_stream_;
  Change missing_;              ///< the change that the spare copy lacks, if any
  double missing_seconds_ = 0;  ///< duration of that change
};

}  // namespace nscdd
