// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/modes.hpp"

#include "arrays.hpp"
#include "long_work.hpp"
#include "module.hpp"

namespace nscdd::python {
namespace {

// A mode with the operator and the packing that it belongs to.
struct FoundMode {
  Contraction b;
  std::shared_ptr<const Model> model;
  Mode mode;

  ModeParameters parameters() const {
    return {.epsilon = b.system.flexibility(), .eta = b.preconditioner.flexibility()};
  }
};
using SharedMode = std::shared_ptr<FoundMode>;

SharedMode found(const std::shared_ptr<Model>& model, const Contraction& b, const std::string& end,
                 const SpectralOptions& options, Index threads) {
  LongWork work;
  const auto side = Choice<SpectrumSide>::parse(end, "end");
  const SpectralOptions watched = work.watched(options);
  return work.run(threads, [&] { return std::make_shared<FoundMode>(FoundMode{b, model, mode_of(b, side, watched)}); });
}

// V_E of each subdomain, a row per grain of it.
py::list velocities_of(const SharedMode& shared) {
  py::list all;
  const Index d = shared->model->parts.dofs_per_grain();
  for (const Vector& v : shared->mode.velocities) all.append(view(shared, v).attr("reshape")(-1, d));
  return all;
}

template <class Result, class Rows>
py::list table(const ResultColumns<Result>& columns, Rows&& hand_over) {
  std::vector<Row> rows;
  hand_over([&](const Result& one) { rows.push_back(row(columns, one)); });
  return columns_of_rows(headings(columns), rows);
}

}  // namespace

void bind_modes(py::module_& module) {
  using M = FoundMode;
  const auto of = [](auto member) { return [member](const M& m) { return std::invoke(member, m.mode); }; };
  const auto view_of = [](auto member) { return [member](const SharedMode& m) { return view(m, m->mode.*member); }; };
  py::class_<M, SharedMode>(module, "Mode")
      .def_property_readonly("spectrum",
                             [](const SharedMode& m) { return std::shared_ptr<SpectralRadius>(m, &m->mode.spectrum); })
      .def_property_readonly("end", [](const M& m) { return std::string(to_string(m.mode.side)); })
      .def_property_readonly("eigenvalue", of(&Mode::eigenvalue))
      .def_property_readonly("next", of(&Mode::next))
      .def_property_readonly("residual", of(&Mode::residual))
      .def_property_readonly("converged", of(&Mode::converged))
      .def_property_readonly("found", of(&Mode::found))
      .def_property_readonly("impulses", view_of(&Mode::impulses))
      .def_property_readonly("jumps", view_of(&Mode::jumps))
      .def_property_readonly("shares", view_of(&Mode::shares))
      .def_property_readonly("velocities", &velocities_of)
      .def_property_readonly("spread", [](const M& m) { return m.mode.found() ? spread(m.mode) : 0.0; })
      .def("impulse_columns",
           [](const M& m) {
             const ModeParameters parameters = m.parameters();
             return table<ModeImpulse>(
                 mode_impulse_columns(m.model->problem.dimension),
                 [&](const Sink<ModeImpulse>& sink) { mode_impulses(*m.model, parameters, m.mode, sink); });
           })
      .def("velocity_columns", [](const M& m) {
        return table<ModeVelocity>(mode_velocity_columns(m.model->problem.dimension),
                                   [&](const Sink<ModeVelocity>& sink) { mode_velocities(*m.model, m.mode, sink); });
      });
  module.def(
      "mode",
      [](const std::shared_ptr<Model>& parts, const Contraction& b, const std::string& end, const py::dict& options,
         Index threads) { return found(parts, b, end, spectral_options(options), threads); },
      py::arg("parts"), py::arg("b"), py::arg("end"), py::arg("options"), py::arg("threads"));
}

}  // namespace nscdd::python
