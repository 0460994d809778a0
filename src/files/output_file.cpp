// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/output_file.hpp"

#include "core/fail.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <set>
#include <system_error>

namespace nscdd {
namespace {

[[noreturn]] void refuse(std::string_view name, std::string_view action, std::string_view reason) {
  fail("{}: cannot {}: {}", name, action, reason);
}

// Error for the last system call that failed.
[[noreturn]] void refuse(std::string_view name, std::string_view action) { refuse(name, action, std::strerror(errno)); }

void remove_file(const fs::path& path) {
  std::error_code ignored;
  fs::remove(path, ignored);
}

void rename_file(const fs::path& from, const fs::path& to) {
  std::error_code status;
  fs::rename(from, to, status);
  if (status) refuse(to.string(), "be renamed from " + from.string(), status.message());
}

// Whether another run has locked the file. If not, locks it if the system supports locks.
bool is_locked(int descriptor) { return ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; }

[[noreturn]] void refuse_locked(const std::string& path) { fail("{}: is being written by another run", path); }

// Locks before truncating, so that two runs never mix their rows. Null if the system refuses.
std::FILE* open_growing(const fs::path& path, std::uintmax_t kept_bytes) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) return nullptr;
  const bool locked = is_locked(descriptor);
  if (!locked && ::ftruncate(descriptor, static_cast<off_t>(kept_bytes)) == 0 && ::lseek(descriptor, 0, SEEK_END) >= 0)
    if (std::FILE* stream = ::fdopen(descriptor, "wb")) return stream;
  const int reason = errno;
  ::close(descriptor);
  if (locked) refuse_locked(path.string());
  errno = reason;
  return nullptr;
}

// The final target of symbolic links under `path`, whether it exists or not.
fs::path followed(fs::path path) {
  constexpr int longest_chain = 40;  // the system refuses longer ones
  std::error_code status;
  for (int link = 0; link < longest_chain && fs::is_symlink(path, status); ++link) {
    const fs::path target = fs::read_symlink(path, status);
    if (status) break;
    path = target.is_absolute() ? target : path.parent_path() / target;
  }
  return path;
}

// Whether a reader that opened the file under its old name is still reading it.
bool is_read(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool read = is_locked(descriptor);
  ::close(descriptor);
  return read;
}

[[noreturn]] void refuse_foreign(const std::string& path, const std::string& name) {
  fail("{}: expected no such file, or one that a run of nscdd into {} left, met another; move it away", name, path);
}

}  // namespace

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool is_stream(const fs::path& path) {
  std::error_code ignored;
  return path == "-" || fs::is_other(path, ignored);
}

fs::path partial_path(const fs::path& path) { return fs::path(path.string() + ".partial"); }

void require_writable(const fs::path& path, bool force, bool partial_accepted) {
  std::error_code ignored;
  if (path.empty()) throw Error("output: expected a file name, met an empty one");
  if (is_stream(path)) return;
  if (fs::is_directory(path, ignored)) fail("{}: expected the name of a file to write, met a folder", path.string());
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored))
    fail("{}: cannot be written: there is no folder {}", path.string(), folder.string());
  if (force) return;
  if (fs::exists(fs::symlink_status(path, ignored)))  // a link, too, whatever it leads to
    fail("{}: exists already; choose another name, or --force to replace it", path.string());
  if (!partial_accepted && fs::exists(partial_path(path), ignored))
    fail("{}: left by an interrupted run; move it away, or --force to replace it", partial_path(path).string());
}

void require_distinct(const std::vector<std::string>& names) {
  std::error_code ignored;
  std::set<fs::path> met;
  for (const std::string& name : names) {
    if (name.empty() || (is_stream(name) && name != "-")) continue;
    const fs::path path = name == "-" ? fs::path(name) : fs::weakly_canonical(fs::absolute(name), ignored);
    if (!met.insert(path).second) fail("{}: expected another name for each output, met the same twice", name);
  }
}

void require_ending(const std::string& path, const std::array<std::string_view, 2>& endings) {
  const fs::path extension = fs::path(path).extension();
  if ((extension != endings[0] && extension != endings[1]) || is_stream(path))
    fail("{}: expected the name of a file that ends in {} or {}", path, endings[0], endings[1]);
}

bool make_folder(const std::string& path, bool force) {
  std::error_code status;
  if (fs::exists(path, status)) {
    if (!fs::is_directory(path, status)) fail("{}: expected a folder, met a file", path);
    if (!force && !fs::is_empty(path, status))
      fail("{}: expected an empty folder or none, met one that holds files; --force writes into it", path);
    return false;
  }
  fs::create_directories(path, status);
  if (status) fail("{}: cannot be made: {}", path, status.message());
  return true;
}

