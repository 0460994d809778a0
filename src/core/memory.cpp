// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/memory.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace nscdd {
namespace {

namespace fs = std::filesystem;

constexpr double usable_share = 0.9;  // of what is available: other programs need some, too

double system_available() {
  std::ifstream stream("/proc/meminfo");
  std::string key, unit;
  for (double kibibytes = 0; stream >> key >> kibibytes; std::getline(stream, unit))
    if (key == "MemAvailable:") return 1024 * kibibytes;
  return infinity;
}

// The number in a file of a control group; infinite if the file is missing or says "max".
double number_in(const fs::path& file) {
  std::ifstream stream(file);
  double value = 0;
  return stream >> value ? value : infinity;
}

// The files of a control group. Its usage includes cached pages of files, which the system reclaims if memory is short.
struct GroupFiles {
  const char* limit;
  const char* usage;
  std::array<std::string_view, 2> pages_of_files;  // keys of memory.stat
};
constexpr GroupFiles version_1{
    "memory.limit_in_bytes", "memory.usage_in_bytes", {"total_inactive_file", "total_active_file"}};
constexpr GroupFiles version_2{"memory.max", "memory.current", {"inactive_file", "active_file"}};

double pages_of_files(const fs::path& folder, const GroupFiles& files) {
  std::ifstream stream(folder / "memory.stat");
  std::string key;
  double sum = 0;
  for (double bytes = 0; stream >> key >> bytes;)
    if (std::ranges::find(files.pages_of_files, key) != files.pages_of_files.end()) sum += bytes;
  return sum;
}

// Bytes left below the limits of a group and of every group that contains it.
double left_in(const fs::path& root, fs::path group, const GroupFiles& files) {
  for (double left = infinity;; group = group.parent_path()) {
    const fs::path folder = root / group;
    const double limit = number_in(folder / files.limit), usage = number_in(folder / files.usage);
    if (limit < infinity && usage < infinity)
      left = std::min(left, std::max(limit - usage + pages_of_files(folder, files), 0.0));
    if (group.empty()) return left;
  }
}

double control_groups_available() {
  std::ifstream stream("/proc/self/cgroup");  // lines "number:controllers:/path", "0::/path" for version 2
  double left = infinity;
  for (std::string line; std::getline(stream, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const fs::path group = fs::path(line.substr(second + 1)).relative_path();
    if (controllers.empty()) left = std::min(left, left_in("/sys/fs/cgroup", group, version_2));
    if (controllers == "memory") left = std::min(left, left_in("/sys/fs/cgroup/memory", group, version_1));
  }
  return left;
}

// Bytes of this process in physical memory.
struct Resident {
  double all = 0, of_files = 0;
};

Resident resident() {
  std::ifstream stream("/proc/self/statm");
  const auto page = static_cast<double>(sysconf(_SC_PAGESIZE));
  double size = 0, all = 0, of_files = 0;
  stream >> size >> all >> of_files;
  return {page * all, page * of_files};
}

rlimit own_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_RSS, &limit) != 0) limit.rlim_cur = limit.rlim_max = RLIM_INFINITY;
  return limit;
}

// Bytes that this process may hold: its limit, or 90 % of what it holds and is left to it; infinite if unknown.
double memory_limit() {
  if (const rlimit own = own_limit(); own.rlim_cur != RLIM_INFINITY) return static_cast<double>(own.rlim_cur);
  return usable_share * (resident().all + std::min(system_available(), control_groups_available()));
}

}  // namespace

void limit_memory(double bytes) {
  rlimit limit = own_limit();
  limit.rlim_cur = bytes < static_cast<double>(limit.rlim_max) ? static_cast<rlim_t>(std::ceil(bytes)) : limit.rlim_max;
  if (setrlimit(RLIMIT_RSS, &limit) != 0)
    throw Error("memory: expected a limit that the system accepts, met one that it refuses");
}

// The heap keeps freed memory: it is resident, but available.
double memory_in_use() {
#ifdef __GLIBC__
  const auto heap = mallinfo2();
  return static_cast<double>(heap.uordblks + heap.hblkhd) + resident().of_files;
#else
  return resident().all;
#endif
}

void require_memory(double bytes, std::string_view what, std::string_view advice) {
  if (bytes < smallest_checked_need) return;
  const double limit = memory_limit(), in_use = memory_in_use();
  if (in_use + bytes <= limit) return;
  throw OutOfMemory(fmt::format(
      "expected to fit into {:.3g} GiB of memory ({}), met {:.3g} GiB in use and {:.3g} GiB for {}; {}, or a larger "
      "limit (--memory-limit, if the command has it, or ulimit -m) may help",
      limit / gibibyte,
      own_limit().rlim_cur != RLIM_INFINITY ? "the limit of this process" : "90 % of what is available",
      in_use / gibibyte, bytes / gibibyte, what, advice));
}

}  // namespace nscdd
