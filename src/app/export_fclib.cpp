// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/provenance.hpp"
#include "app/settled_cases.hpp"
#include "app/trajectory_export.hpp"
#include "files/output_file.hpp"
#include "formats/step_fclib.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/mechanics/friction_solver.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace nscdd::app {
namespace {

// Names the steps whose contact problems can be set up: those that follow a kept state.
[[noreturn]] void refuse_step(const std::string& path, Index step, Index last) {
  std::vector<Index> kept = trajectory_steps(path);
  if (kept.empty() || kept.back() != last) kept.push_back(last);
  std::vector<Index> possible;
  for (const Index each : kept) possible.push_back(each + 1);
  throw Error(fmt::format(
      "--fclib: {}: expected a step behind a state that is kept, so one of {}, met step {}; states are kept "
      "after steps {} (nscdd simulate --save-every 1 keeps all)",
      path, step_ranges_text(possible), step, step_ranges_text(kept)));
}

TrajectoryStep state_before(const FclibExport& what) {
  if (auto before = find_trajectory_step(what.trajectory, what.step - 1)) return *std::move(before);
  refuse_step(what.trajectory, what.step, read_last_step(what.trajectory).state.step);
}

TrajectoryStep kept_step(const FclibExport& what, std::optional<TrajectoryStep> after) {
  if (!after)
    throw Error(
        fmt::format("--subdomain: {}: expected a step that is kept, for its interface impulses ({}), met step {}",
                    what.trajectory, step_ranges_text(trajectory_steps(what.trajectory)), what.step));
  return *std::move(after);
}

// The name that the case of the run had. The trajectory keeps only the text of the case.
std::string case_name(const FclibExport& what, const TrajectoryHeader& header) {
  constexpr std::string_view mark = "# case ";
  for (const auto& [key, text] : header.provenance)
    if (key == "cases" && text.rfind(mark, 0) == 0) return text.substr(mark.size(), text.find('\n') - mark.size());
  return std::filesystem::path(what.trajectory).stem().string();
}

FclibInfo info_of(const FclibExport& what, const TrajectoryHeader& header, const Simulation& before, bool solved) {
  FclibInfo info;
  info.title = fmt::format("{}, step {}", case_name(what, header), what.step);
  if (what.subdomain) *info.title += fmt::format(", subdomain {}", *what.subdomain);
  const double h = before.dynamics.time.step;
  info.description =
      fmt::format("Contact problem of disks from t = {:.12g} s to {:.12g} s, law {}. Contacts ascend by their bodies.",
                  before.state.time, before.state.time + h, to_string(before.dynamics.interaction.law));
  if (!what.local)
    *info.description += what.subdomain ? " Bodies: free disks of the subdomain's contacts, ascending, split masses."
                                        : " Bodies: the free disks, ascending.";
  if (solved) *info.description += " The solution is that of the run, as far as it converged.";
  info.math_info = what.local ? "u = W r + q; (n, t) per contact, t = n turned by 90 degrees; N s, m/s"
                              : "M v = H r + f, u = H^T v + w; (vx, vy, spin) per body, (n, t) per contact, "
                                "t = n turned by 90 degrees; w holds gap/h, restitution and driven bodies; "
                                "N s, m/s, rad/s";
  if (what.subdomain) *info.math_info += "; interface impulses of the last iteration are loads";
  return info;
}

Provenance provenance_of(const Context& context, const TrajectoryHeader& header) {
  Provenance result = provenance(context, {});
  for (auto& [key, text] : result)
    for (const auto& [of_run, old] : header.provenance)
      if (key == "cases" && of_run == key) text = old;
  return result;
}

void print_report(const FclibExport& what, const FclibFile& file, const LocalFrictionProblem& local) {
  fmt::print("title                {}\n", *file.info.title);
  if (const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem))
    fmt::print("problem              global, {} velocities of bodies\n", global->mass.rows());
  else
    fmt::print("problem              local\n");
  fmt::print("contacts             {}\n", local.contacts());
  if (file.solution)
    fmt::print("residual of the run  {:.3e} (natural map, rho = 1/W_nn, relative to the impulses)\n",
               friction_state(local, file.solution->r).residual);
  else
    fmt::print("solution             none: step {} is not kept\n", what.step);
}

FclibFile subdomain_file(const FclibExport& what, const Simulation& before, const TrajectoryStep& after) {
  try {
    return fclib_of_subdomain(before, after, *what.subdomain);
  } catch (const Error& error) {
    throw Error(fmt::format("--subdomain: {}: {}", what.trajectory, error.what()));
  }
}

}  // namespace

int export_fclib(const FclibExport& what, const Context& context) {
  require_no_input({what.output}, {what.trajectory});
  require_hdf5_name(what.output);
  const TrajectoryHeader header = read_trajectory_header(what.trajectory);
  const Simulation before = rebuilt_simulation(what.trajectory, header, state_before(what).state);
  const std::optional<TrajectoryStep> after = find_trajectory_step(what.trajectory, what.step);
  FclibFile file = what.subdomain ? subdomain_file(what, before, kept_step(what, after))
                                  : fclib_of_step(before, after ? &*after : nullptr);
  const FclibFile local = local_form(file);
  if (what.local) file = local;
  file.info = info_of(what, header, before, file.solution.has_value());
  write_file(what.output, to_hdf5(file, provenance_of(context, header)), what.force);
  print_report(what, file, std::get<LocalFrictionProblem>(local.problem));
  return 0;
}

}  // namespace nscdd::app
