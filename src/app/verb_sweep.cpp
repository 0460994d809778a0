// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "files/hdf5.hpp"
#include "study/linear/curve.hpp"
#include "study/linear/inspection.hpp"
#include "study/linear/sweep_points.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {
namespace {

struct SweepOptions {
  CaseOptions one;
  StudyTable work{.name = "sweep"};
  std::string epsilon, eta = "inf", relaxation = "1", sweeps = "inf", csv, hdf5, counts;
  Reopening how;
  std::optional<double> curve;
  Limits limits;
};

// Passes all rows of the sweep, old and new, to `sink`. Notes rows without proof, unless interrupted.
int work_through(const Model& model, const StudyTable& work, SharedTable& csv, Interruption& interruption,
                 const RowSink& sink) {
  const ResultColumns<SweepResult> columns = sweep_columns(work.sweep);
  const Table layout{headings(columns), {}};
  Index unproved = 0, uncertified = 0, told = 0, diverging = 0, exact = 0;
  const bool certify = work.sweep.spectral.certify;
  const auto take = [&, converged = layout.column("converged"),
                     certified = certify ? layout.column("certified") : 0](const Row& cells) {
    const bool open = !std::get<bool>(cells[converged]);
    unproved += open;
    uncertified += certify && !open && !std::get<bool>(cells[certified]);
    sink(cells);
  };
  csv->replay(take);
  constexpr Index most_told = 3;  // rows without the requested result whose failure is noted
  const auto write = [&](const SweepResult& result) {
    const SpectralRadius& radius = result.radius;
    if ((!radius.converged || (certify && !radius.certified)) && told++ < most_told)
      note("epsilon = {}, eta = {}: {}: {}", result.point.epsilon, result.point.eta,
           radius.converged ? "not certified" : "not converged", radius.failure);
    // At -1 the error does not decay. Next to 1 it does, slowly; eigenvalue_min is nan for an inexact Stage 1.
    if (work.sweep.schwarz() && radius.subdominant >= 1 - 1e-9 && !(radius.eigenvalue_min > -1 + 1e-9)) {
      exact += !result.point.gauss_seidel_sweeps;
      if (diverging++ == 0)
        note("epsilon = {}: schwarz {} with the relaxation {}: radius {:.6g}", result.point.epsilon,
             radius.subdominant > 1 + 1e-9 ? "diverges" : "does not converge", *result.point.relaxation,
             radius.subdominant);
    }
    const Row cells = row(columns, result);
    csv->write(cells);
    take(cells);
  };
  sweep(model, work.sweep, write, interruption.watch(work.name, csv.kept()), csv.kept());
  if (interruption.stopped()) return 0;
  if (diverging > 0)
    note("{} row(s) do not converge with their relaxation{}", diverging,
         exact > 0 ? "; with an exact Stage 1 one below 2 / (1 - eigenvalue_min at relaxation 1) does" : "");
  if (unproved > 0) note("{} row(s) did not converge: see the column 'converged'", unproved);
  if (uncertified > 0) note("{} row(s) converged but are not certified: see the column 'certified'", uncertified);
  return 0;
}

// The table of curves: that of a sweep with an unknown number of rows.
TableWork curve_work(const StudyTable& work, const CurveParameters& parameters) {
  TableWork table{work_identity(work), headings(curve_columns(parameters.sweep)), std::nullopt, {}};
  table.identity.options += fmt::format("curve {}\n", to_text(parameters.tolerance));
  return table;
}

// Writes the rows of the curves and passes them to `sink`. Notes curves that are not proved; the exit code is then 1.
int trace(const Model& model, const CurveParameters& parameters, ResumableTable& csv, Interruption& interruption,
          const RowSink& sink) {
  const RowSink write = [&](const Row& row) {
    csv.write(row);
    sink(row);
  };
  const std::vector<CurveReport> reports =
      trace_curves(model, parameters, as_rows(curve_columns(parameters.sweep), write), interruption.watch("curve"));
  Index wide = 0, open = 0;
  for (const CurveReport& report : reports) {
    wide += report.status == CurveStatus::wide;
    if (report.status == CurveStatus::not_converged && open++ == 0) note("not converged: {}", report.failure);
  }
  if (wide > 0)
    note(
        "{} of {} curves have a band wider than the tolerance: {} points, or the digits of the spectra, do not "
        "suffice; see curve_low and curve_high",
        wide, reports.size(), parameters.most_points);
  if (open > 0)
    note("{} of {} curves have a point that did not converge, and no band: see the column 'converged'", open,
         reports.size());
  return wide + open > 0 ? 1 : 0;
}

// The points of a sweep, or curves, which place their points.
std::pair<StudyTable, std::optional<CurveParameters>> asked(const SweepOptions& options, const Machine& machine) {
  StudyTable work = options.work;
  std::optional<CurveParameters> curve;
  SweepParameters& sweep = work.sweep;
  sweep.relaxation = parse_relaxation(options.relaxation);
  sweep.gauss_seidel_sweeps = parse_sweeps(options.sweeps);
  sweep.spectral = spectra_on(machine, sweep.spectral);
  if (options.curve) {
    if (options.how.resume) fail("--resume: expected a sweep of points given, met --curve, which places them itself");
    curve = curve_parameters(*options.curve, options.epsilon, options.eta, sweep, "--");
    sweep = curve->sweep;
  } else {
    std::tie(sweep.epsilon, sweep.relative_epsilon) = parse_epsilon(options.epsilon);
    std::tie(sweep.eta, sweep.relative_eta) = parse_eta(options.eta);
  }
  check_sweep(sweep, "--");
  work.cases = {options.one.resolve({options.csv, options.hdf5, options.counts})};
  require_distinct({options.csv, options.hdf5, options.counts});
  return {std::move(work), std::move(curve)};
}

int run_sweep(const SweepOptions& options, const Context& context) {
  const Machine& machine = context.machine;
  options.limits.limit_memory(machine.processes_here);
  auto [work, curve] = in_turn(machine.processes, [&] { return asked(options, machine); });
  if (std::ranges::any_of(work.sweep.gauss_seidel_sweeps, [](const auto& sweeps) { return sweeps.has_value(); }))
    require_one_process(machine, "--gauss-seidel-sweeps");
  const TableWork rows = curve ? curve_work(work, *curve) : table_work(work);
  if (nothing_to_resume(options.csv, options.hdf5, rows, options.how, machine)) return 0;
  const ThreadLimit limit = options.limits.limit_threads(machine);  // packings are settled with all threads
  const Model model = shared_model(work.cases.front(), machine, work.sweep.contacts);
  if (model.parts.interface_size() == 0)
    note("{}: the interface is empty ({}): nothing to contract, radius 0", model.name, why_empty(model));
  for (const std::string& remark : remarks_on(model, work.sweep)) note("{}", remark);
  Interruption interruption(machine.processes);
  // Outputs are opened before the work and get their names after it: a run that fails leaves none.
  SharedTable csv(machine, options.csv, rows, options.how);
  CountsTable counts(options.counts, options.how.force, machine);
  std::optional<OutputFile> hdf5;
  machine.processes.together([&] {
    if (!options.hdf5.empty() && machine.processes.first())
      hdf5.emplace(options.hdf5, options.how.force, kept_of_whole(options.how));
    return true;
  });
  Table table{rows.columns, {}};
  const RowSink keep = [&table, wanted = hdf5.has_value()](const Row& row) {
    if (wanted) table.rows.push_back(row);
  };
  const int code =
      curve ? trace(model, *curve, *csv, interruption, keep) : work_through(model, work, csv, interruption, keep);
  if (interruption.stopped() && curve)  // the destructor of the table removes its files
    return interrupted("{}: interrupted: a table of curves is not resumed{}", name_of_output(options.csv),
                       is_stream(options.csv) ? "" : ", and nothing is left of it");
  if (interruption.stopped()) return leave(*csv, options.csv);
  csv->finish();  // first, so that a failure of another output does not delete the rows
  if (hdf5) hdf5->bytes(to_hdf5(provenance(context, work.cases), {{"sweep", table}}));
  counts.finish();
  if (hdf5) hdf5->finish();
  csv.forget();
  return code;
}

}  // namespace

