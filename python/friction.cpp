// SPDX-License-Identifier: GPL-3.0-or-later
#include "friction.hpp"

#include "arrays.hpp"
#include "core/fail.hpp"
#include "long_work.hpp"
#include "module.hpp"
#include "options.hpp"

namespace nscdd::python {
namespace {

using Shared = std::shared_ptr<FrictionSolution>;

Shared solved(const LocalFrictionProblem& problem, const FrictionSolverOptions& options, const py::object& guess,
              const py::object& callback, Index threads) {
  const Vector start = guess.is_none() ? Vector() : vector(guess, "guess");
  if (!start.allFinite()) fail("guess: expected finite numbers, met others");
  LongWork work;
  bool wanted = true;
  const auto observe = [&](const FrictionSolution& check) {
    if (callback.is_none()) return work.goes_on();
    return work.call([&] { wanted = !asks_to_stop(callback(std::make_shared<FrictionSolution>(check))); }) && wanted;
  };
  return work.run(threads,
                  [&] { return std::make_shared<FrictionSolution>(solve_friction(problem, options, start, observe)); });
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
          "r, N s: normal and tangential component of each contact in turn, in space both tangential ones")
      .def_property_readonly(
          "velocities", [](const Shared& s) { return view(s, s->state.velocities); },
          "u = W r + q, m/s, in the same order")
      .def_property_readonly(
          "status", [](const S& s) { return std::string(to_string(s.status)); },
          "converged, stalled, maximum_reached, diverged, not_finite or stopped")
      .def_property_readonly("converged", [](const S& s) { return s.status == FrictionStatus::converged; })
      .def_property_readonly("residual", of_state(&FrictionState::residual),
                             "natural map with rho = 1/W_nn of each contact, relative to max(|r|, |r^1|), r^1: the "
                             "impulse of each contact alone")
      .def_property_readonly("driven_residual", of_state(&FrictionState::driven_residual),
                             "the same natural map relative to what drives the contacts, which does not fall as "
                             "impulses grow")
      .def_readonly("credible", &S::credible,
                    "False where the residual may be small only because impulses are large: they may grow without "
                    "bound, as they do where there is no solution")
      .def_property_readonly("siconos_residual", of_state(&FrictionState::siconos_residual),
                             "natural map with rho = 1, as in Siconos")
      .def_property_readonly("open", of_state(&FrictionState::open), "contacts without an impulse")
      .def_property_readonly("stick", of_state(&FrictionState::stick), "contacts with an impulse inside of the cone")
      .def_property_readonly("slide", of_state(&FrictionState::slide), "contacts with an impulse on its edge")
      .def_readonly("sweeps", &S::sweeps, "Gauss-Seidel sweeps done, or iterations of admm")
      .def_readonly("factorisations", &S::factorisations, "sparse matrices factorised")
      .def_readonly("operations", &S::operations, "floating-point operations")
      .def_readonly("unsettled", &S::unsettled, "contacts whose status changed in the last 10 checks")
      .def("__repr__", &shown);
}

}  // namespace

void bind_friction(py::module_& module) {
  bind_solution(module);
  bind_contact_problems(module);
  module.attr("friction_options") = described_fields<FrictionSolverOptions>();
  module.def(
      "solve",
      [](const ContactProblem& problem, const py::dict& options, const py::object& guess, const py::object& callback,
         Index threads) {
        const auto asked = with_fields<FrictionSolverOptions>(options);
        return solved(*problem.reduced(), asked, guess, callback, threads);
      },
      py::arg("problem"), py::arg("options"), py::arg("guess"), py::arg("callback"), py::arg("threads"));
}

}  // namespace nscdd::python
