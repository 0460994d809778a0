// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/solve_trials.hpp"
#include "contact_solvers/stored_contacts.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/contact_problem/step_fclib.hpp"
#include "formats/lmgc90/record.hpp"
#include "formats/trajectory/trajectory.hpp"

namespace nscdd::app {
namespace {

ResultColumns<FrictionSolution> check_columns() {
  const ResultColumns<FrictionState> of_state{
      {"residual", "1", "natural map with rho = 1/W_nn of each contact, relative to max(|r|, |r^1|)",
       &FrictionState::residual},
      {"siconos_residual", "1",
       "natural map with rho = 1, relative to the largest of |r|, |u| and |q|, absolute where that is at most 2.2e-16, "
       "as in Siconos",
       &FrictionState::siconos_residual},
      {"open", "1", "contacts without an impulse", &FrictionState::open},
      {"stick", "1", "contacts with an impulse inside the cone of friction", &FrictionState::stick},
      {"slide", "1", "contacts with an impulse on the edge of the cone", &FrictionState::slide},
      {"driven_residual", "1", "the natural map of `residual` relative to what drives the contacts, max(|r^1|, p)",
       &FrictionState::driven_residual}};
  const ResultColumns<FrictionStep> of_step{
      {"proximal_weight", "1", "alpha of Newton's steps, rho of admm, over W_nn of each contact; nan for other steps",
       &FrictionStep::proximal_weight},
      {"step_length", "1",
       "part of Newton's step that was taken, length in log t along a curve; nan where steps have no length",
       &FrictionStep::length}};
  return joined<FrictionSolution>(
      {{{"sweeps", "1", "Gauss-Seidel sweeps done, or iterations of admm", &FrictionSolution::sweeps}},
       columns_of(&FrictionSolution::state, of_state),
       {{"factorisations", "1", "sparse matrices factorised", &FrictionSolution::factorisations},
        {"status_changes", "1", "contacts that open, stick or slide otherwise than at the check before",
         &FrictionSolution::status_changes}},
       columns_of(&FrictionSolution::step, of_step)});
}

Vector starting_impulses(const FclibFile& file, const SolveOptions& options) {
  if (options.guess == 0) return {};
  if (options.guess < 0 || options.guess > count(file.guesses))
    fail("--guess: expected one of the {} guesses of {}, or 0 for none, met {}", file.guesses.size(), options.file,
         options.guess);
  return file.guesses[at(options.guess - 1)].r;
}

void print_problem(const FclibFile& file, const LocalFrictionProblem& local) {
  const char* space = local.dimension == 3 ? ", in space" : "";
  if (file.info.title) fmt::print("title                {}\n", printable(*file.info.title));
  if (const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem))
    fmt::print("problem              global, {} velocities of bodies{}\n", global->mass.rows(), space);
  else
    fmt::print("problem              local{}\n", space);
  fmt::print("contacts             {}\n", local.contacts());
  if (local.contacts() > 0)
    fmt::print("friction             {} ... {}\n", field_text(local.friction.minCoeff()),
               field_text(local.friction.maxCoeff()));
  fmt::print("entries of W         {}\n", local.w.nonZeros());
}

void print_solution(const FrictionSolution& solution, bool impossible, double tolerance, double duration) {
  const FrictionState& state = solution.state;
  fmt::print("status               {}\n", impossible ? "impossible" : to_string(solution.status));
  fmt::print("sweeps               {}\nfactorisations       {}\n", solution.sweeps, solution.factorisations);
  fmt::print("residual             {:.3e} (natural map, rho = 1/W_nn, relative to the impulses; tolerance {})\n",
             state.residual, field_text(tolerance));
  fmt::print("  over what drives   {:.3e} (the same natural map, relative to max(|r^1|, p), before impulses act)\n",
             state.driven_residual);
  fmt::print(
      "residual of Siconos  {:.3e} (natural map, rho = 1, {})\n", state.siconos_residual,
      state.siconos_relative ? "relative to the largest of r, u and q" : "absolute: r, u and q are at most 2.2e-16");
  fmt::print("open contacts        {}\nsticking contacts    {}\nsliding contacts     {}\nseconds              {:.3g}\n",
             state.open, state.stick, state.slide, duration);
}

// A relative residual may be small because impulses grow without bound, as they do if there is no solution.
void print_doubt(const FrictionSolution& solution) {
  if (solution.credible || solution.status != FrictionStatus::converged) return;
  note(
      "the residual is small only relative to the impulses, which are large relative to what drives the contacts; "
      "relative to the latter it is {:.3g}. If there is no solution, impulses grow without bound: --verdict decides",
      solution.state.driven_residual);
}

std::string first_of(const std::vector<Index>& numbers) {
  constexpr std::ptrdiff_t most = 8;
  const auto end = numbers.begin() + std::min(most, std::ssize(numbers));
  return fmt::format("{}{}", fmt::join(numbers.begin(), end, ", "), end == numbers.end() ? "" : ", ...");
}

void print_verdict(const Verdict& verdict) {
  fmt::print("verdict              {}", to_string(verdict.kind));
  if (std::isinf(verdict.margin)) return fmt::print(": there are no contacts\n");
  if (verdict.kind == VerdictKind::exists)
    fmt::print(": proved, bodies at {:.3g} m/s open every contact by the margin", verdict.speed);
  if (verdict.kind == VerdictKind::impossible)
    fmt::print(": {} contacts close at {:.6g} m/s, proved for changes of velocity below {:.2g} m/s",
               verdict.chain.size(), verdict.closing_speed, verdict.proven_speed);
  fmt::print("\n  largest margin     {:.7g} m/s", verdict.margin);
  if (verdict.kind != VerdictKind::exists) fmt::print(", without friction {:.7g} m/s", verdict.normal_margin);
  fmt::print("\n  its work           {} factorisations, {:.3g} s\n", verdict.factorisations, verdict.seconds);
}

// Contacts of the chain and, if H has three rows per body in the plane, or six in space, the bodies that they touch.
void note_chain(const LocalFrictionProblem& problem, const Verdict& verdict) {
  const Index rows = problem.dimension == 2 ? 3 : 6;
  std::vector<Index> bodies;
  if (problem.h.rows() % rows == 0 && problem.h.cols() > 0)
    for (const Index c : verdict.chain)
      for (SparseMatrix::InnerIterator e(problem.h, problem.dimension * c); e; ++e)
        if (e.value() != 0) bodies.push_back(e.row() / rows);
  sort_unique(bodies);
  note("no impulses are a solution: contacts {}{} close at {:.6g} m/s", first_of(verdict.chain),
       bodies.empty() ? "" : fmt::format(", of bodies {},", first_of(bodies)), verdict.closing_speed);
}

// The contacts that keep a run from converging, by their numbers in the file, from 0.
void print_trouble(const LocalFrictionProblem& problem, const FrictionSolution& solution) {
  if (solution.status == FrictionStatus::converged) return;
  constexpr double share = 0.9;
  const std::vector<Index> carriers = contacts_with_residual(problem, solution, share);
  if (!carriers.empty())
    fmt::print("largest residuals    contacts {} ({} of them hold {:.0f} % of its square)\n", first_of(carriers),
               carriers.size(), 100 * share);
  const std::vector<Index>& unsettled = solution.unsettled;
  fmt::print("unsettled statuses   {}{} of contacts in the last 10 checks\n", unsettled.size(),
             unsettled.empty() ? "" : " (" + first_of(unsettled) + ")");
}

// Impulses that did not converge are written as a guess.
void write_result(const FclibFile& file, const FrictionSolution& solution, const SolveOptions& options,
                  const Context& context, OutputFile& output) {
  if (has_siconos_name(options.output)) {
    note("{}: a file of Siconos holds only the problem; its solution goes into .h5 or .hdf5", options.output);
    output.bytes(siconos_text(file, "nscdd " + version()));
    return output.finish();
  }
  const FclibFile written = with_result(file, solution);
  if (solution.status == FrictionStatus::not_finite)
    note("{}: the impulses are not finite and are left out", options.output);
  else if (solution.status != FrictionStatus::converged)
    note("{}: not converged: the impulses are written as guess {}, not as the solution", options.output,
         written.guesses.size());
  output.bytes(to_hdf5(written, provenance(context, {})));
  output.finish();
}

void check_options(const SolveOptions& options) {
  std::error_code ignored;
  if (std::filesystem::is_directory(options.file, ignored) && !holds_datbox(options.file))
    fail("{}: expected a file, or a folder together with --csv, met a folder without --csv", options.file);
  if (options.algorithms.size() > 1 || options.algorithms == std::vector<std::string>{"all"})
    fail("--solver: expected one, or several with --csv, met {}", fmt::join(options.algorithms, ", "));
  if (options.convergence == "-") fail("--convergence: expected a file name, met -; standard output is for the report");
  if (!options.output.empty() && !has_siconos_name(options.output)) require_ending(options.output, hdf5_endings);
  const auto record = record_at(options.file);
  require_no_input({options.convergence, options.output}, {record ? record->file : options.file});
  require_distinct({options.convergence, options.output});
}

int run_solve(const SolveOptions& options, const Context& context) {
  const ThreadLimit limit = options.limits.limit_threads(context.machine);
  if (!options.csv.empty()) return solve_trials(options, context.machine);
  check_options(options);
  FrictionSolverOptions solver = options.solver;
  if (!options.algorithms.empty()) solver.algorithm = options.algorithms.front();
  if (holds_trajectory(options.file))
    fail("{0}: expected a contact problem, met a trajectory: nscdd export {0} --fclib STEP writes that of a step",
         options.file);
  const FclibFile file = read_contact_problem(options.file);
  const LocalFrictionProblem local = local_problem(file, options.file);
  require_moderate(local, options.file);
  const Vector guess = starting_impulses(file, options);
  // Outputs are opened before the work and named after it: a run that fails leaves none.
  const ResultColumns<FrictionSolution> columns = check_columns();
  std::optional<CsvWriter> csv;
  if (!options.convergence.empty()) csv.emplace(options.convergence, options.how.force, headings(columns));
  std::optional<OutputFile> output;
  if (!options.output.empty()) output.emplace(options.output, options.how.force);
  Interruption interruption;
  const double started = seconds();
  const FrictionSolution solution =
      solve_friction(local, solver, guess, [&, monitor = interruption.watch("solve")](const FrictionSolution& check) {
        if (csv) csv->write(row(columns, check));
        return report(monitor, check.sweeps, solver.maximum_sweeps);
      });
  const double duration = seconds() - started;
  const bool converged = solution.status == FrictionStatus::converged;
  std::optional<Verdict> verdict;
  if (solution.status != FrictionStatus::stopped && (options.verdict || !converged))
    verdict = verdict_of(local, interruption.watch("verdict", 0, "factorisation"));
  if (solution.status == FrictionStatus::stopped || (verdict && interruption.stopped())) {
    if (csv) csv->leave();
    const int code =
        interrupted("interrupted after {} sweeps, residual {:.3e}", solution.sweeps, solution.state.residual);
    if (output) write_result(file, solution, options, context, *output);
    return code;
  }
  if (csv) csv->finish();
  const bool impossible = verdict && proves_impossible(*verdict, converged, solution.state.driven_residual);
  print_problem(file, local);
  print_solution(solution, impossible, solver.tolerance, duration);
  const double distance = guess.size() > 0 ? (solution.impulses - guess).norm() / guess.norm() : infinity;
  if (std::isfinite(distance)) fmt::print("distance from guess  {:.3e} (|r - r_guess| / |r_guess|)\n", distance);
  print_trouble(local, solution);
  if (verdict)
    print_verdict(*verdict);
  else
    print_doubt(solution);
  if (impossible) note_chain(local, *verdict);
  if (output) write_result(file, solution, options, context, *output);
  return converged && !impossible ? 0 : 1;
}

}  // namespace

