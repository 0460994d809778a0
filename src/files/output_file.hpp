// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace nscdd {

/// Throws Error if `path` (or the `path.partial` of an interrupted run) exists and `force` is false, or if
/// its folder does not exist. Devices and pipes hold nothing and are always accepted. With `partial_accepted`
/// the caller goes on with the partial file.
void require_writable(const std::filesystem::path& path, bool force, bool partial_accepted = false);

/// Throws Error if two outputs would be one file, unless that is a device or a pipe.
void require_distinct(const std::string& first, const std::string& second);

/// Throws Error unless the name ends in .h5 or .hdf5. Readers tell an HDF5 file by these endings.
void require_hdf5_name(const std::string& path);

/// The name under which an output grows until it is complete.
std::filesystem::path partial_path(const std::filesystem::path& path);

/// Renames `path.partial` to `path`. Throws Error if that fails.
void complete(const std::filesystem::path& path);

/// Whether `path` is a device or a pipe, which holds nothing; "-" (standard output) counts as one.
bool is_stream(const std::filesystem::path& path);

/// The name that symbolic links under `path` lead to in the end, whether that file exists or not.
std::filesystem::path followed(std::filesystem::path path);

/// An output that appears under its name only when it is complete: it grows as `path.partial`, and `finish`
/// renames it. A killed run leaves the partial file, which can be read. A run that ends by an exception
/// removes it, unless it holds bytes of an earlier run. "-" is standard output; devices and pipes are written
/// to directly. Every function throws Error if the system refuses (no room left, no permission) or another
/// run is writing the same partial file.
class OutputFile {
 public:
  /// With `kept_bytes`, the partial file of an earlier run is continued behind that many bytes instead of
  /// being refused; 0 if there is none yet.
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
  void open_growing(std::uintmax_t kept_bytes);
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

}  // namespace nscdd