Action declare_sweep(Command& command) {
  auto options = std::make_shared<SweepOptions>();
  options->one.declare(command);
  command.required("--epsilon SPEC", options->epsilon,
                   "flexibility, 1/kg, or times the mean of W_nn (0.1W); 0 is the rigid limit");
  command.preset("--eta SPEC", options->eta,
                 "flexibility Stage 2 sees, 1/kg, or times the mean of W_nn (10W); inf is the generic algorithm");
  declare_contacts(command, options->work.sweep.contacts);
  declare_scheme(command, options->work.sweep.scheme);
  command.fields(options->work.sweep.spectral);
  command.named("--certify").help += "; adds columns with the intervals";
  command.named("--eigenvalues").help +=
      "; more than one adds columns: their values, and for each end the multiplicity of its first value alone (how "
      "many of those found agree with it within --residual-tolerance; with --certify how many lie in its interval)";
  command.add("--curve TOLERANCE", options->curve,
              "prove the curve over a range FROM:TO, whose points are placed for it; one of --epsilon and --eta is the "
              "range, and the band curve_low to curve_high is at most TOLERANCE x max(1, radius) wide",
              {.above = 0});
  options->limits.declare_threads(command);
  command.preset("--relaxation SPEC", options->relaxation, "omega in F <- F + omega (F' - F), or 'optimal'");
  command.preset("--gauss-seidel-sweeps SPEC", options->sweeps, "sweeps n_GS of Stage 1; inf is exact");
  command.required("--csv FILE", options->csv, "where the table goes, - for standard output");
  CountsTable::declare(command, options->counts);
  command.add("--hdf5 FILE", options->hdf5, "also write the table, with its provenance, as HDF5");
  declare_reopening(command, options->how);
  options->limits.declare_memory(command);
  command.footer = R"(SPEC is a number, a comma list, or FROM:TO:COUNT (logarithmic; FROM:TO:COUNT:linear).
One row per (epsilon, eta, relaxation, sweeps); columns are described in docs/formats.md.
Examples:
  nscdd sweep disks4 --epsilon 0,1 --csv -                            rho(B_0), rho(B_1)
  nscdd sweep disks12 --epsilon 1e-3:1e3:121 --csv figure5.csv        a curve of Figure 5
  nscdd sweep disks12 --epsilon 1e-3:1e3 --curve 1e-3 --csv -         the same, proved between its points
  nscdd sweep disks8 --epsilon 1 --eta 1e-2:1e2:81 --csv -            rho(B_eps,eta)
  nscdd sweep disks8 --epsilon 0 --eta 0.1,inf --contacts active --csv -   the nonsmooth B-bar
  nscdd sweep mine.csv --subdomains 3x2 --epsilon 1e-3,1 --eta 0.3,inf --csv -   your own packing)";
  return [options](const Context& context) { return run_sweep(*options, context); };
}

}  // namespace nscdd::app