Action declare_solve(Command& command) {
  auto options = std::make_shared<SolveOptions>();
  command.required("FILE", options->file,
                   "contact problem with friction, in the plane or in space, HDF5 of FCLIB, .dat of Siconos, "
                   "Vloc_Rloc.INI or lmgc90.h5:ID_3 of LMGC90; with --csv also a folder of them");
  command.fields(options->solver);
  Option& solver = command.named("--solver");
  solver.help += "; with --csv it may be named again, and all stands for every one";
  solver.words.emplace_back("all");
  solver.list = true;
  solver.set = [options](std::string_view text, std::string_view) { options->algorithms.emplace_back(text); };
  options->limits.declare_threads(command);
  const Option* csv = &command.add("--csv FILE", options->csv,
                                   "write a table there, a row per problem and solver, - for standard output");
  command
      .add("--time-limit SECONDS", options->time_limit, "of --csv: end a run at its first check after so long",
           {.above = 0, .also = infinity})
      .needs = csv;
  command.add("--verdict", options->verdict,
              "also decide, with proof, whether a solution exists; without it only where the solver fails");
  Option* const alone[] = {
      &command.preset("--guess", options->guess, "start from that guess of the file, 1 the first, or 0 from zero"),
      &command.add("--convergence FILE", options->convergence,
                   "write one row per residual there, as CSV, each when it is known"),
      &command.add(
          "-o,--output FILE", options->output,
          "write the problem with its solution there, HDF5 of FCLIB, a guess where not converged; or FILE.dat of "
          "Siconos, only the problem")};
  for (Option* one : alone) one->excludes = csv;
  declare_reopening(command, options->how);
  command.named("--resume").needs = csv;
  command.footer =
      R"(Exit code 0: converged, 1: not (the status says why). With --csv 0: all problems were read, 1: some were not.
Examples:
  nscdd solve problem.hdf5
  nscdd solve problem.hdf5 --tolerance 1e-10 --convergence sweeps.csv -o solved.hdf5
  nscdd solve problems --solver all --time-limit 20 --csv table.csv      a folder of problems)";
  return [options](const Context& context) { return run_solve(*options, context); };
}

}  // namespace nscdd::app
