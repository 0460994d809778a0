// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/interruption.hpp"
#include "app/memory_limit.hpp"
#include "app/progress.hpp"
#include "app/repair_table.hpp"
#include "app/resume.hpp"
#include "app/sweep_options.hpp"
#include "app/verbs.hpp"
#include "linalg/threads.hpp"
#include "study/inspection.hpp"
#include "study/optimum.hpp"
#include "study/values.hpp"
#include "study/work_identity.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <memory>

namespace nscdd::app {
namespace {

struct Options {
  Index threads = 0;
  CaseOptions one;
  SpectralCommandOptions spectral;
  std::string epsilon = "0", csv;
  bool force = false, resume = false, redo = false;
  MemoryLimit memory;
};

// The result as text for a reader: one quantity per line.
void print_report(const OptimumResult& result) {
  for (const auto& [heading, value] : optimum_columns(true)) {
    const std::string unit = heading.unit == "1" || heading.unit.empty() ? "" : " " + heading.unit;
    fmt::print("{:<26}{:<30}{}\n", heading.name, to_text(value(result)) + unit, heading.description);
  }
}

StudyTable table_of(const Options& options) {
  StudyTable work;
  work.name = "optimum";
  work.observable = &observables::optimum;
  set_epsilon(work.sweep, parse_epsilon(options.epsilon));
  work.sweep.contacts = options.spectral.contact_set();
  work.sweep.spectral = options.spectral.spectral();
  work.cases = {options.one.resolve({options.csv})};
  return work;
}

void report_all(const StudyTable& work, const Model& model) {
  bool first = true;
  optima(model, work.sweep, [&](const OptimumResult& result) {
    if (!first) fmt::print("\n");
    print_report(result);
    first = false;
  });
}

int run(const Options& options) {
  const Reopening how{options.resume, options.force};
  const StudyTable work = table_of(options);
  if (options.csv.empty() && options.resume) throw Error("--resume: expected --csv FILE with it, met none");
  if (options.redo && (options.csv.empty() || is_stream(options.csv) || options.resume))
    throw Error("--redo: expected a finished table in a file with --csv, without --resume");
  if (!options.redo && nothing_to_resume(options.csv, "", how)) return 0;
  const ThreadLimit limit(options.threads);
  const Model model = build(work.cases.front());
  if (model.parts.interface_size() == 0)
    note(fmt::format("{}: the interface is empty ({}): there is nothing to optimise", model.name, why_empty(model)));
  options.memory.require({estimated_bytes(model, work.sweep), model.name, model.parts.interface_size()});
  if (options.csv.empty()) {
    report_all(work, model);
    return 0;
  }
  Interruption interruption;
  if (options.redo) {
    LeadIn unused;
    return explain(repair_table(work, options.csv, interruption, unused), options.csv);
  }
  ResumableTable csv(options.csv, table_work(work), how);
  Index failed = 0;
  {
    Progress progress(work.name, csv.kept());
    const RowSink write = [&](const Row& cells) { csv.write(cells); };
    failed = optima(model, work.sweep, as_rows(optimum_columns(work.sweep.relative_epsilon), write),
                    interruption.watch(progress.monitor()), csv.kept());
  }
  if (interruption.stopped()) return leave(csv, options.csv);
  csv.finish();
  remove_record(options.csv);
  if (failed > 0) note(fmt::format("{} row(s) did not converge: see the column 'status'", failed));
  return 0;
}

}  // namespace

std::function<int()> declare_optimum(Command& command, const Context&) {
  auto options = std::make_shared<Options>();
  options->one.declare(command);
  command
      .add_option("--epsilon", options->epsilon,
                  "SPEC of the flexibility of the law, 1/kg, or times the mean of W_nn (0.1W); 0 is the rigid "
                  "limit")
      ->shows_default();
  options->spectral.declare(command, "active");
  command.add_option("--csv", options->csv, "write a table instead of the report, - for standard output");
  command.add_flag("--force", options->force, "replace existing outputs");
  declare_resume(command, options->resume);
  declare_redo(command, options->redo);
  declare_threads(command, options->threads);
  options->memory.declare(command);
  command.footer(
      "The eta of the smallest radius of the enriched algorithm, from which eta on it converges, from which "
      "on it\n"
      "beats the generic algorithm, and the same with the best relaxation.\n"
      "Examples:\n"
      "  nscdd optimum disks8                        the nonsmooth case, active contacts\n"
      "  nscdd optimum disks8 --epsilon 0,1 --contacts all --csv -");
  return [options] { return run(*options); };
}

}  // namespace nscdd::app
