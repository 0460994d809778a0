// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/export_steps.hpp"
#include "app/shared_work.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/contact_problem/step_fclib.hpp"
#include "formats/matrices/operators_file.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "study/linear/inspection.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {
namespace {

// Options of `nscdd export CASE --operators FOLDER`.
struct OperatorsOptions {
  CaseOptions one;  // its name is the CASE of every export
  std::string folder, epsilon, eta = "inf";
  Choice<ContactSet> contacts = ContactSet::all;
  double relaxation = 1;
  bool sparse_only = false;
  Limits limits;
};

struct ExportOptions {
  OperatorsOptions operators;
  StepsOptions steps;
  std::string output;
  std::optional<Index> step, subdomain;
  bool local = false, force = false;

  const std::string& trajectory() const { return operators.one.name; }
};

// The step before the exported one. If it is not kept, throws Error with the steps that follow a kept state.
TrajectoryStep state_before(const ExportOptions& options) {
  if (auto before = find_trajectory_step(options.trajectory(), *options.step - 1)) return *std::move(before);
  const Index last = read_last_step(options.trajectory()).state.step;
  std::vector<Index> kept = trajectory_steps(options.trajectory());
  if (kept.empty() || kept.back() != last) kept.push_back(last);
  std::vector<Index> possible = kept;
  for (Index& step : possible) ++step;
  fail(
      "--fclib: {}: expected a step whose state before it is kept, so one of {}, met step {}; states are kept after "
      "steps {} (nscdd simulate --save-every 1 keeps all)",
      options.trajectory(), step_ranges_text(possible), *options.step, step_ranges_text(kept));
}

FclibInfo info_of(const ExportOptions& options, const TrajectoryHeader& header, const Simulation& before, bool solved) {
  FclibInfo info;
  info.title = fmt::format("{}, step {}", name_of_case(options.trajectory(), header), *options.step);
  if (options.subdomain) *info.title += fmt::format(", subdomain {}", *options.subdomain);
  const double h = before.dynamics.time.step;
  const bool space = before.system.dimension == 3;
  const std::string_view shape = shape_of_grains(before.system.dimension);
  info.description =
      fmt::format("Contact problem of {}s from t = {:.12g} s to {:.12g} s, law {}. Contacts ascend by their bodies.",
                  shape, before.state.time, before.state.time + h, to_string(before.dynamics.interaction.law));
  if (!options.local)
    *info.description +=
        options.subdomain
            ? fmt::format(" Bodies: free {}s of the subdomain's contacts, ascending, split masses.", shape)
            : fmt::format(" Bodies: the free {}s, ascending{}.", shape,
                          before.system.free_bodies.empty()
                              ? ""
                              : ", then bodies with free directions; driven directions have no entries in H");
  if (solved) *info.description += " The solution is that of the run, as far as it converged.";
  const std::string_view frame = space ? "(n, t_1, t_2) per contact, tangents as docs/formats.md says"
                                       : "(n, t) per contact, t = n turned by 90 degrees";
  info.math_info = options.local ? fmt::format("u = W r + q; {}; N s, m/s", frame)
                                 : fmt::format(
                                       "M v = H r + f, u = H^T v + w; {} per body, {}; w holds gap/h, restitution and "
                                       "driven bodies; N s, m/s, rad/s",
                                       space ? "(vx, vy, vz, spin about x, y, z)" : "(vx, vy, spin)", frame);
  if (options.subdomain) *info.math_info += "; interface impulses of the last iteration are loads";
  return info;
}

Provenance provenance_of(const Context& context, const TrajectoryHeader& header) {
  Provenance result = provenance(context, {});
  for (auto& [key, text] : result)
    for (const auto& [of_run, old] : header.provenance)
      if (key == "cases" && of_run == key) text = old;
  return result;
}

void print_report(const ExportOptions& options, const FclibFile& file, const LocalFrictionProblem& local) {
  fmt::print("title                {}\n", printable(*file.info.title));
  if (const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem))
    fmt::print("problem              global, {} velocities of bodies\n", global->mass.rows());
  else
    fmt::print("problem              local\n");
  fmt::print("contacts             {}\n", local.contacts());
  if (file.solution)
    fmt::print("residual of the run  {:.3e} (natural map, rho = 1/W_nn, relative to the impulses)\n",
               friction_state(local, file.solution->r).residual);
  else
    fmt::print("solution             none: step {} is not kept\n", *options.step);
}

