// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep_curve.hpp"

namespace nscdd::app {

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
    if (report.status == CurveStatus::not_converged && open++ == 0) note("not converged: {}", report.failure);
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
