// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.hpp"
#include "core/fail.hpp"
#include "long_work.hpp"
#include "module.hpp"
#include <nscdd/mechanics/friction_solver.hpp>

namespace nscdd::python {
namespace {

using Shared = std::shared_ptr<FrictionSolution>;
using Matrices = std::optional<std::pair<CompressedColumns, CompressedColumns>>;

CompressedColumns columns_of(const py::object& csc) {
  return {csc.attr("data").cast<Array<double>>(), csc.attr("indices").cast<Array<int>>(),
          csc.attr("indptr").cast<Array<int>>(), csc.attr("shape").cast<std::array<Index, 2>>()};
}

FrictionSolverOptions options_of(const std::string& solver, double tolerance, const std::string& order,
                                 const py::dict& more) {
  FrictionSolverOptions options;
  options.algorithm = Choice<FrictionAlgorithm>::parse(solver, "solver");
  options.order = Choice<SweepOrder>::parse(order, "order");
  check_bounds(tolerance, Field{.description = "", .minimum = 0, .maximum = 1}, "tolerance");
  options.tolerance = tolerance;
  options.maximum_sweeps = more["maximum_sweeps"].cast<Index>();
  options.maximum_factorisations = more["maximum_factorisations"].cast<Index>();
  options.relaxation = more["relaxation"].cast<double>();
  options.seed = more["seed"].cast<Index>();
  options.check_every = more["check_every"].cast<Index>();
  return options;
}

Shared solved(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
              const std::optional<Array<double>>& guess, const py::object& callback, Index threads) {
  const Vector start = guess ? vector(*guess, "guess") : Vector();
  LongWork work;
  bool wanted = true;
  const auto observe = [&](const FrictionSolution& check) {
    return work.call([&] {
      if (!callback.is_none()) wanted = !callback(std::make_shared<FrictionSolution>(check)).is(py::bool_(false));
    }) && wanted;
  };
  return work.run(threads,
                  [&] { return std::make_shared<FrictionSolution>(solve_friction(problem, options, start, observe)); });
}

LocalFrictionProblem local_problem(const py::object& w, const Array<double>& q, const Array<double>& friction) {
  LocalFrictionProblem problem{sparse_matrix(columns_of(w), "W"), vector(q, "q"), vector(friction, "mu")};
  check(problem, "problem");
  return problem;
}

LocalFrictionProblem reduced(const py::object& mass, const py::object& h, const Array<double>& f,
                             const Array<double>& w, const Array<double>& friction) {
  const GlobalFrictionProblem problem{sparse_matrix(columns_of(mass), "M"), sparse_matrix(columns_of(h), "H"),
                                      vector(f, "f"), vector(w, "w"), vector(friction, "mu")};
  check(problem, "problem");
  return LongWork().run(0, [&] { return reduce(problem); });
}

std::string shown(const FrictionSolution& s) {
  return fmt::format(
      "FrictionSolution(status='{}', residual={:.1e}, open={}, stick={}, slide={}, sweeps={}, factorisations={})",
      to_string(s.status), s.state.residual, s.state.open, s.state.stick, s.state.slide, s.sweeps, s.factorisations);
}

void bind_solution(py::module_& module) {
  using S = FrictionSolution;
  const auto of_state = [](auto member) { return [member](const S& s) { return s.state.*member; }; };
  py::class_<S, Shared>(module, "FrictionSolution",
                        "Impulses r of a contact problem and how well they solve it. Whether they do, `status` says.")
      .def_property_readonly(
          "impulses", [](const Shared& s) { return view(s, s->impulses); },
          "r, 2c entries, N s: normal and tangential component of each contact in turn")
      .def_property_readonly(
          "velocities", [](const Shared& s) { return view(s, s->state.velocities); }, "u = W r + q, 2c entries, m/s")
      .def_property_readonly(
          "status", [](const S& s) { return std::string(to_string(s.status)); },
          "converged, stalled, maximum_reached, diverged, not_finite or stopped")
      .def_property_readonly("converged", [](const S& s) { return s.status == FrictionStatus::converged; })
      .def_property_readonly("residual", of_state(&FrictionState::residual),
                             "natural map with rho = 1/W_nn of each contact, relative to the impulses")
      .def_property_readonly("siconos_residual", of_state(&FrictionState::siconos_residual),
                             "natural map with rho = 1, as Siconos has it")
      .def_property_readonly("open", of_state(&FrictionState::open), "contacts without an impulse")
      .def_property_readonly("stick", of_state(&FrictionState::stick), "contacts with an impulse inside of the cone")
      .def_property_readonly("slide", of_state(&FrictionState::slide), "contacts with an impulse on its edge")
      .def_readonly("sweeps", &S::sweeps, "Gauss-Seidel sweeps done, or iterations of admm and apgd")
      .def_readonly("factorisations", &S::factorisations, "sparse matrices factorised")
      .def_readonly("operations", &S::operations, "floating-point operations")
      .def_readonly("unsettled", &S::unsettled, "contacts whose status changed in the last 10 checks")
      .def("__repr__", &shown);
}

}  // namespace

void bind_friction(py::module_& module) {
  bind_solution(module);
  py::class_<LocalFrictionProblem, std::shared_ptr<LocalFrictionProblem>>(module, "LocalFrictionProblem")
      .def_property_readonly("contacts", &LocalFrictionProblem::contacts);
  module.def("local_problem", &local_problem, py::arg("W"), py::arg("q"), py::arg("mu"));
  module.def("reduced_problem", &reduced, py::arg("M"), py::arg("H"), py::arg("f"), py::arg("w"), py::arg("mu"));
  module.def(
      "solve",
      [](const LocalFrictionProblem& problem, const std::string& solver, double tolerance, const std::string& order,
         const py::dict& more, const std::optional<Array<double>>& guess, const py::object& callback, Index threads) {
        return solved(problem, options_of(solver, tolerance, order, more), guess, callback, threads);
      },
      py::arg("problem"), py::arg("solver"), py::arg("tolerance"), py::arg("order"), py::arg("more"), py::arg("guess"),
      py::arg("callback"), py::arg("threads"));
}

}  // namespace nscdd::python
