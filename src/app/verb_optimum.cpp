// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "study/linear/inspection.hpp"
#include "study/linear/optimum.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {
namespace {

struct OptimumOptions {
  CaseOptions one;
  StudyTable work{.name = "optimum", .observable = &observables::optimum, .sweep = {.contacts = ContactSet::active}};
  std::string epsilon = "0", csv;
  Reopening how;
  Limits limits;
};

// One quantity per line.
void print_report(const OptimumResult& result, DecompositionScheme scheme) {
  for (const auto& [heading, value] : optimum_columns({.relative_epsilon = true, .scheme = scheme})) {
    const std::string unit = heading.unit == "1" || heading.unit.empty() ? "" : " " + heading.unit;
    fmt::print("{:<26}{:<29} {}\n", heading.name, to_text(value(result)) + unit, heading.description);
  }
}

StudyTable table_of(const OptimumOptions& options, const Machine& machine) {
  StudyTable work = options.work;
  std::tie(work.sweep.epsilon, work.sweep.relative_epsilon) = parse_epsilon(options.epsilon);
  work.sweep.spectral = spectra_on(machine, work.sweep.spectral);
  check_sweep(work.sweep, "--");
  work.cases = {options.one.resolve({options.csv})};
  return work;
}

int run_optimum(const OptimumOptions& options, const Context& context) {
  const Machine& machine = context.machine;
  options.limits.limit_memory(machine.processes_here);
  const StudyTable work = in_turn(machine.processes, [&] { return table_of(options, machine); });
  if (nothing_to_resume(options.csv, "", table_work(work), options.how, machine)) return 0;
  const ThreadLimit limit = options.limits.limit_threads(machine);  // packings are settled with all threads
  const Model model = shared_model(work.cases.front(), machine, work.sweep.contacts);
  if (model.parts.interface_size() == 0)
    note("{}: the interface is empty ({}): there is nothing to optimise", model.name, why_empty(model));
  const auto tell = [](const OptimumResult& result) {
    if (!result.best.failure.empty()) note("epsilon = {}: not converged: {}", result.epsilon, result.best.failure);
  };
  if (options.csv.empty()) {
    Index reports = 0;
    optima(model, select(model, work.sweep.contacts), work.sweep, [&](const OptimumResult& result) {
      if (reports++ > 0) fmt::print("\n");
      print_report(result, work.sweep.scheme);
      tell(result);
    });
    return 0;
  }
  Interruption interruption(machine.processes);
  SharedTable csv(machine, options.csv, table_work(work), options.how);
  const ResultColumns<OptimumResult> columns = optimum_columns(work.sweep);
  const auto write = [&](const OptimumResult& result) {
    tell(result);
    csv->write(row(columns, result));
  };
  const Index failed = optima(model, select(model, work.sweep.contacts), work.sweep, write,
                              interruption.watch(work.name, csv.kept()), csv.kept());
  if (interruption.stopped()) return leave(*csv, options.csv);
  csv->finish();
  csv.forget();
  if (failed > 0) note("{} row(s) did not converge: see the column 'status'", failed);
  return 0;
}

}  // namespace

Action declare_optimum(Command& command) {
  auto options = std::make_shared<OptimumOptions>();
  options->one.declare(command);
  command.preset("--epsilon SPEC", options->epsilon,
                 "flexibility of the law, 1/kg, or times the mean of W_nn (0.1W); 0 is the rigid limit");
  declare_contacts(command, options->work.sweep.contacts);
  declare_scheme(command, options->work.sweep.scheme);
  command.fields(options->work.sweep.spectral, {"certify", "eigenvalues"});
  command.add("--csv FILE", options->csv, "write a table instead of the report, - for standard output");
  declare_reopening(command, options->how);
  options->limits.declare(command);
  command.footer =
      R"(The eta of the smallest radius of the enriched algorithm, from which eta on it converges, from which on it
beats the generic algorithm, and the same with the best relaxation. With schwarz the best relaxation.
Examples:
  nscdd optimum disks8                        the nonsmooth case, active contacts
  nscdd optimum disks8 --epsilon 0,1 --contacts all --csv -)";
  return [options](const Context& context) { return run_optimum(*options, context); };
}

}  // namespace nscdd::app
