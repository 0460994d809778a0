// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/alternating_file.hpp"

#include "files/output_file.hpp"
#include <nscdd/core/error.hpp>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>

namespace nscdd {
namespace {

namespace fs = std::filesystem;

void remove(const std::string& path) {
  std::error_code ignored;
  fs::remove(path, ignored);
}

[[noreturn]] void refuse(const std::string& path, const std::string& action, const std::string& reason) {
  throw Error(fmt::format("{}: cannot {}: {}", path, action, reason));
}

// Somebody who opened the file when it had its name may still be reading it.
bool is_read(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool read = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return read;
}

// The content of a lock of this program. A file with other content is somebody else's.
constexpr std::string_view mark = "lock of a trajectory that nscdd writes\n";

[[noreturn]] void refuse_foreign(const std::string& path, const std::string& name) {
  throw Error(
      fmt::format("{}: expected no such file, or one that a run of nscdd into {} left, met another; "
                  "move it away",
                  name, path));
}

std::string content_of(int descriptor) {
  std::string text(mark.size() + 1, '\0');
  const ssize_t length = ::pread(descriptor, text.data(), text.size(), 0);
  return text.substr(0, static_cast<std::size_t>(std::max<ssize_t>(length, 0)));
}

}  // namespace

std::vector<std::string> AlternatingFile::names_beside(const std::string& path) {
  const std::string file = followed(path).string();
  return {file + ".next", file + ".previous", file + ".lock"};
}

AlternatingFile::AlternatingFile(const std::string& path) : path_(followed(path).string()) {
  const std::vector<std::string> names = names_beside(path);
  spare_ = names[0];
  previous_ = names[1];
  lock_ = names[2];
  lock_descriptor_ = ::open(lock_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_descriptor_ < 0) refuse(path_, "be opened for writing", std::strerror(errno));
  try {
    take_lock();
  } catch (...) {
    ::close(lock_descriptor_);
    throw;
  }
}

// A killed run leaves its lock. The other names are made after the lock and removed before it, so they belong
// to a run only if a lock is beside them. An empty lock was cut off before it was marked, or is of no worth.
void AlternatingFile::take_lock() const {
  if (::flock(lock_descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw Error(fmt::format("{}: is being written by another run", path_));
  const std::string content = content_of(lock_descriptor_);
  if (!content.empty() && content != mark) refuse_foreign(path_, lock_);
  for (const std::string& name : {spare_, previous_}) {
    std::error_code ignored;
    if (content == mark)
      remove(name);
    else if (fs::exists(fs::symlink_status(name, ignored))) {
      remove(lock_);
      refuse_foreign(path_, name);
    }
  }
  if (content.empty() && ::pwrite(lock_descriptor_, mark.data(), mark.size(), 0) != std::ssize(mark))
    refuse(lock_, "be written", std::strerror(errno));
}

AlternatingFile::~AlternatingFile() {
  remove(spare_);
  remove(previous_);
  remove(lock_);  // before it is unlocked, so that nobody locks a file without a name
  ::close(lock_descriptor_);
}

void AlternatingFile::create(const Change& make) {
  make(spare_);
  std::error_code status;
  fs::rename(spare_, path_, status);
  if (status) refuse(path_, "be renamed from " + spare_, status.message());
}

void AlternatingFile::change(Change change) {
  const Change missing = std::exchange(missing_, {});  // a change that fails leaves a spare of no worth
  if (!missing || copying_is_faster() || is_read(spare_)) {
    remove(spare_);
    copy_to_spare();
  } else {
    missing(spare_);
  }
  const auto started = std::chrono::steady_clock::now();
  change(spare_);
  missing_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  swap();
  missing_ = std::move(change);
}

// Many small changes take longer than copying a small file.
bool AlternatingFile::copying_is_faster() const {
  constexpr double bytes_per_second = 3e8;  // of a slow disk
  std::error_code ignored;
  return !fs::exists(spare_, ignored) ||
         static_cast<double>(fs::file_size(path_, ignored)) < missing_seconds_ * bytes_per_second;
}

void AlternatingFile::copy_to_spare() const {
  std::error_code status;
  fs::copy_file(path_, spare_, fs::copy_options::overwrite_existing, status);
  if (status) refuse(spare_, "be copied from " + path_, status.message());
}

// One rename puts the new version in place. The old version becomes the spare copy if the file system has
// hard links and nobody else has one to it. Otherwise the next change begins with a copy.
void AlternatingFile::swap() {
  std::error_code status, linked;
  remove(previous_);
  fs::create_hard_link(path_, previous_, linked);
  fs::rename(spare_, path_, status);
  if (status) refuse(path_, "be renamed from " + spare_, status.message());
  if (!linked && fs::hard_link_count(previous_, status) == 1) fs::rename(previous_, spare_, status);
}

}  // namespace nscdd
