// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "core/fail.hpp"
#include "long_work.hpp"
#include "module.hpp"
#include "study/linear/curve.hpp"
#include "study/linear/optimum.hpp"
#include "study/linear/sweep_points.hpp"
#include "study/linear/values.hpp"

namespace nscdd::python {
namespace {

constexpr Py_ssize_t caller = 3;  // of a function in python/nscdd/ that _arguments.takes calls

// How the spectra of a table are computed, and how the work is watched.
struct TableOptions {
  SpectralOptions spectral;
  py::object progress;
  Index threads;
};

// Calls work(sink, monitor, parameters), which hands over rows of these columns.
template <class Result, class Work>
py::list table(const ResultColumns<Result>& columns, SweepParameters& parameters, LongWork& watch, Index threads,
               Work&& work) {
  parameters.spectral = watch.watched(std::move(parameters.spectral));
  const auto rows = watch.run(threads, [&] {
    std::vector<Row> found;
    const RowSink keep = [&](const Row& cells) { found.push_back(cells); };
    work(as_rows(columns, keep), watch.monitor());
    return found;
  });
  return columns_of_rows(headings(columns), rows);
}

SweepParameters parameters_of(const std::string& epsilon, const std::string& contacts, const std::string& scheme,
                              const TableOptions& options) {
  SweepParameters parameters;
  std::tie(parameters.epsilon, parameters.relative_epsilon) = parse_epsilon(epsilon);
  parameters.contacts = Choice<ContactSet>::parse(contacts, "contacts");
  parameters.spectral = options.spectral;
  parameters.scheme = Choice<DecompositionScheme>::parse(scheme, "scheme");
  return parameters;
}

py::list swept(const Model& model, const std::string& epsilon, const std::string& eta, const std::string& relaxation,
               const std::string& sweeps, const std::string& contacts, const std::string& scheme,
               const TableOptions& options) {
  SweepParameters parameters = parameters_of(epsilon, contacts, scheme, options);
  std::tie(parameters.eta, parameters.relative_eta) = parse_eta(eta);
  parameters.relaxation = parse_relaxation(relaxation);
  parameters.gauss_seidel_sweeps = parse_sweeps(sweeps);
  check_sweep(parameters);
  warn_of(remarks_on(model, parameters), caller);
  LongWork watch(options.progress);
  return table<SweepResult>(sweep_columns(parameters), parameters, watch, options.threads,
                            [&](const auto& sink, const Monitor& monitor) { sweep(model, parameters, sink, monitor); });
}

// Curves of the radius with what became of each: (columns, statuses).
py::tuple traced(const Model& model, const std::string& epsilon, const std::string& eta, double tolerance,
                 const std::string& relaxation, const std::string& contacts, const std::string& scheme,
                 const TableOptions& options) {
  SweepParameters sweep = parameters_of("1", contacts, scheme, options);
  sweep.relaxation = parse_relaxation(relaxation);
  CurveParameters parameters = curve_parameters(tolerance, epsilon, eta, std::move(sweep));
  warn_of(remarks_on(model, parameters.sweep), caller);
  LongWork watch(options.progress);
  std::vector<CurveReport> reports;
  const auto columns = curve_columns(parameters.sweep);
  py::list found = table<CurveResult>(
      columns, parameters.sweep, watch, options.threads,
      [&](const auto& sink, const Monitor& monitor) { reports = trace_curves(model, parameters, sink, monitor); });
  py::list statuses;
  for (const CurveReport& report : reports) statuses.append(std::string(to_string(report.status)));
  return py::make_tuple(found, statuses);
}

py::list optimised(const Model& model, const std::string& epsilon, const std::string& contacts,
                   const std::string& scheme, const TableOptions& options) {
  SweepParameters parameters = parameters_of(epsilon, contacts, scheme, options);
  LongWork watch(options.progress);
  return table<OptimumResult>(optimum_columns(parameters), parameters, watch, options.threads,
                              [&](const auto& sink, const Monitor& monitor) {
                                optima(model, select(model, parameters.contacts), parameters, sink, monitor);
                              });
}

// Name and description of each column, for the documentation.
template <class Result>
std::string columns_text(const ResultColumns<Result>& columns) {
  std::string text;
  for (const Column& one : headings(columns))
    text += fmt::format("    {}: {}{}\n", one.name, one.description,
                        one.unit.empty() || one.unit == "1" ? "" : ", " + one.unit);
  return text;
}

}  // namespace

void bind_tables(py::module_& module) {
  py::class_<TableOptions>(module, "TableOptions")
      .def(py::init([](const py::dict& options, py::object progress, Index threads) {
             return TableOptions{spectral_options(options), std::move(progress), threads};
           }),
           py::arg("options"), py::arg("progress"), py::arg("threads"));
  module.def("sweep", &swept, py::arg("parts"), py::arg("epsilon"), py::arg("eta"), py::arg("relaxation"),
             py::arg("gauss_seidel_sweeps"), py::arg("contacts"), py::arg("scheme"), py::arg("options"));
  module.def("curve", &traced, py::arg("parts"), py::arg("epsilon"), py::arg("eta"), py::arg("tolerance"),
             py::arg("relaxation"), py::arg("contacts"), py::arg("scheme"), py::arg("options"));
  module.def("optimum", &optimised, py::arg("parts"), py::arg("epsilon"), py::arg("contacts"), py::arg("scheme"),
             py::arg("options"));
  module.attr("sweep_columns_text") = columns_text(sweep_columns());
  module.attr("curve_columns_text") = columns_text(curve_columns({}));
  module.attr("optimum_columns_text") = columns_text(optimum_columns({}));
}

}  // namespace nscdd::python