OutputFile::OutputFile(const std::string& path, bool force, std::optional<std::uintmax_t> kept_bytes)
    : name_(path == "-" ? "standard output" : path), replaces_(force) {
  if (path == "-") {
    stream_ = stdout;
    return;
  }
  require_writable(path, force, kept_bytes.has_value());
  if (is_stream(path)) {
    stream_ = std::fopen(path.c_str(), "wb");
  } else {
    removable_ = kept_bytes.value_or(0) == 0;
    stream_ = open_growing(partial_path(path), kept_bytes.value_or(0));
    if (stream_ != nullptr) growing_ = partial_path(path);
  }
  if (stream_ == nullptr) refuse(name_, "be opened for writing");
}

OutputFile::~OutputFile() {
  if (stream_ != nullptr && !removable_) std::fwrite(gathered_.data(), 1, gathered_.size(), stream_);
  if (stream_ != nullptr && stream_ != stdout) std::fclose(stream_);
  if (!growing_.empty() && removable_) remove_file(growing_);
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
  close();
  if (growing_.empty()) return;
  const fs::path grown = std::exchange(growing_, {});
  std::error_code status;
  if (!replaces_)
    fs::create_hard_link(grown, name_, status);  // fails where the name is taken, which a renaming does not
  if (status == std::errc::file_exists)
    fail("{}: expected no such file, met one that appeared during the run; the result is in {}", name_, grown.string());
  if (replaces_ || status)  // not every file system has hard links
    rename_file(grown, name_);
  else
    remove_file(grown);
}

void OutputFile::leave() {
  close();
  growing_.clear();
}

void write_file(const std::string& path, std::string_view bytes, bool force) {
  OutputFile file(path, force);
  file.bytes(bytes);
  file.finish();
}

std::vector<std::string> AlternatingFile::names_beside(const std::string& path) {
  const std::string file = followed(path).string();
  return {file + ".next", file + ".previous", file + ".lock"};
}

// The other files are created after the lock and removed before it, so they belong to a killed run only if its lock
// exists. A lock is empty if its run was killed before marking it.
AlternatingFile::AlternatingFile(const std::string& path)
    : path_(followed(path).string()),
      spare_(path_ + ".next"),
      previous_(path_ + ".previous"),
      lock_(path_ + ".lock"),
      lock_stream_(std::fopen(lock_.c_str(), "a+e"), &std::fclose) {
  constexpr std::string_view mark = "lock of a trajectory that nscdd writes\n";
  std::FILE* stream = lock_stream_.get();
  if (stream == nullptr) refuse(path_, "be opened for writing");
  if (is_locked(::fileno(stream))) refuse_locked(path_);
  std::string content(mark.size() + 1, '\0');
  content.resize(std::fread(content.data(), 1, content.size(), stream));
  if (!content.empty() && content != mark) refuse_foreign(path_, lock_);
  for (const std::string& name : {spare_, previous_}) {
    std::error_code ignored;
    if (content.empty() && fs::exists(fs::symlink_status(name, ignored))) {
      remove_file(lock_);
      refuse_foreign(path_, name);
    }
    remove_file(name);
  }
  if (content.empty() && (std::fputs(mark.data(), stream) < 0 || std::fflush(stream) != 0)) refuse(lock_, "be written");
}

AlternatingFile::~AlternatingFile() {
  remove_file(spare_);
  remove_file(previous_);
  remove_file(lock_);  // before unlocking, so that nobody locks a nameless file
}

void AlternatingFile::create(const Change& make) {
  make(spare_);
  rename_file(spare_, path_);
}

void AlternatingFile::change(Change change) {
  const Change missing = std::exchange(missing_, {});  // if `change` fails, the next one must copy the file
  if (!missing || copying_is_faster() || is_read(spare_)) {
    remove_file(spare_);
    std::error_code status;
    fs::copy_file(path_, spare_, fs::copy_options::overwrite_existing, status);
    if (status) refuse(spare_, "be copied from " + path_, status.message());
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
  return !is_there(spare_) || static_cast<double>(fs::file_size(path_, ignored)) < missing_seconds_ * bytes_per_second;
}

// One rename installs the new version. The old one becomes the spare copy if it has no other hard link (and the file
// system has hard links). Otherwise the next change begins with a copy.
void AlternatingFile::swap() {
  std::error_code status, linked;
  remove_file(previous_);
  fs::create_hard_link(path_, previous_, linked);
  rename_file(spare_, path_);
  if (!linked && fs::hard_link_count(previous_, status) == 1) fs::rename(previous_, spare_, status);
}

}  // namespace nscdd
