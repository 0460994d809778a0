// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cases.hpp"
#include "app/tables.hpp"
#include "app/work_options.hpp"
#include "files/hdf5.hpp"
#include "linalg/threads.hpp"
#include "study/study.hpp"
#include "study/values.hpp"

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
        refuse(
            "--gauss-seidel-sweeps: expected inf with --certify or --eigenvalues (an inexact Stage 1 has no symmetric "
            "pencil), met {}",
            *sweeps);
  return result;
}

// Rows that did not converge, and those of them in the rigid limit by shift-invert.
struct Unproved {
  Index all = 0, rigid = 0;
};

// Why rows of the rigid limit may stay without proof, and what to do.
void explain(const Unproved& rows) {
  if (rows.all > 0) note("{} row(s) did not converge: see the column 'converged'", rows.all);
  if (rows.rigid > 0)
    note(
        "{} of them in the rigid limit (epsilon = 0), by shift-invert: no end of the spectrum was proved; try --solver "
        "dense, or a small epsilon > 0 in place of 0",
        rows.rigid);
}

// The rows of the sweep, those found included; `sink` takes them all.
Unproved work_through(const Model& model, const StudyTable& work, ResumableTable& csv, Interruption& interruption,
                      const RowSink& sink) {
  const ResultColumns<SweepResult> columns = sweep_columns(work.sweep);
  const Table layout{headings(columns), {}};
  Unproved unproved;
  Index number = 0;
  const auto take = [&, converged = layout.column("converged"), solver = layout.column("solver")](const Row& cells) {
    const bool open = !std::get<bool>(cells[converged]), rigid = sweep_point(work.sweep, number++).epsilon == 0;
    unproved.all += open;
    unproved.rigid += open && rigid && std::get<std::string>(cells[solver]) == "shift-invert";
    sink(cells);
  };
  csv.replay(take);
  Progress progress(work.name, csv.kept());
  const auto write = [&](const SweepResult& result) {
    if (work.sweep.spectral.certify && result.radius.converged && !result.radius.certified)
      note("a row converged but is not certified: see the column 'certified'; --redo tries again");
    const Row cells = row(columns, result);
    csv.write(cells);
    take(cells);
  };
  sweep(model, work.sweep, write, interruption.watch(progress.monitor()), csv.kept());
  return unproved;
}

int run(const Options& options, const Context& context) {
  const Reopening how{options.resume, options.force};
  StudyTable work;
  work.name = "sweep";
  work.sweep = parameters(options);
  work.cases = {options.one.resolve({options.csv, options.hdf5})};
  if (!options.hdf5.empty()) require_distinct(options.csv, options.hdf5);
  if (options.redo && (is_stream(options.csv) || !options.hdf5.empty() || options.resume))
    refuse("--redo: expected a finished table in a file with --csv, without --hdf5 and --resume");
  if (!options.redo && nothing_to_resume(options.csv, options.hdf5, how)) return 0;
  const ThreadLimit limit(options.threads);
  const Model model = build(work.cases.front());
  note_empty_interface(model, "nothing to contract, radius 0");
  options.memory.require(model, work.sweep);
  if (options.redo) return redo_table(work, options.csv);
  Interruption interruption;  // from here on there is something to be left in good order
  // Both are opened before the work and named after it: a run that fails leaves neither.
  ResumableTable csv(options.csv, table_work(work), how);
  std::optional<OutputFile> hdf5;
  if (!options.hdf5.empty()) hdf5.emplace(options.hdf5, options.force, kept_of_whole(options.resume));
  Table table{headings(sweep_columns(work.sweep)), {}};
  const Unproved unproved = work_through(model, work, csv, interruption, [&](const Row& row) {
    if (hdf5) table.rows.push_back(row);
  });
  if (interruption.stopped()) return leave(csv, options.csv);
  if (hdf5) hdf5->bytes(to_hdf5(provenance(context, work.cases), {{"sweep", table}}));
  csv.finish();
  if (hdf5) hdf5->finish();
  remove_record(options.csv);
  explain(unproved);
  return 0;
}

}  // namespace

Action declare_sweep(Command& command) {
  auto options = std::make_shared<Options>();
  options->one.declare(command);
  command.add_required(
      "--epsilon", options->epsilon,
      "SPEC of the flexibility of the linear law, 1/kg, or times the mean of W_nn (0.1W); 0 is the rigid limit");
  command.add_with_default(
      "--eta", options->eta,
      "SPEC of the flexibility Stage 2 sees, 1/kg, or times the mean of W_nn (10W); inf is the generic algorithm");
  options->spectral.declare(command, "all");
  command.add("--certify", options->spectral.options.certify,
              "prove by inertia counts that no eigenvalue was missed; adds columns with the intervals");
  command.add_with_default(
      "--eigenvalues", options->spectral.options.eigenvalues,
      "eigenvalues at each end; more than one adds columns: their values, and for each end the multiplicity of its "
      "first value alone (how many of those found agree with it within --residual-tolerance; with --certify how many "
      "lie in its interval)");
  declare_threads(command, options->threads);
  command.add_with_default("--relaxation", options->relaxation,
                           "SPEC of omega in F <- F + omega (F' - F), or 'optimal'");
  command.add_with_default("--gauss-seidel-sweeps", options->sweeps,
                           "SPEC of the sweeps n_GS of Stage 1; inf is exact");
  command.add_required("--csv", options->csv, "where the table goes, - for standard output");
  command.add("--hdf5", options->hdf5, "also write the table, with its provenance, as HDF5");
  declare_redo(command, options->redo);
  command.add("--force", options->force, "replace existing outputs");
  declare_resume(command, options->resume);
  options->memory.declare(command);
  command.footer = R"(SPEC is a number, a comma list, or FROM:TO:COUNT (logarithmic; FROM:TO:COUNT:linear).
One row per (epsilon, eta, relaxation, sweeps); columns are described in docs/formats.md.
Examples:
  nscdd sweep disks4 --epsilon 0,1 --csv -                            rho(B_0), rho(B_1)
  nscdd sweep disks12 --epsilon 1e-3:1e3:121 --csv figure5.csv        a curve of Figure 5
  nscdd sweep disks8 --epsilon 1 --eta 1e-2:1e2:81 --csv -            rho(B_eps,eta)
  nscdd sweep disks8 --epsilon 0 --eta 0.1,inf --contacts active --csv -   the nonsmooth B-bar
  nscdd sweep mine.csv --subdomains 3x2 --epsilon 1e-3,1 --eta 0.3,inf --csv -   your own packing)";
  return [options](const Context& context) { return run(*options, context); };
}

}  // namespace nscdd::app
