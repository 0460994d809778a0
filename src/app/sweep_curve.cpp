// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep_curve.hpp"

#include "study/values.hpp"

namespace nscdd::app {
namespace {

// What a proof asks for, beside the range.
void require_provable(const SweepParameters& sweep) {
  for (const auto& sweeps : sweep.gauss_seidel_sweeps)
    if (sweeps)
      fail("--gauss-seidel-sweeps: expected inf with --curve (an inexact Stage 1 has no symmetric pencil), met {}",
           *sweeps);
  for (const auto& relaxation : sweep.relaxation)
    if (!relaxation)
      fail("--relaxation: expected numbers with --curve (the optimal one changes along the curve), met optimal");
  const auto solver = sweep.spectral.solver;
  if (solver == SpectralSolver::arpack || solver == SpectralSolver::slepc)
    fail("--solver: expected auto, dense or shift-invert with --curve (others prove no end of a spectrum), met {}",
         to_string(solver));
}

}  // namespace

CurveParameters curve_parameters(double tolerance, const std::string& epsilon, const std::string& eta,
                                 SweepParameters rest) {
  if (!(tolerance > 0 && std::isfinite(tolerance))) fail("--curve: expected a finite tolerance > 0, met {}", tolerance);
  require_provable(rest);
  const auto along_epsilon = parse_range(epsilon, "epsilon"), along_eta = parse_range(eta, "eta");
  if (along_epsilon.has_value() == along_eta.has_value())
    fail("--curve: expected one range FROM:TO without a count, of --epsilon or of --eta, met --epsilon {} --eta {}",
         epsilon, eta);
  CurveParameters curve{
      .sweep = std::move(rest), .axis = along_epsilon ? CurveAxis::epsilon : CurveAxis::eta, .tolerance = tolerance};
  if (along_epsilon) {
    curve.sweep.epsilon = {along_epsilon->from, along_epsilon->to};
    curve.sweep.relative_epsilon = along_epsilon->relative;
    std::tie(curve.sweep.eta, curve.sweep.relative_eta) = parse_eta(eta);
  } else {
    std::tie(curve.sweep.epsilon, curve.sweep.relative_epsilon) = parse_epsilon(epsilon);
    curve.sweep.eta = {along_eta->from, along_eta->to};
    curve.sweep.relative_eta = along_eta->relative;
  }
  return curve;
}

TableWork curve_work(const StudyTable& work, const CurveParameters& parameters) {
  TableWork table{work_identity(work), headings(curve_columns(parameters.sweep)), std::nullopt, {}};
  table.identity.options += fmt::format("curve {}\n", to_text(parameters.tolerance));
  return table;
}

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
    open += report.status == CurveStatus::not_converged;
  }
  if (wide > 0)
    note(
        "{} of {} curves have a band wider than the tolerance: {} points, or the digits of the spectra, do not do; see "
        "curve_low and curve_high",
        wide, reports.size(), parameters.most_points);
  if (open > 0)
    note("{} of {} curves have a point that did not converge, and no band: see the column 'converged'", open,
         reports.size());
  return wide + open > 0 ? 1 : 0;
}

int leave_nothing(const std::string& path) {
  note("{}: interrupted: a table of curves is not resumed{}", path == "-" ? "standard output" : path,
       is_stream(path) ? "" : ", and nothing is left of it");
  return interrupted_exit_code;
}

}  // namespace nscdd::app
