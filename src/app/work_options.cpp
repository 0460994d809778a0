// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/work_options.hpp"

#include "app/progress.hpp"
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

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
  double left = infinity;
  while (true) {
    const fs::path folder = root / group;
    const double limit = number_in(folder / limit_name), usage = number_in(folder / usage_name);
    if (limit < infinity && usage < infinity) left = std::min(left, std::max(limit - usage, 0.0));
    if (group.empty()) return left;
    group = group.parent_path();
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

void SpectralCommandOptions::declare(Command& command, const std::string& default_contacts) {
  contacts = default_contacts;
  command
      .add_with_default("--contacts", contacts,
                        "contacts of Stage 1: all, active, or unilateral; active: in compression in the linear rigid "
                        "problem; unilateral: carrying in the frictionless unilateral problem")
      .words = all_names<ContactSet>();
  command
      .add_with_default("--solver", solver,
                        "auto, dense, arpack, or shift-invert; auto: dense for small interfaces, else shift-invert; "
                        "arpack: matrix-free Lanczos")
      .words = all_names<SpectralSolver>();
  command.add_with_default("--residual-tolerance", options.tolerance, "largest residual that counts as converged");
}

ContactSet SpectralCommandOptions::contact_set() const { return Choice<ContactSet>::parse(contacts, "--contacts"); }

SpectralOptions SpectralCommandOptions::spectral() const {
  const Field positive{.description = "", .minimum = 0, .minimum_excluded = true};
  check_bounds(options.tolerance, positive, "--residual-tolerance");
  check_bounds(options.eigenvalues, Field{.description = "", .minimum = 1, .maximum = 100}, "--eigenvalues");
  SpectralOptions all = options;
  all.solver = Choice<SpectralSolver>::parse(solver, "--solver");
  if (all.solver == SpectralSolver::arpack && (all.certify || all.eigenvalues > 1))
    refuse("--solver: expected auto, dense or shift-invert with --certify or --eigenvalues, met arpack");
  return all;
}

void declare_threads(Command& command, Index& threads) {
  command.add_with_default("--threads", threads, "threads at the most, 0 for all; results do not depend on it")
      .bounds = {0, 4096};
}

void MemoryLimit::declare(Command& command) {
  command.add("--memory-limit", gibibytes,
              "memory the run may take, GiB; a run that is estimated to need more is refused; by default 90 % of what "
              "is available");
}

void MemoryLimit::require(const MemoryNeed& need) const {
  require(need.bytes, need.name, fmt::format("{} interface unknowns", need.interface_size),
          "fewer subdomains or grains, the solver arpack where it is dense");
}

void MemoryLimit::require(const Model& model, const SweepParameters& sweep) const {
  require({estimated_bytes(model, sweep), model.name, model.parts.interface_size()});
}

void MemoryLimit::require(double bytes, std::string_view name, std::string_view what, std::string_view advice) const {
  if (gibibytes)
    check_bounds(*gibibytes, Field{.description = "", .minimum = 0, .minimum_excluded = true}, "--memory-limit");
  const double limit = gibibytes ? *gibibytes * gibibyte : usable_share * available_bytes();
  if (bytes <= limit) return;
  refuse(
      "case {}: expected to fit into {:.3g} GiB of memory ({}), met an estimated need of {:.3g} GiB for {}; {}, or a "
      "larger --memory-limit may help",
      name, limit / gibibyte, gibibytes ? "--memory-limit" : "90 % of what is available", bytes / gibibyte, what,
      advice);
}

}  // namespace nscdd::app
