// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/export_steps.hpp"

#include "app/step_range.hpp"
#include "files/output_file.hpp"
#include "formats/lmgc90/datbox_writer.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "formats/vtk/vtk.hpp"
#include "formats/vtk/vtkhdf.hpp"

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

// The kept steps that are asked for.
struct Chosen {
  std::string trajectory;
  TrajectoryHeader header;
  std::vector<Index> steps;
  bool force = false;

  std::string summary(Index done) const {
    return fmt::format("{} steps ({}), {} {}s", done, step_ranges_text(steps), header.system.grains(),
                       shape_of_grains(header.system.dimension));
  }
};

Chosen chosen(const std::string& trajectory, const StepRange& range, bool force) {
  return {trajectory, read_trajectory_header(trajectory), chosen_steps(trajectory, range), force};
}

// Hands over the steps one by one, until there are no more or the user interrupts. Returns how many it handed over.
Index hand_over(const Chosen& chosen, const std::function<void(Index, const TrajectoryStep&)>& take) {
  Interruption interruption;
  const Monitor monitor = interruption.watch("export " + fs::path(chosen.trajectory).filename().string(), 0, "step");
  Index done = 0;
  for (const Index step : chosen.steps) {
    take(step, read_trajectory_step(chosen.trajectory, step));
    if (!report(monitor, ++done, count(chosen.steps))) break;
  }
  return done;
}

// Pictures of the steps, and a collection that lists those that are there.
int export_vtk(const Chosen& chosen, const fs::path& folder) {
  make_folder(folder.string(), chosen.force);
  std::vector<VtkFile> files;
  const Index done = hand_over(chosen, [&](Index step, const TrajectoryStep& shown) {
    files.push_back({shown.state.time, fmt::format("step-{:06}.vtp", step)});
    write_file((folder / files.back().path).string(), vtp_text(chosen.header.system, shown), chosen.force);
  });
  const std::string collection = (folder / (fs::path(chosen.trajectory).stem().string() + ".pvd")).string();
  write_file(collection, pvd_text(files), chosen.force);
  if (done < count(chosen.steps)) {
    note("{}: interrupted after {} of {} steps, which {} lists", folder.string(), done, chosen.steps.size(),
         collection);
    return interrupted_exit_code;
  }
  fmt::print("{}: {}\n", collection, chosen.summary(done));
  return 0;
}

// The same pictures in one file, which is there once all of them are in it.
int export_vtkhdf(const Chosen& chosen, const std::string& path) {
  VtkhdfFile file(path, chosen.force);
  const Index done = hand_over(
      chosen, [&](Index, const TrajectoryStep& shown) { file.append(picture_of(chosen.header.system, shown)); });
  if (done < count(chosen.steps)) {
    note("{}: interrupted; nothing was written", path);
    return interrupted_exit_code;
  }
  file.finish();
  fmt::print("{}: {}\n", path, chosen.summary(done));
  return 0;
}

using Write = std::function<void(const std::string& name, const std::string& text)>;

bool spins(const GranularState& state) {
  const auto any = [](const std::vector<double>& spins) {
    return std::ranges::any_of(spins, [](double spin) { return spin != 0; });
  };
  return any(state.spin) || any(state.spin_x) || any(state.spin_y);
}

// What LMGC90 begins with: the first of the steps. So does this program, where no grain spins in it.
void write_datbox(const DatboxWriter& writer, const TrajectoryStep& first, const Write& write) {
  write("BODIES.DAT", writer.bodies());
  write("BULK_BEHAV.DAT", writer.bulk());
  write("TACT_BEHAV.DAT", writer.tact());
  write("DRV_DOF.DAT", writer.driven());
  for (const auto& [name, text] : writer.tables()) write(name, text);
  write("DOF.INI", writer.dof(first));
  write("Vloc_Rloc.INI", writer.vloc_rloc(first));
}

int export_lmgc90(const Chosen& chosen, const fs::path& folder) {
  const TrajectoryStep first = read_trajectory_step(chosen.trajectory, chosen.steps.front());
  const DatboxWriter writer(rebuilt_simulation(chosen.trajectory, chosen.header, first.state));
  make_folder(folder.string(), chosen.force);
  const auto into = [&](const char* name) -> Write {
    make_folder((folder / name).string(), chosen.force);
    return [path = folder / name, force = chosen.force](const std::string& file, const std::string& text) {
      write_file((path / file).string(), text, force);
    };
  };
  const std::string reason = writer.without_datbox();
  if (reason.empty()) {
    write_datbox(writer, first, into("DATBOX"));
    if (spins(first.state))
      note("{}: {}s spin in step {}, which nscdd simulate does not begin with; LMGC90 does",
           (folder / "DATBOX").string(), shape_of_grains(chosen.header.system.dimension), first.state.step);
  } else {
    note("{}: no DATBOX is written: {}", folder.string(), reason);
  }
  const Write write = into("OUTBOX");
  write("BODIES.OUT", writer.bodies());
  write("BULK_BEHAV.OUT", writer.bulk());
  const Index done = hand_over(chosen, [&](Index step, const TrajectoryStep& shown) {
    write(fmt::format("DOF.OUT.{}", step), writer.dof(shown));
    write(fmt::format("Vloc_Rloc.OUT.{}", step), writer.vloc_rloc(shown));
  });
  if (done < count(chosen.steps)) {
    note("{}: interrupted after {} of {} steps", folder.string(), done, chosen.steps.size());
    return interrupted_exit_code;
  }
  fmt::print("{}: {}\n", folder.string(), chosen.summary(done));
  return 0;
}

}  // namespace

int export_steps(const StepsOptions& options, const std::string& trajectory, bool force) {
  if (!options.vtkhdf.empty()) {
    require_no_input({options.vtkhdf}, {trajectory});
    require_ending(options.vtkhdf, vtkhdf_endings);
  }
  const Chosen steps = chosen(trajectory, parse_step_range(options.range), force);
  if (!options.lmgc90.empty()) return export_lmgc90(steps, options.lmgc90);
  return options.vtkhdf.empty() ? export_vtk(steps, options.vtk) : export_vtkhdf(steps, options.vtkhdf);
}

}  // namespace nscdd::app
