// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export_steps.hpp"

#include "app/case_options.hpp"
#include "core/text.hpp"
#include "formats/lmgc90/datbox_writer.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "formats/vtk/vtkhdf.hpp"

namespace nscdd::app {
namespace {

// The kept steps to export.
struct Chosen {
  std::string trajectory;
  TrajectoryHeader header;
  std::vector<Index> steps;
  bool force = false;
  bool draws = false;  // pictures, with chains that jam
};

// Passes the steps to `take` one by one until the user interrupts. Returns their number.
Index hand_over(const Chosen& chosen, const std::function<void(const GranularSystem&, const TrajectoryStep&)>& take) {
  GranularSystem system = chosen.header.system;
  Interruption interruption;
  const Monitor monitor = interruption.watch("export " + fs::path(chosen.trajectory).filename().string(), 0, "step");
  Index done = 0;
  for (const Index step : chosen.steps) {
    TrajectoryStep shown = read_trajectory_step(chosen.trajectory, step);
    free_released_grains(system, shown.state);
    if (chosen.draws) add_chain(chosen.trajectory, shown);
    take(system, shown);
    if (!report(monitor, ++done, count(chosen.steps))) break;
  }
  return done;
}

int finished(const Chosen& chosen, const std::string& name) {
  fmt::print("{}: {} steps ({}), {} {}s\n", name, chosen.steps.size(), step_ranges_text(chosen.steps),
             chosen.header.system.grains(), shape_of_grains(chosen.header.system.dimension));
  return 0;
}

// A .vtp file per step, and a .pvd collection of those written.
int export_vtk(const Chosen& chosen, const fs::path& folder) {
  make_folder(folder.string(), chosen.force);
  std::vector<VtkFile> files;
  const Index done = hand_over(chosen, [&](const GranularSystem& system, const TrajectoryStep& shown) {
    files.push_back({shown.state.time, fmt::format("step-{:06}.vtp", shown.state.step)});
    write_file((folder / files.back().path).string(), vtp_text(system, shown), chosen.force);
  });
  const std::string collection = (folder / (fs::path(chosen.trajectory).stem().string() + ".pvd")).string();
  write_file(collection, pvd_text(files), chosen.force);
  if (done < count(chosen.steps))
    return interrupted("{}: interrupted after {} of {} steps, which {} lists", folder.string(), done,
                       chosen.steps.size(), collection);
  return finished(chosen, collection);
}

// All steps in one file, which takes its name once it is complete.
int export_vtkhdf(const Chosen& chosen, const std::string& path) {
  VtkhdfFile file(path, chosen.force);
  const Index done = hand_over(chosen, [&](const GranularSystem& system, const TrajectoryStep& shown) {
    file.append(picture_of(system, shown));
  });
  if (done < count(chosen.steps)) return interrupted("{}: interrupted; nothing was written", path);
  file.finish();
  return finished(chosen, path);
}

int export_lmgc90(const Chosen& chosen, const fs::path& folder) {
  const TrajectoryStep first = read_trajectory_step(chosen.trajectory, chosen.steps.front());
  const DatboxWriter writer(rebuilt_simulation(chosen.trajectory, chosen.header, first.state));
  make_folder(folder.string(), chosen.force);
  const auto into = [&](const char* name) {
    make_folder((folder / name).string(), chosen.force);
    return [path = folder / name, force = chosen.force](const std::string& file, const std::string& text) {
      write_file((path / file).string(), text, force);
    };
  };
  const std::string reason = writer.without_datbox();
  if (reason.empty()) {
    const auto write = into("DATBOX");  // for a run from the first step, which nscdd simulate reads, too
    write("BODIES.DAT", writer.bodies());
    write("BULK_BEHAV.DAT", writer.bulk());
    write("TACT_BEHAV.DAT", writer.tact());
    for (const auto& [name, text] : writer.driven()) write(name, text);
    write("DOF.INI", writer.dof(first));
    write("Vloc_Rloc.INI", writer.vloc_rloc(first));
  } else {
    note("{}: no DATBOX is written: {}", folder.string(), reason);
  }
  if (const Period& period = chosen.header.system.period; period.any())
    note("{}: LMGC90's files do not have the period: {} m along x, {} m along y", folder.string(), period.x, period.y);
  if (first.state.step == 0 && !first.state.impulses.empty())
    note("{}: Vloc_Rloc.INI does not have the forces of step 0, whose contacts are found in step 1", folder.string());
  const auto write = into("OUTBOX");
  write("BODIES.OUT", writer.bodies());
  write("BULK_BEHAV.OUT", writer.bulk());
  const Index done = hand_over(chosen, [&](const GranularSystem&, const TrajectoryStep& shown) {
    write(fmt::format("DOF.OUT.{}", shown.state.step), writer.dof(shown));
    write(fmt::format("Vloc_Rloc.OUT.{}", shown.state.step), writer.vloc_rloc(shown));
  });
  if (done < count(chosen.steps))
    return interrupted("{}: interrupted after {} of {} steps", folder.string(), done, chosen.steps.size());
  return finished(chosen, folder.string());
}

}  // namespace

std::string step_ranges_text(const std::vector<Index>& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size();) {
    // A range ends where the stride changes. Two steps are no range.
    std::size_t last = i;
    while (last + 1 < steps.size() && steps[last + 1] - steps[last] == steps[i + 1] - steps[i]) ++last;
    if (last < i + 2) last = i;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", steps[i]);
    if (last > i) text += fmt::format(":{}", steps[last]);
    if (last > i && steps[i + 1] - steps[i] > 1) text += fmt::format(":{}", steps[i + 1] - steps[i]);
    i = last + 1;
  }
  return text;
}

std::vector<Index> chosen_steps(const std::string& trajectory, const std::string& range) {
  Index first = 0, last = std::numeric_limits<Index>::max(), stride = 1;
  if (!range.empty()) {
    std::vector<Index> numbers;
    for (const std::string_view number : split(range, ':'))
      numbers.push_back(parse_integer(number, "--steps A, A:B or A:B:K"));
    first = numbers[0];
    last = numbers.size() > 1 ? numbers[1] : first;
    if (numbers.size() > 2) stride = numbers[2];
    if (numbers.size() > 3 || first < 0 || last < first || stride < 1)
      fail("--steps: expected A, A:B or A:B:K with 0 <= A <= B and K >= 1, met '{}'", range);
  }
  const std::vector<Index> kept = trajectory_steps(trajectory);
  std::vector<Index> steps;
  std::ranges::copy_if(kept, std::back_inserter(steps),
                       [&](Index step) { return step >= first && step <= last && (step - first) % stride == 0; });
  if (steps.empty())
    fail("--steps: expected a range with some of the steps that {} keeps ({}), met none", trajectory,
         step_ranges_text(kept));
  return steps;
}

int export_steps(const StepsOptions& options, const std::string& trajectory, bool force) {
  if (!options.vtkhdf.empty()) {
    require_no_input({options.vtkhdf}, {trajectory});
    require_ending(options.vtkhdf, vtkhdf_endings);
  }
  const Chosen steps{trajectory, read_trajectory_header(trajectory), chosen_steps(trajectory, options.range), force,
                     options.lmgc90.empty()};
  if (!options.lmgc90.empty()) return export_lmgc90(steps, options.lmgc90);
  return options.vtkhdf.empty() ? export_vtk(steps, options.vtk) : export_vtkhdf(steps, options.vtkhdf);
}

}  // namespace nscdd::app
