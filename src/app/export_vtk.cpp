// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/interruption.hpp"
#include "app/progress.hpp"
#include "app/trajectory_export.hpp"
#include "files/output_file.hpp"
#include "formats/trajectory.hpp"
#include "formats/vtk.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

std::vector<Index> chosen(const VtkExport& what) {
  const std::vector<Index> kept = trajectory_steps(what.trajectory);
  const StepRange& range = what.steps;
  std::vector<Index> steps;
  for (const Index step : kept)
    if (step >= range.first && (range.last < 0 || step <= range.last) && (step - range.first) % range.stride == 0)
      steps.push_back(step);
  if (steps.empty())
    throw Error(fmt::format("--steps: expected a range with some of the steps that {} keeps ({}), met none",
                            what.trajectory, step_ranges_text(kept)));
  return steps;
}

void make_folder(const VtkExport& what) {
  std::error_code status;
  if (fs::exists(what.folder, status)) {
    if (!fs::is_directory(what.folder, status))
      throw Error(fmt::format("{}: expected a folder, met a file", what.folder));
    if (!what.force && !fs::is_empty(what.folder, status))
      throw Error(
          fmt::format("{}: expected an empty folder or none, met one that holds files; --force "
                      "writes into it",
                      what.folder));
    return;
  }
  fs::create_directories(what.folder, status);
  if (status) throw Error(fmt::format("{}: cannot be made: {}", what.folder, status.message()));
}

}  // namespace

int export_vtk(const VtkExport& what) {
  const GranularSystem system = read_trajectory_header(what.trajectory).system;
  const std::vector<Index> steps = chosen(what);
  make_folder(what);
  const fs::path folder(what.folder);
  std::vector<VtkFile> files;
  Interruption interruption;
  {
    Progress progress("export " + fs::path(what.trajectory).filename().string(), 0, "step");
    const Monitor monitor = interruption.watch(progress.monitor());
    for (const Index step : steps) {
      const VtkFrame frame = vtk_frame(system, read_trajectory_step(what.trajectory, step));
      files.push_back({frame.time, fmt::format("step-{:06}.vtp", step)});
      write_file((folder / files.back().path).string(), vtp_text(frame), what.force);
      if (!report(monitor, count(files), count(steps))) break;
    }
  }
  const fs::path collection = folder / (fs::path(what.trajectory).stem().string() + ".pvd");
  write_file(collection.string(), pvd_text(files), what.force);
  if (files.size() < steps.size()) {
    note(fmt::format("{}: interrupted after {} of {} steps, which {} lists", what.folder, files.size(), steps.size(),
                     collection.string()));
    return interrupted_exit_code;
  }
  fmt::print("{}: {} steps ({}), {} disks\n", collection.string(), files.size(), step_ranges_text(steps),
             system.disks());
  return 0;
}

}  // namespace nscdd::app