FclibFile subdomain_file(const ExportOptions& options, const Simulation& before,
                         const std::optional<TrajectoryStep>& after) try {
  if (!after)
    fail("expected a step that is kept, for its interface impulses ({}), met step {}",
         step_ranges_text(trajectory_steps(options.trajectory())), *options.step);
  return fclib_of_subdomain(before, *after, *options.subdomain);
} catch (const Error& error) {
  fail("--subdomain: {}: {}", options.trajectory(), error.what());
}

int export_fclib(const ExportOptions& options, const Context& context) {
  require_no_input({options.output}, {options.trajectory()});
  if (!has_siconos_name(options.output)) require_ending(options.output, hdf5_endings);
  const TrajectoryHeader header = read_trajectory_header(options.trajectory());
  const Simulation before = rebuilt_simulation(options.trajectory(), header, state_before(options).state);
  const std::optional<TrajectoryStep> after = find_trajectory_step(options.trajectory(), *options.step);
  FclibFile file =
      options.subdomain ? subdomain_file(options, before, after) : fclib_of_step(before, after ? &*after : nullptr);
  const FclibFile local = local_form(file);
  if (options.local) file = local;
  file.info = info_of(options, header, before, file.solution.has_value());
  write_file(options.output,
             has_siconos_name(options.output) ? siconos_text(file, "nscdd " + version())
                                              : to_hdf5(file, provenance_of(context, header)),
             options.force);
  print_report(options, file, std::get<LocalFrictionProblem>(local.problem));
  return 0;
}

// `scale`: of relative flexibilities, 1/kg.
OperatorParameters parameters(const OperatorsOptions& options, double scale) {
  OperatorParameters result{.dense = !options.sparse_only};
  if (options.sparse_only) return result;
  if (options.epsilon.empty())
    fail("--epsilon: expected the flexibility behind S with --operators, or --sparse-only to leave S, P and B out");
  result.epsilon = one_value(parse_epsilon(options.epsilon), scale, "--epsilon NUMBER[W]", options.epsilon);
  result.eta = one_value(parse_eta(options.eta), scale, "--eta", options.eta);
  result.relaxation = options.relaxation;
  return result;
}

int export_operators(const OperatorsOptions& options, bool force, const Context& context) {
  parameters(options, 1);  // refused before the model is built
  const ThreadLimit limit = options.limits.apply(context.machine);
  const std::filesystem::path path(options.folder);
  const Case what = options.one.resolve(
      {(path / OperatorsFolder::manifest_name).string(), (path / OperatorsFolder::hdf5_name).string()});
  OperatorsFolder folder(options.folder, force, "nscdd " + version());
  const Model model = build(what);
  const OperatorParameters wanted = parameters(options, flexibility_scale(model));
  const Selection selection = select(model, options.contacts);
  if (!selection.certain) note("{}: the impulses behind the contacts of Stage 1 were not found to 1e-8", model.name);
  if (model.parts.interface_size() == 0)
    note("{}: the interface is empty ({}): there are no operators of it", model.name, why_empty(model));
  Index operators = 0;
  Interruption interruption;
  const auto add = [&](const CaseOperator& one) {
    folder.add(one);
    ++operators;
  };
  if (!case_operators(model, selection, wanted, add, interruption.watch("B", 0, "column")))
    return interrupted("{}: interrupted; it is left as it was", options.folder);
  folder.finish(selection.of_case, model.problem.dofs_per_grain, wanted, provenance(context, {what}));
  fmt::print("{}: {} operators of {}, {} interface unknowns", (path / OperatorsFolder::manifest_name).string(),
             operators, model.name, model.parts.interface_size());
  if (wanted.dense) fmt::print(", epsilon {} 1/kg, eta {} 1/kg", field_text(wanted.epsilon), field_text(wanted.eta));
  fmt::print("\n");
  return 0;
}

