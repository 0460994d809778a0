// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "study/moving_tables.hpp"

namespace nscdd {
namespace {

// A step of a run that switches models, beside the same step, from the same state, without.
struct SwitchedStep {
  SolvedCase solver;
  SolvedStep<2> switched, plain;

  const StepReport& report() const { return switched.report; }
  // Part of the contacts in switched subdomains, in the mean over the iterations or at the end.
  double share(bool at_end) const;
  Index switch_backs() const;
  double largest(double RememberedModel::*distance) const;
  double velocity_error() const;
  double impulse_error() const;
};

double SwitchedStep::share(bool at_end) const {
  double sum = 0;
  for (const Index e : switched.partition.subdomain_of_contact) {
    const RememberedModel& model = switched.models[at(e)];
    sum += at_end ? static_cast<double>(model.switched)
                  : static_cast<double>(model.switched_iterations) / static_cast<double>(report().last.iteration);
  }
  return sum / static_cast<double>(report().contacts);
}

Index SwitchedStep::switch_backs() const {
  Index sum = 0;
  for (const RememberedModel& model : switched.models) sum += model.switch_backs;
  return sum;
}

double SwitchedStep::largest(double RememberedModel::*distance) const {
  double result = 0;
  for (const RememberedModel& model : switched.models) result = std::max(result, model.*distance);
  return result;
}

// |V - V'| / max(|V'|, |V_free|) over the free bodies: those of a packing at rest hardly move.
double SwitchedStep::velocity_error() const {
  double error = 0, speed = 0, free_speed = 0;
  const auto squared = [](const GrainVelocity<2>& v) { return v.x * v.x + v.y * v.y + v.rim * v.rim; };
  for (std::size_t i = 0; i < plain.velocities.size(); ++i) {
    const GrainVelocity<2>&a = switched.velocities[i], &b = plain.velocities[i];
    if (b.inverse_mass == 0) continue;
    error += squared({a.x - b.x, a.y - b.y, a.rim - b.rim});
    speed += squared(b);
    free_speed += squared(plain.problem.free[i]);
  }
  return error == 0 ? 0.0 : std::sqrt(error / std::max(speed, free_speed));
}

double SwitchedStep::impulse_error() const {
  const double error = (switched.interface_impulses - plain.interface_impulses).norm();
  return error == 0 ? 0.0 : error / plain.interface_impulses.norm();
}

const ResultColumns<SwitchedStep>& switching_columns() {
  using Step = SwitchedStep;
  static const auto columns = joined<Step>(
      {columns_of(&Step::solver, solver_columns()),
       {{"step", "1", "step examined, from 1", [](const Step& s) { return s.report().step; }},
        {"switch", "", "model of switched subdomains",
         [](const Step& s) { return to_string(s.solver.solver().model); }},
        {"subdomains", "1", "of the partition", [](const Step& s) { return s.switched.models.size(); }},
        {"share", "1", "part of the contacts in switched subdomains, in the mean over the iterations",
         [](const Step& s) { return s.share(false); }},
        {"share_at_end", "1", "the same in the last iteration", [](const Step& s) { return s.share(true); }},
        {"switch_backs", "1", "of all subdomains in the step", &Step::switch_backs},
        {"velocity_distance", "m/s", "largest distance of a switched subdomain from the law, on its interface",
         [](const Step& s) { return s.largest(&RememberedModel::velocity_distance); }},
        {"impulse_distance", "1", "the same in impulses, relative to those of the interface",
         [](const Step& s) { return s.largest(&RememberedModel::impulse_distance); }},
        {"iterations", "1", "of the step", [](const Step& s) { return s.report().last.iteration; }},
        {"iterations_plain", "1", "of the same step without switching",
         [](const Step& s) { return s.plain.report.last.iteration; }},
        {"natural_map", "1", "|natural map| / |r|",
         [](const Step& s) { return s.report().residual.relative_natural_map(); }},
        {"natural_map_plain", "1", "the same without switching",
         [](const Step& s) { return s.plain.report.residual.relative_natural_map(); }},
        {"velocity_error", "1", "|V - V'| / max(|V'|, |V_free|), V' without switching", &Step::velocity_error},
        {"impulse_error", "1", "|F - F'| / |F'| of the interface, F' without switching", &Step::impulse_error},
        {"seconds", "s", "of the iterations", [](const Step& s) { return s.report().solve_seconds; }},
        {"seconds_plain", "s", "of the iterations without switching",
         [](const Step& s) { return s.plain.report.solve_seconds; }}}});
  return columns;
}

Index switched_step(const ObservedCase& work, Index step, const Sink<SwitchedStep>& sink) {
  const Simulation simulation = work.lead_in.at(work.one, step - 1, LeadInSolver::own).simulation;
  Simulation without = simulation;
  without.dynamics.solver.model = SwitchedModel::none;
  SwitchedStep result{{work.one.spec.name, simulation, {}}, solve_step(simulation), solve_step(without)};
  result.solver.report = result.switched.report;
  sink(result);
  return 0;
}

}  // namespace

constinit const Observable observables::switching = at_steps<switching_columns, switched_step>(
    {.name = "switching",
     .summary = "steps of a run that switches models, beside the same steps without",
     .rows = row_per_step,
     .known = known_step,
     .own_solver = true,
     .check = [](const CaseSpec& spec) {
       if (!switches_models(*spec.dynamics))
         fail("solver.switch: expected another model, with algorithm generic or enriched, met {}",
              to_string(spec.dynamics->solver.model));
       if (subdomains(spec.partition) == 1) fail("partition: expected two subdomains or more, met one");
     }});

}  // namespace nscdd
