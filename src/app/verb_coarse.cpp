// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "study/linear/coarse.hpp"
#include "study/linear/inspection.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {
namespace {

struct CoarseOptions {
  CaseOptions one;
  StudyTable work{.name = "coarse", .observable = &observables::coarse_space};
  std::string epsilon = "1e-6W,1e-4W,1e-2W", preconditioner, scaling, space, csv;
  Reopening how;
  Limits limits;
};

void print_case(const CoarseResult& result) {
  fmt::print("case                  {}\nsubdomains            {}\n", result.of_case.name, result.of_case.subdomains);
  fmt::print("interface unknowns    {} ({} velocities of shared grains)\n", result.of_case.interface_size,
             result.primal_size);
  fmt::print("  rank of X_0         {}{}\n", result.rank, result.clear_ranks ? "" : " (in doubt)");
  fmt::print("  self-stresses       {} across the interface\n", result.self_stresses);
  fmt::print("cross points          {}\n", result.cross_points);
  for (const auto& [name, work] : {std::pair{"local factors", result.local}, {"undivided factor", result.undivided}})
    fmt::print("{:<22}{:.3g} entries, {:.3g} flops\n", name, work.entries, work.flops);
}

void print_heading() {
  fmt::print("\n{:<11}{:<16}{:<14}{:<8}{:>6}{:>11}{:>10}{:>8}{:>8}{:>7}{:>7}{:>7}\n", "epsilon/W", "preconditioner",
             "scaling", "coarse", "modes", "kappa", "bound", "CG", "k<=30", "any", "k<=100", "any");
}

void print_row(const CoarseResult& result) {
  const auto number = [](double value) { return std::isnan(value) ? "-" : fmt::format("{:.4g}", value); };
  const CoarseMethod& method = result.method;
  fmt::print("{:<11.4g}{:<16}{:<14}{:<8}{:>6}{:>11}{:>10}{:>8}{:>8}{:>7}{:>7}{:>7}{}\n", result.epsilon / result.scale,
             to_string(*method.preconditioner), method.scaling ? to_string(*method.scaling) : "-",
             to_string(method.space), result.modes, number(result.kappa()), number(result.bound), result.iterations,
             number(result.fewest[0]), number(result.any[0]), number(result.fewest[1]), number(result.any[1]),
             result.converged ? result.certified ? "" : "  not certified" : "  not converged");
  if (!std::isnan(result.seconds))
    fmt::print("{:<11}{:.3g} s for the preconditioner, {:.3g} s for the iterations\n", "", result.setup_seconds,
               result.seconds);
}

StudyTable table_of(const CoarseOptions& options, const Machine& machine) {
  StudyTable work = options.work;
  std::tie(work.sweep.epsilon, work.sweep.relative_epsilon) = parse_epsilon(options.epsilon);
  const auto names = [](const std::string& spec, const char* option, auto& all) {
    if (!spec.empty()) all = parse_names<typename std::decay_t<decltype(all)>::value_type>(spec, option);
  };
  names(options.preconditioner, "--preconditioner", work.coarse.preconditioners);
  names(options.scaling, "--scaling", work.coarse.scalings);
  names(options.space, "--coarse-space", work.coarse.spaces);
  work.coarse.bddc = machine.bddc;
  check_coarse(work.coarse, true);
  work.sweep.spectral.inertia = machine.inertia;
  work.cases = {options.one.resolve({options.csv})};
  return work;
}

int run_coarse(const CoarseOptions& options, const Context& context) {
  const Machine& machine = context.machine;
  options.limits.limit_memory(machine.processes_here);
  if (options.work.coarse.counts) require_one_process(machine, "--counts");
  const StudyTable work = in_turn(machine.processes, [&] { return table_of(options, machine); });
  if (nothing_to_resume(options.csv, "", table_work(work), options.how, machine)) return 0;
  const ThreadLimit limit = options.limits.limit_threads(machine);
  const Model model = shared_model(work.cases.front(), machine, work.sweep.contacts);
  if (model.parts.interface_size() == 0)
    fail("{}: expected subdomains that share grains, met an empty interface ({}); --subdomains cuts the packing",
         model.name, why_empty(model));
  if (options.csv.empty()) {
    Index rows = 0;
    const Index failed = coarse_spaces(model, work.sweep, work.coarse, [&](const CoarseResult& result) {
      if (rows++ == 0) print_case(result);
      if (work.coarse.counts) return;
      if (rows == 1) print_heading();
      print_row(result);
    });
    if (failed > 0) note("{} row(s) did not converge", failed);
    return 0;
  }
  Interruption interruption(machine.processes);
  SharedTable csv(machine, options.csv, table_work(work), options.how);
  const ResultColumns<CoarseResult> columns = coarse_columns(work.sweep.relative_epsilon);
  const Index failed = coarse_spaces(
      model, work.sweep, work.coarse, [&](const CoarseResult& result) { csv->write(row(columns, result)); },
      interruption.watch(work.name, csv.kept()), csv.kept());
  if (interruption.stopped()) return leave(*csv, options.csv);
  csv->finish();
  csv.forget();
  if (failed > 0) note("{} row(s) did not converge: see the column 'converged'", failed);
  return 0;
}

}  // namespace

Action declare_coarse(Command& command) {
  auto options = std::make_shared<CoarseOptions>();
  CoarseParameters& coarse = options->work.coarse;
  options->one.declare(command);
  command.preset("--epsilon SPEC", options->epsilon,
                 "flexibility of the law, 1/kg, or times the mean of W_nn (0.1W); above 0");
  declare_contacts(command, options->work.sweep.contacts);
  command.add("--preconditioner LIST", options->preconditioner,
              "X, X_eta, X_eta_active, lumped, dirichlet [dirichlet], and bddc by nscdd-mpi; X_eta: eta = 10 epsilon, "
              "on all contacts or on those of X_epsilon");
  command.add("--scaling LIST", options->scaling,
              "weights of shared grains: multiplicity, stiffness, deluxe [multiplicity,deluxe]; with lumped, dirichlet "
              "and bddc");
  command.add("--coarse-space LIST", options->space,
              "none, rigid, geneo [none,geneo]; with dirichlet, and without rigid with bddc");
  command.add("--kappa NUMBER", coarse.kappa,
              "condition number that geneo shall keep [30]; its threshold is N_n / kappa, N_n the most subdomains that "
              "share grains with one, itself included");
  command.add("--threshold NUMBER", coarse.threshold, "threshold of geneo, in place of that of --kappa");
  command.add("--counts", coarse.counts, "ranks and counts only, without spectra");
  command.add("--csv FILE", options->csv, "write a table instead of the report, - for standard output");
  declare_reopening(command, options->how);
  options->limits.declare(command);
  command.footer =
      R"(How many vectors a coarse space needs, and what it gains: condition numbers, iterations and the size of
factors for local preconditioners of the interface problem X_epsilon F = g.
Examples:
  nscdd coarse deposit --subdomains 4x4
  nscdd coarse hexagonal --subdomains 4x4 --coarse-space none,rigid,geneo --epsilon 1e-8W
  nscdd coarse deposit --set packing.grains=100000 --subdomains 8x8 --counts)";
  return [options](const Context& context) { return run_coarse(*options, context); };
}

}  // namespace nscdd::app