int run_export(const ExportOptions& options, const Context& context) {
  const auto asked = std::ranges::count_if(std::array{options.steps.vtk, options.steps.vtkhdf, options.steps.lmgc90,
                                                      options.operators.folder},
                                           [](const std::string& name) { return !name.empty(); }) +
                     (options.step ? 1 : 0);
  if (asked != 1)
    fail(
        "export: expected one of --vtk FOLDER, --vtkhdf FILE, --lmgc90 FOLDER, --fclib STEP and --operators FOLDER, "
        "met {}",
        asked == 0 ? "none" : "several");
  if (!options.steps.range.empty() && (options.step || !options.operators.folder.empty()))
    fail("--steps: expected --vtk, --vtkhdf or --lmgc90 with it, met {}", options.step ? "--fclib" : "--operators");
  if (!options.operators.folder.empty()) return export_operators(options.operators, options.force, context);
  if (options.step && options.output.empty()) fail("--fclib: expected -o FILE.hdf5 (or FILE.dat) with it, met none");
  if (options.step) return export_fclib(options, context);
  return export_steps(options.steps, options.trajectory(), options.force);
}

// Declares --operators, which it returns, and the options that need it.
Option& declare_operators(Command& command, OperatorsOptions& options) {
  Option& operators = command.add("--operators FOLDER", options.folder,
                                  "write M, H, W, S, P, B and more there, as Matrix Market and HDF5");
  const std::size_t first = command.options.size();
  options.one.declare_options(command);
  Option& sparse = command.add("--sparse-only", options.sparse_only, "leave the dense S, P and B out");
  command.add("--epsilon NUMBER[W]", options.epsilon,
              "flexibility of the linear law, 1/kg, or times the mean of W_nn (0.1W); 0 is the rigid limit");
  command.preset("--eta NUMBER[W]", options.eta,
                 "flexibility Stage 2 sees, 1/kg, or times the mean of W_nn (10W); inf is the generic algorithm");
  command.preset("--relaxation", options.relaxation, "omega of B = I - omega P^-1 S", {.above = 0});
  declare_contacts(command, options.contacts);
  options.limits.declare(command);
  for (std::size_t k = first; k < command.options.size(); ++k) {
    Option& option = command.options[k];
    option.needs = &operators;
    if (option.names == "--epsilon" || option.names == "--eta" || option.names == "--relaxation")
      option.excludes = &sparse;
  }
  return operators;
}

}  // namespace

Action declare_export(Command& command) {
  auto options = std::make_shared<ExportOptions>();
  command.required("CASE", options->operators.one.name,
                   "trajectory (.h5 or .hdf5), or with --operators what nscdd sweep takes");
  const Option* vtk = &command.add("--vtk FOLDER", options->steps.vtk,
                                   "write the kept steps there for ParaView: .vtp files, a .pvd collection");
  command.add("--vtkhdf FILE", options->steps.vtkhdf, "write the kept steps for ParaView into one file, .vtkhdf")
      .excludes = vtk;
  command
      .add("--lmgc90 FOLDER", options->steps.lmgc90, "write folders of LMGC90: DATBOX of the first step, OUTBOX of all")
      .excludes = vtk;
  command.add("--steps A[:B[:K]]", options->steps.range, "of all these: steps A, A + K, ... up to B that are kept");
  Option* fclib =
      &command.add("--fclib", options->step, "write the contact problem of that step, from 1, as HDF5 of FCLIB");
  fclib->excludes = vtk;
  command.add("-o,--output FILE", options->output, "file of --fclib: .hdf5, or .dat of Siconos; that has no solution")
      .needs = fclib;
  command.add("--subdomain", options->subdomain, "of --fclib: the part of that subdomain, interface impulses as loads")
      .needs = fclib;
  command.add("--local", options->local, "of --fclib: W and q instead of M, H, f and w").needs = fclib;
  declare_operators(command, options->operators).excludes = vtk;
  command.add("--force", options->force, "replace existing outputs");
  command.footer =
      R"(A step can be written as a contact problem where the state before it is kept; its solution is that of the
run where the step itself is kept. Operators are those of docs/notation.md, S = X_epsilon and P = X_eta.
Examples:
  nscdd simulate shear-1k --steps 5 --subdomains 2x1 --algorithm generic -o run.h5
  nscdd export run.h5 --vtk pictures --steps 0:5
  nscdd export run.h5 --vtkhdf run.vtkhdf
  nscdd export run.h5 --lmgc90 lmgc90
  nscdd export run.h5 --fclib 5 -o problem.hdf5
  nscdd export run.h5 --fclib 5 --subdomain 1 --local -o part.hdf5
  nscdd solve problem.hdf5 --tolerance 1e-6
  nscdd export hexagonal --operators matrices --epsilon 1e-3 --eta 0.3)";
  return [options](const Context& context) { return run_export(*options, context); };
}

}  // namespace nscdd::app
