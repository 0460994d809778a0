// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "app/simulate_output.hpp"
#include "formats/case/case_file.hpp"

namespace nscdd::app {
namespace {

// An option that sets a parameter of the case.
struct ParameterOption {
  std::string option, form, key, help;
  std::vector<std::string> words = {};
  std::optional<std::string> value = {};
};

struct SimulateOptions {
  std::string name, subdomains, counts;
  RunFiles files;
  std::vector<ParameterOption> parameters{
      {"--algorithm", "WORD", "solver.algorithm", names_where<StepAlgorithm>(), all_names<StepAlgorithm>()},
      {"--scheme", "WORD", "solver.algorithm", "nscdd (the algorithm generic) or schwarz", {"nscdd", "schwarz"}},
      {"--gauss-seidel-sweeps", "N", "solver.gauss_seidel_sweeps", "sweeps n_GS per iteration"},
      {"--eta", "NUMBER[W]", "solver.eta",
       "flexibility of the enriched Stage 2: 1/kg, times the mean of W_nn (10W), or optimal"},
      {"--criterion", "WORD", "solver.criterion", names_where<Criterion>(), all_names<Criterion>()},
      {"--tolerance", "NUMBER", "solver.tolerance", "of the criterion"},
      {"--iterations", "N", "solver.maximum_iterations", "of a step at the most"},
      {"--preconditioner", "WORD", "solver.interface_preconditioner",
       names_where<InterfacePreconditioner>() + ", of two-stage methods", all_names<InterfacePreconditioner>()},
      {"--verdict", "WORD", "solver.verdict", "steps that get a verdict", all_names<VerdictSteps>()},
      {"--steps", "N", "dynamics.steps", "number of time steps"}};
  std::vector<std::string> settings;
  Limits limits;
  bool restart = false;
};

// Throws Error for a parameter without effect. On one subdomain, which has no interface, a note does: a loop over
// numbers of subdomains may begin with 1.
void require_effect(const GivenParameter& given, const CaseSpec& spec) {
  nscdd::require_effect(spec, given.key, given.option);
  Dynamics undivided = *spec.dynamics;
  undivided.solver.algorithm = StepAlgorithm::nlgs;
  if (!has_effect(undivided, given.key) && subdomains(spec.partition) == 1)
    note("{}: without effect on one subdomain, which has no interface", given.option);
}

// Errors name the option.
void set(CaseSpec& spec, const ParameterOption& parameter) try {
  const bool nscdd = parameter.option == "--scheme" && parameter.value == "nscdd";
  override_case(spec, parameter.key, nscdd ? "generic" : *parameter.value);
} catch (const Error& error) {
  const std::string text = error.what();
  if (!text.starts_with(parameter.key)) throw;
  fail("{}{}", parameter.option, text.substr(parameter.key.size()));
}

void apply(const SimulateOptions& options, CaseSpec& spec) {
  if (!spec.dynamics) fail("{}: expected a case with a section [dynamics], met one without", options.name);
  GivenParameters given;
  set_partition(spec, options.subdomains, given);
  for (const ParameterOption& parameter : options.parameters)
    if (parameter.value) add_given(given, parameter.key, parameter.option);
  apply_settings(spec, options.settings, given);
  for (const ParameterOption& parameter : options.parameters)
    if (parameter.value) set(spec, parameter);
  for (const GivenParameter& parameter : given) require_effect(parameter, spec);
  try {
    check_dynamics(spec);
  } catch (const Error& error) {
    throw located(spec, error);
  }
}

// The run removes files of these names when it ends.
void require_not_beside(const std::string& output, const std::string& table) {
  std::error_code ignored;
  for (const std::string& name : AlternatingFile::names_beside(output))
    if (fs::weakly_canonical(fs::absolute(table), ignored) == fs::weakly_canonical(fs::absolute(name), ignored))
      fail("{}: expected another name, met one that is taken while {} is written", table, output);
}

void check_names(const SimulateOptions& options) {
  const RunFiles& files = options.files;
  require_ending(files.output, hdf5_endings);
  require_distinct({files.output, files.convergence, options.counts});
  for (const std::string& table : {files.convergence, options.counts})
    if (!table.empty()) require_not_beside(files.output, table);
  if (options.restart && files.force)
    fail("--restart: expected either to go on with a run or to replace it, met --force too");
  if (options.restart) return;
  require_writable(files.output, files.force);
  if (!files.convergence.empty()) require_writable(files.convergence, files.force);
}

int close(const SimulateOptions& options, const Simulation& simulation, const RunOutcome& outcome,
          const RunTotals& totals) {
  if (const std::string words = lack_of_room(totals); !words.empty()) note("{}: {}", options.files.output, words);
  if (outcome.end == RunEnd::stopped)
    return interrupted("{}: interrupted after {} of {} steps; --restart goes on with it", options.files.output,
                       simulation.state.step, simulation.dynamics.time.steps);
  fmt::print(options.files.convergence == "-" ? stderr : stdout, "{}", report_text(totals, simulation, outcome));
  if (!failed(outcome.end)) return 0;
  note("{}: {}{}; it holds the last good state", options.files.output,
       outcome.end == RunEnd::broke_down ? "broke down in " : "", outcome.reason);
  const StepSolver& solver = simulation.dynamics.solver;
  if (outcome.end == RunEnd::broke_down && has_part(solver.algorithm, StepPart::whole_copies))
    note(
        "schwarz may diverge with an interface_relaxation of 2 / q or more, q the most subdomains that share a body, "
        "met {}",
        solver.interface_relaxation);
  return 1;
}

// Several ranks can only share a step that is divided into subdomains.
void require_shared(const CaseSpec& spec, const Machine& machine) {
  if (machine.processes.alone()) return;
  const StepSolver& solver = spec.dynamics->solver;
  if (!decomposes(solver.algorithm))
    fail("solver.algorithm: expected {} on several ranks, met {}: run it with nscdd on a single rank",
         algorithms_with(StepPart::subdomains), to_string(solver.algorithm));
  if (solver.model != SwitchedModel::none)
    require_one_process(machine, fmt::format("solver.switch {}", to_string(solver.model)));
  require_subdomains(subdomains(spec.partition), machine.processes.size);
}

// A fingerprint of the start of the run and of its options, compared across ranks.
std::vector<double> features(const Simulation& simulation, const std::string& case_text,
                             const SimulateOptions& options) {
  const auto& [system, state] = std::tie(simulation.system, simulation.state);
  std::vector<double> numbers;
  const auto add = [&](const auto& values) { numbers.insert(numbers.end(), values.begin(), values.end()); };
  add(std::array{state.step, options.files.convergence_every.value_or(0)});
  add(std::array{options.counts.empty(), options.files.convergence.empty()});
  for (const auto values : numbers_of_grains(system.dimension)) add(state.*values);
  add(system.radius);
  add(system.mass);
  for (const auto& one : state.impulses) {
    add(one.impulse);
    add(std::array{one.slid});
  }
  for (const auto& one : state.gluing) add(one.impulse);
  const std::string text = fingerprint(case_text + fingerprint(std::span<const double>(numbers)));
  return {text.begin(), text.end()};
}

int run_simulate(const SimulateOptions& options, const Context& context) {
  const Processes& all = context.machine.processes;
  const ThreadLimit limit = options.limits.apply(context.machine);
  std::optional<Case> one;
  const auto resolved = [&](const CaseSpec& spec) {
    return resolve_case(spec, {options.files.output, options.files.convergence, options.counts});
  };
  CaseSpec spec = all.together([&] {
    if (all.first()) check_names(options);
    const std::string path = find_case(options.name);
    CaseSpec found = spec_of_file(path, true);
    apply(options, found);
    require_shared(found, context.machine);
    if (std::holds_alternative<PackingFile>(found.packing))
      found = one.emplace(resolved(found)).spec;  // with its clumps
    if (options.restart && all.first()) check_restart(options.files.output, options.files.convergence, found);
    return found;
  });
  if (!one) one = in_turn(all, [&] { return resolved(spec); });
  std::optional<RunSoFar> found;
  Simulation simulation = all.together([&] {
    Simulation start = simulation_of(*one);
    start.processes = all;
    start.inertia = context.machine.inertia;
    start.bddc = context.machine.bddc;
    if (!options.restart) return start;
    take_up(start, options.files.output);
    found = run_so_far(options.files.output);
    return start;
  });
  if (!all.alone()) require_same(features(simulation, to_toml(spec), options), spec.name, all);
  CountsTable counts(options.counts, options.files.force, context.machine);
  Interruption interruption(all);
  RunOutput output(options.files, all);
  output.open({to_toml(spec), build_fingerprint(), provenance(context, {*one}), simulation.system}, simulation, found,
              context.command_line);
  one.reset();  // the simulation no longer needs its packing
  give_back_freed_memory();
  RunTotals totals;
  RunSinks sinks;
  sinks.iteration = output.iterations();
  sinks.monitor = interruption.watch("simulate " + spec.name, simulation.state.step, "step");
  sinks.step = [&](const Simulation& after, const AnySolvedStep& solved, const StepReport& report) {
    output.add(after, solved, report);
    totals.add(report);
  };
  const RunOutcome outcome = run_simulation(simulation, sinks, found ? found->speeds : std::vector<double>{});
  output.end(outcome);
  counts.finish();
  return close(options, simulation, outcome, totals);
}

}  // namespace

Action declare_simulate(Command& command) {
  auto options = std::make_shared<SimulateOptions>();
  command.required(
      "CASE", options->name,
      "case file (.toml) with [dynamics], known case, packing file (its grains and clumps fall), DATBOX or record "
      "lmgc90.h5:ID_3 of LMGC90");
  command.add("--subdomains PARTITION", options->subdomains,
              "partition: NXxNY[xNZ] for a regular grid, metis:N for METIS");
  for (ParameterOption& one : options->parameters)
    command.add(one.option + " " + one.form, one.value, fmt::format("{}: {}", one.help, one.key)).words = one.words;
  command.add("--set KEY=VALUE", options->settings, "a parameter of the case, such as interaction.friction=0.2");
  options->limits.declare_threads(command);
  command.required("-o,--output FILE", options->files.output, "trajectory, .h5 or .hdf5");
  const Option* convergence = &command.add("--convergence FILE", options->files.convergence,
                                           "also a table of the iterations of every step, - for standard output; with "
                                           "--restart the rows of the steps taken now are added to it");
  command
      .add("--convergence-every", options->files.convergence_every,
           "rows of every Nth iteration, without it about ten per decade; a row costs several sweeps. "
           "The last iteration of a step always has one",
           {.minimum = 1, .maximum = 1e9})
      .needs = convergence;
  CountsTable::declare(command, options->counts);
  command.preset("--save-every", options->files.save_every, "keep every Nth step; the last one is always kept",
                 {.minimum = 1, .maximum = 1e9});
  command.add("--restart", options->restart, "go on with the output of a run before, up to --steps");
  command.add("--force", options->files.force, "replace existing outputs");
  options->limits.declare_memory(command);
  command.footer =
      R"(Prints how the run went; layout of the trajectory in docs/formats.md. A run that is killed, interrupted or
finished goes on with --restart, bit for bit as in one piece.
Exit codes: 0 done, 1 broken down or without a solution (the last state is kept), 2 bad input, 130 stopped.
Examples:
  nscdd simulate shear-1k -o shear.h5
  nscdd simulate shear-1k --algorithm enriched --eta 30W --gauss-seidel-sweeps 100 -o e.h5
  nscdd simulate shear-1k --steps 10 --convergence indicators.csv --convergence-every 1 -o ten.h5
  nscdd simulate shear-1k --steps 500 --restart -o shear.h5)";
  return [options](const Context& context) { return run_simulate(*options, context); };
}

}  // namespace nscdd::app
