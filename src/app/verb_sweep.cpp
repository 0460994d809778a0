// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/interruption.hpp"
#include "app/memory_limit.hpp"
#include "app/progress.hpp"
#include "app/provenance.hpp"
#include "app/repair_table.hpp"
#include "app/resume.hpp"
#include "app/sweep_options.hpp"
#include "app/verbs.hpp"
#include "files/hdf5.hpp"
#include "files/output_file.hpp"
#include "linalg/threads.hpp"
#include "study/inspection.hpp"
#include "study/values.hpp"
#include "study/work_identity.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/study/sweep.hpp>

#include <fmt/format.h>

#include <memory>
#include <optional>

namespace nscdd::app {
namespace {

struct Options {
  CaseOptions one;
  SpectralCommandOptions spectral;
  std::string epsilon, eta = "inf", relaxation = "1", sweeps = "inf", csv, hdf5;
  bool force = false, resume = false, redo = false;
  Index threads = 0;
  MemoryLimit memory;
  Context context;
};

SweepParameters parameters(const Options& options) {
  SweepParameters result;
  set_epsilon(result, parse_epsilon(options.epsilon));
  set_eta(result, parse_eta(options.eta));
  result.relaxation = parse_relaxation(options.relaxation);
  result.gauss_seidel_sweeps = parse_sweeps(options.sweeps);
  result.contacts = options.spectral.contact_set();
  result.spectral = options.spectral.spectral();
  if (result.spectral.certify || result.spectral.eigenvalues > 1)
    for (const auto& sweeps : result.gauss_seidel_sweeps)
      if (sweeps)
        throw Error(
            fmt::format("--gauss-seidel-sweeps: expected inf with --certify or --eigenvalues (an inexact "
                        "Stage 1 has no symmetric pencil), met {}",
                        *sweeps));
  return result;
}

struct Unproved {
  Index all = 0, rigid = 0;
};

// Why rows of the rigid limit may stay without proof, and what to do.
void explain(const Unproved& rows) {
  if (rows.all > 0) note(fmt::format("{} row(s) did not converge: see the column 'converged'", rows.all));
  if (rows.rigid > 0)
    note(
        fmt::format("{} of them in the rigid limit (epsilon = 0), by shift-invert: no end of the spectrum "
                    "was proved; try "
                    "--solver dense, or a small epsilon > 0 in place of 0",
                    rows.rigid));
}

// The rows of the sweep, those found included; `sink` takes them all.
Unproved work_through(const Model& model, const StudyTable& work, ResumableTable& csv, Interruption& interruption,
                      const RowSink& sink) {
  Unproved unproved;
  const auto judge = [&](const SweepPoint& point, bool converged, std::string_view solver) {
    unproved.all += !converged;
    unproved.rigid += !converged && point.epsilon == 0 && solver == "shift-invert";
  };
  const ResultColumns<SweepResult> columns = sweep_columns(work.sweep);
  const Table layout{headings(columns), {}};
  Index number = 0;
  csv.replay([&](const Row& cells) {  // of the file
    judge(sweep_point(work.sweep, number++), std::get<bool>(cells[layout.column("converged")]),
          std::get<std::string>(cells[layout.column("solver")]));
    sink(cells);
  });
  Progress progress(work.name, csv.kept());
  const auto write = [&](const SweepResult& result) {
    const SpectralRadius& radius = result.radius;
    if (work.sweep.spectral.certify && radius.converged && !radius.certified)
      note("a row converged but is not certified: see the column 'certified'; --redo tries again");
    judge(result.point, radius.converged, radius.solver);
    const Row cells = row(columns, result);
    csv.write(cells);
    sink(cells);
  };
  sweep(model, work.sweep, write, interruption.watch(progress.monitor()), csv.kept());
  return unproved;
}

int run(const Options& options) {
  const Reopening how{options.resume, options.force};
  StudyTable work;
  work.name = "sweep";
  work.sweep = parameters(options);
  work.cases = {options.one.resolve({options.csv, options.hdf5})};
  if (!options.hdf5.empty()) require_distinct(options.csv, options.hdf5);
  if (options.redo && (is_stream(options.csv) || !options.hdf5.empty() || options.resume))
    throw Error("--redo: expected a finished table in a file with --csv, without --hdf5 and --resume");
  if (!options.redo && nothing_to_resume(options.csv, options.hdf5, how)) return 0;
  const ThreadLimit limit(options.threads);
  const Model model = build(work.cases.front());
  if (model.parts.interface_size() == 0)
    note(fmt::format("{}: the interface is empty ({}): nothing to contract, radius 0", model.name, why_empty(model)));
  options.memory.require({estimated_bytes(model, work.sweep), model.name, model.parts.interface_size()});
  if (options.redo) {
    Interruption interruption;
    LeadIn unused;
    return explain(repair_table(work, options.csv, interruption, unused), options.csv);
  }
  Table table{headings(sweep_columns(work.sweep)), {}};
  Interruption interruption;  // from here on there is something to be left in good order
  // Both are opened before the work and named after it: a run that fails leaves neither.
  ResumableTable csv(options.csv, table_work(work), how);
  std::optional<OutputFile> hdf5;
  if (!options.hdf5.empty()) hdf5.emplace(options.hdf5, options.force, leftover(options.resume));
  const Unproved unproved = work_through(model, work, csv, interruption, [&](const Row& row) {
    if (hdf5) table.rows.push_back(row);
  });
  if (interruption.stopped()) return leave(csv, options.csv);
  if (hdf5) hdf5->bytes(to_hdf5(provenance(options.context, work.cases), {{"sweep", table}}));
  csv.finish();
  if (hdf5) hdf5->finish();
  remove_record(options.csv);
  explain(unproved);
  return 0;
}

}  // namespace

std::function<int()> declare_sweep(Command& command, const Context& context) {
  auto options = std::make_shared<Options>();
  options->context = context;
  options->one.declare(command);
  command
      .add_option("--epsilon", options->epsilon,
                  "SPEC of the flexibility of the linear law, 1/kg, or times the mean of W_nn (0.1W); 0 is the "
                  "rigid limit")
      ->required();
  command
      .add_option("--eta", options->eta,
                  "SPEC of the flexibility Stage 2 sees, 1/kg, or times the mean of W_nn (10W); inf is the "
                  "generic algorithm")
      ->shows_default();
  options->spectral.declare(command, "all");
  options->spectral.declare_ends(command);
  declare_threads(command, options->threads);
  command.add_option("--relaxation", options->relaxation, "SPEC of omega in F <- F + omega (F' - F), or 'optimal'")
      ->shows_default();
  command.add_option("--gauss-seidel-sweeps", options->sweeps, "SPEC of the sweeps n_GS of Stage 1; inf is exact")
      ->shows_default();
  command.add_option("--csv", options->csv, "where the table goes, - for standard output")->required();
  command.add_option("--hdf5", options->hdf5, "also write the table, with its provenance, as HDF5");
  declare_redo(command, options->redo);
  command.add_flag("--force", options->force, "replace existing outputs");
  declare_resume(command, options->resume);
  options->memory.declare(command);
  command.footer(
      "SPEC is a number, a comma list, or FROM:TO:COUNT (logarithmic; FROM:TO:COUNT:linear).\n"
      "One row per (epsilon, eta, relaxation, sweeps); columns are described in docs/formats.md.\n"
      "Examples:\n"
      "  nscdd sweep disks4 --epsilon 0,1 --csv -                            rho(B_0), rho(B_1)\n"
      "  nscdd sweep disks12 --epsilon 1e-3:1e3:121 --csv figure5.csv        a curve of Figure 5\n"
      "  nscdd sweep disks8 --epsilon 1 --eta 1e-2:1e2:81 --csv -            rho(B_eps,eta)\n"
      "  nscdd sweep disks8 --epsilon 0 --eta 0.1,inf --contacts active --csv -   the nonsmooth B-bar\n"
      "  nscdd sweep mine.csv --subdomains 3x2 --epsilon 1e-3,1 --eta 0.3,inf --csv -   your own packing");
  return [options] { return run(*options); };
}

}  // namespace nscdd::app
