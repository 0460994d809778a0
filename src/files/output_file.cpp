// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/output_file.hpp"

#include <nscdd/core/error.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace nscdd {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(std::string_view name, std::string_view action) {
  throw Error(fmt::format("{}: cannot {}: {}", name, action, std::strerror(errno)));
}

}  // namespace

bool is_stream(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return path == "-" || (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status));
}

fs::path followed(fs::path path) {
  constexpr int longest_chain = 40;  // as for the system, which refuses longer ones
  std::error_code status;
  for (int link = 0; link < longest_chain && fs::is_symlink(path, status); ++link) {
    const fs::path target = fs::read_symlink(path, status);
    if (status) break;
    path = target.is_absolute() ? target : path.parent_path() / target;
  }
  return path;
}

fs::path partial_path(const fs::path& path) { return fs::path(path.string() + ".partial"); }

void require_writable(const fs::path& path, bool force, bool partial_accepted) {
  std::error_code ignored;
  if (path.empty()) throw Error("output: expected a file name, met an empty one");
  if (is_stream(path)) return;
  if (fs::is_directory(path, ignored))
    throw Error(fmt::format("{}: expected the name of a file to write, met a folder", path.string()));
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored))
    throw Error(fmt::format("{}: cannot be written: there is no folder {}", path.string(), folder.string()));
  if (force) return;
  if (fs::exists(path, ignored))
    throw Error(fmt::format("{}: exists already; choose another name, or --force to replace it", path.string()));
  if (!partial_accepted && fs::exists(partial_path(path), ignored))
    throw Error(fmt::format("{}: left by an interrupted run; move it away, or --force to replace it",
                            partial_path(path).string()));
}

void require_distinct(const std::string& first, const std::string& second) {
  std::error_code ignored;
  const bool same = first == second || fs::weakly_canonical(fs::absolute(first), ignored) ==
                                           fs::weakly_canonical(fs::absolute(second), ignored);
  if (!same || is_stream(first)) return;
  throw Error(fmt::format("{}: expected another name for each output, met the same twice", first));
}

void require_hdf5_name(const std::string& path) {
  const fs::path extension = fs::path(path).extension();
  if ((extension != ".h5" && extension != ".hdf5") || is_stream(path))
    throw Error(fmt::format("{}: expected the name of a file that ends in .h5 or .hdf5", path));
}

void complete(const fs::path& path) {
  std::error_code status;
  fs::rename(partial_path(path), path, status);
  if (status)
    throw Error(
        fmt::format("{}: cannot be renamed from {}: {}", path.string(), partial_path(path).string(), status.message()));
}

OutputFile::OutputFile(const std::string& path, bool force, std::optional<std::uintmax_t> kept_bytes)
    : name_(path == "-" ? "standard output" : path) {
  if (path == "-") {
    stream_ = stdout;
    return;
  }
  require_writable(path, force, kept_bytes.has_value());
  if (is_stream(path)) {
    stream_ = std::fopen(path.c_str(), "wb");
    if (stream_ == nullptr) refuse(name_, "be opened for writing");
    return;
  }
  growing_ = partial_path(path);
  removable_ = kept_bytes.value_or(0) == 0;
  open_growing(kept_bytes.value_or(0));
}

// The file is locked before it is cut, so that two runs never write into one another's rows.
void OutputFile::open_growing(std::uintmax_t kept_bytes) {
  const int descriptor = ::open(growing_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) refuse(name_, "be opened for writing");
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (!locked && ::ftruncate(descriptor, static_cast<off_t>(kept_bytes)) == 0 && ::lseek(descriptor, 0, SEEK_END) >= 0)
    stream_ = ::fdopen(descriptor, "wb");
  if (stream_ != nullptr) return;
  const int reason = errno;
  ::close(descriptor);
  if (locked) throw Error(fmt::format("{}: is being written by another run", growing_.string()));
  errno = reason;
  refuse(name_, "be opened for writing");
}

OutputFile::~OutputFile() {
  if (stream_ == nullptr) return;
  if (!removable_) std::fwrite(gathered_.data(), 1, gathered_.size(), stream_);
  if (stream_ != stdout) std::fclose(stream_);
  std::error_code ignored;
  if (!growing_.empty() && removable_) fs::remove(growing_, ignored);
}

void OutputFile::line(std::string_view text) {
  constexpr std::chrono::milliseconds longest_wait{100};
  constexpr std::size_t most = 1 << 16;
  gathered_.append(text).push_back('\n');
  if (gathered_.size() >= most || std::chrono::steady_clock::now() - flushed_ >= longest_wait) flush();
}

void OutputFile::flush() {
  const std::string lines = std::exchange(gathered_, {});
  bytes(lines);
  flushed_ = std::chrono::steady_clock::now();
}

void OutputFile::bytes(std::string_view text) {
  if (!gathered_.empty()) flush();
  std::fwrite(text.data(), 1, text.size(), stream_);
  if (std::fflush(stream_) != 0 || std::ferror(stream_) != 0) refuse(name_, "be written");
}

void OutputFile::close() {
  if (stream_ == nullptr) return;
  flush();
  if (stream_ != stdout && std::fclose(std::exchange(stream_, nullptr)) != 0) refuse(name_, "be written");
}

void OutputFile::finish() {
  try {
    close();
  } catch (const Error&) {
    std::error_code ignored;
    if (!growing_.empty() && removable_) fs::remove(growing_, ignored);
    throw;
  }
  if (!growing_.empty()) complete(name_);
}

void OutputFile::leave() { close(); }

void write_file(const std::string& path, std::string_view bytes, bool force) {
  OutputFile file(path, force);
  file.bytes(bytes);
  file.finish();
}

}  // namespace nscdd
