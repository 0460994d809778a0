// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/memory_limit.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <filesystem>
#include <fstream>

namespace nscdd::app {

namespace {

namespace fs = std::filesystem;

constexpr double gibibyte = 1024.0 * 1024.0 * 1024.0;
constexpr double usable_share = 0.9;  // of what is available, because the need is only estimated

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

// What a group, and every group that it lies in, leave of their limits.
double left_in(const fs::path& root, fs::path group, const char* limit_name, const char* usage_name) {
  for (double left = infinity;; group = group.parent_path()) {
    const fs::path folder = root / group;
    const double limit = number_in(folder / limit_name), usage = number_in(folder / usage_name);
    if (limit < infinity && usage < infinity) left = std::min(left, std::max(limit - usage, 0.0));
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
    if (controllers.empty()) left = std::min(left, left_in("/sys/fs/cgroup", group, "memory.max", "memory.current"));
    if (controllers == "memory")
      left = std::min(left, left_in("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes", "memory.usage_in_bytes"));
  }
  return left;
}

// Bytes that a new run can take without swapping: MemAvailable of /proc/meminfo, and what the control groups
// that the program is in leave of their limits; infinite where the system tells neither.
double available_bytes() { return std::min(system_available(), control_groups_available()); }

}  // namespace

void MemoryLimit::declare(Command& command) {
  command.add("--memory-limit", gibibytes,
              "memory the run may take, GiB; a run that is estimated to need more is refused; by default 90 % of what "
              "is available",
              {.description = "", .minimum = 0, .minimum_excluded = true});
}

void MemoryLimit::require(const MemoryNeed& need) const {
  const double limit = gibibytes ? *gibibytes * gibibyte : usable_share * available_bytes();
  if (need.bytes <= limit) return;
  fail(
      "case {}: expected to fit into {:.3g} GiB of memory ({}), met an estimated need of {:.3g} GiB for {}; {}, or a "
      "larger --memory-limit may help",
      need.name, limit / gibibyte, gibibytes ? "--memory-limit" : "90 % of what is available", need.bytes / gibibyte,
      need.what, need.advice);
}

void MemoryLimit::require(MemoryNeed need, const Machine& machine) const {
  need.bytes *= static_cast<double>(machine.processes_here) / static_cast<double>(machine.processes.size);
  require(need);
}

void give_back_freed_memory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace nscdd::app
