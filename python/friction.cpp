// SPDX-License-Identifier: GPL-3.0-or-later
#include "friction.hpp"

#include "arrays.hpp"
#include "contact_solvers/stored_contacts.hpp"
#include "core/fail.hpp"
#include "long_work.hpp"
#include "module.hpp"
#include "options.hpp"
#include <nscdd/contact_solvers/verdict.hpp>

namespace nscdd::python {
namespace {

using SharedSolution = std::shared_ptr<FrictionSolution>;

SharedSolution solved(const LocalFrictionProblem& problem, const FrictionSolverOptions& options,
                      const py::object& guess, const py::object& callback, Index threads) {
  require_moderate(problem, "solve");
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

std::string shown_solution(const FrictionSolution& s) {
  return fmt::format(
      "FrictionSolution(status='{}', residual={:.1e}, open={}, stick={}, slide={}, sweeps={}, factorisations={})",
      to_string(s.status), s.state.residual, s.state.open, s.state.stick, s.state.slide, s.sweeps, s.factorisations);
}

void bind_solution(py::module_& module) {
  using S = FrictionSolution;
  const auto of_state = [](auto member) { return [member](const S& s) { return s.state.*member; }; };
  py::class_<S, SharedSolution>(
      module, "FrictionSolution",
      "Impulses r of a contact problem and how well they solve it. Whether they do, `status` says.")
      .def_property_readonly(
          "impulses", [](const SharedSolution& s) { return view(s, s->impulses); },
          "r, N s: normal and tangential component of each contact in turn, in space both tangential ones")
      .def_property_readonly(
          "velocities", [](const SharedSolution& s) { return view(s, s->state.velocities); },
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
      .def("__repr__", &shown_solution);
}

void bind_verdict(py::module_& module) {
  using V = Verdict;
  using SharedVerdict = std::shared_ptr<V>;
  py::class_<V, SharedVerdict>(module, "Verdict", "Whether a contact problem has a solution, with its certificate.")
      .def_property_readonly(
          "kind", [](const V& v) { return std::string(to_string(v.kind)); },
          "exists or impossible, both proved in outward-rounded arithmetic, or undecided")
      .def_readonly("margin", &V::margin, "the largest s found with u_n - mu |u_t| >= s at every contact, m/s")
      .def_readonly("speed", &V::speed, "of the bodies with this margin, m/s")
      .def_property_readonly(
          "velocities", [](const SharedVerdict& v) { return view(v, v->velocities); },
          "v' with this margin, u = H^T v' + q; without bodies y with u = W y + q")
      .def_readonly("normal_margin", &V::normal_margin,
                    "the largest s found without friction; nan if a solution exists")
      .def_readonly("chain", &V::chain, "contacts of a self-stress that the supports work against")
      .def_property_readonly(
          "stress", [](const SharedVerdict& v) { return view(v, v->stress); },
          "the self-stress at these contacts, the largest 1")
      .def_readonly("closing_speed", &V::closing_speed, "of the supports at the chain, m/s")
      .def_readonly("proven_speed", &V::proven_speed, "no solution has bodies that are slower, m/s")
      .def_readonly("factorisations", &V::factorisations, "sparse matrices factorised")
      .def("__repr__", [](const V& v) {
        return fmt::format("Verdict(kind='{}', margin={:.3g}, closing_speed={:.3g})", to_string(v.kind), v.margin,
                           v.closing_speed);
      });
}

}  // namespace

void bind_friction(py::module_& module) {
  bind_solution(module);
  bind_verdict(module);
  module.def(
      "verdict",
      [](const ContactProblem& problem, Index threads) {
        LongWork work;
        const auto reduced = problem.reduced();
        require_moderate(*reduced, "verdict");
        return work.run(threads, [&] {
          return std::make_shared<Verdict>(verdict_of(*reduced, [&](Index, Index) { return work.goes_on(); }));
        });
      },
      py::arg("problem"), py::arg("threads"));
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
