// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "study/moving/moving_tables.hpp"

namespace nscdd {
namespace {

// A step of a run that switches models, and the same step without switching.
struct SwitchedStep {
  SwitchedModel kind = SwitchedModel::none;
  StepReport report, plain;
  std::vector<RememberedModel> models;
  double share = 0, share_at_end = 0;  // of the contacts in switched subdomains, in the mean over the iterations
  double velocity_error = 0, impulse_error = 0;

  bool known() const { return true; }
  Index switch_backs() const {
    Index sum = 0;
    for (const RememberedModel& model : models) sum += model.switch_backs;
    return sum;
  }
  double largest(double RememberedModel::*distance) const {
    double result = 0;
    for (const RememberedModel& model : models) result = std::max(result, model.*distance);
    return result;
  }
};

template <int D>
double share_of(const GranularStep<D>& step, bool at_end) {
  if (step.report.contacts == 0) return 0;
  double sum = 0;
  for (const Index e : step.partition.subdomain_of_contact) {
    const RememberedModel& model = step.models[at(e)];
    sum += at_end ? static_cast<double>(model.switched)
                  : static_cast<double>(model.switched_iterations) / static_cast<double>(step.report.last.iteration);
  }
  return sum / static_cast<double>(step.report.contacts);
}

// |V - V'| / max(|V'|, |V_free|) over the free bodies, because V' of a packing at rest nearly vanishes.
template <int D>
double velocity_error(const GranularStep<D>& switched, const GranularStep<D>& plain) {
  double error = 0, speed = 0, free_speed = 0;
  const auto squared = [](const GrainVelocity<D>& v) { return squared_velocity(v) + squared_rim(v); };
  for (std::size_t i = 0; i < plain.velocities.size(); ++i) {
    const GrainVelocity<D>& b = plain.velocities[i];
    if (b.inverse_mass == 0) continue;
    GrainVelocity<D> apart = switched.velocities[i];
    add(apart, [other = unknowns(b)](std::size_t k) { return -other[k]; });
    error += squared(apart);
    speed += squared(b);
    free_speed += squared(plain.problem.free[i]);
  }
  return error == 0 ? 0.0 : std::sqrt(error / std::max(speed, free_speed));
}

// |F - F'| / |F'|. Impulses below 10^-12 of the momenta are rounding: grains that fly together exchange no more.
template <int D>
double impulse_error(const GranularStep<D>& switched, const GranularStep<D>& plain) {
  const double error = (switched.interface_impulses - plain.interface_impulses).norm();
  const double floor = 1e-12 * std::sqrt(plain.report.residual.scale.momenta);
  return error == 0 ? 0.0 : error / std::max(plain.interface_impulses.norm(), floor);
}

ResultColumns<SwitchedStep> switching_columns() {
  using Step = SwitchedStep;
  return {{"switch", "", "model of switched subdomains", &Step::kind},
          {"subdomains", "1", "of the partition", [](const Step& s) { return s.models.size(); }},
          {"share", "1", "part of the contacts in switched subdomains, in the mean over the iterations", &Step::share},
          {"share_at_end", "1", "the same in the last iteration", &Step::share_at_end},
          {"switch_backs", "1", "of all subdomains in the step", &Step::switch_backs},
          {"velocity_distance", "m/s", "largest distance of a switched subdomain from the law, on its interface",
           [](const Step& s) { return s.largest(&RememberedModel::velocity_distance); }},
          {"impulse_distance", "1", "the same in impulses, relative to those of the interface",
           [](const Step& s) { return s.largest(&RememberedModel::impulse_distance); }},
          {"iterations", "1", "of the step", [](const Step& s) { return s.report.last.iteration; }},
          {"iterations_plain", "1", "of the same step without switching",
           [](const Step& s) { return s.plain.last.iteration; }},
          {"natural_map", "1", "|natural map| / max(|r|, |r^1|)",
           [](const Step& s) { return s.report.residual.relative_natural_map(); }},
          {"natural_map_plain", "1", "the same without switching",
           [](const Step& s) { return s.plain.residual.relative_natural_map(); }},
          {"velocity_error", "1", "|V - V'| / max(|V'|, |V_free|), V' without switching", &Step::velocity_error},
          {"impulse_error", "1", "|F - F'| / |F'| of the interface, F' without switching", &Step::impulse_error},
          {"seconds", "s", "of the iterations", [](const Step& s) { return s.report.solve_seconds; }},
          {"seconds_plain", "s", "of the iterations without switching",
           [](const Step& s) { return s.plain.solve_seconds; }}};
}

SwitchedStep switched_step(const Simulation& simulation) {
  Simulation without = simulation;
  without.dynamics.solver.model = SwitchedModel::none;
  return in_dimension(simulation.system, [&](auto dimension) {
    const auto switched = solve_step<dimension()>(simulation), plain = solve_step<dimension()>(without);
    return SwitchedStep{.kind = simulation.dynamics.solver.model,
                        .report = switched.report,
                        .plain = plain.report,
                        .models = switched.models,
                        .share = share_of(switched, false),
                        .share_at_end = share_of(switched, true),
                        .velocity_error = velocity_error(switched, plain),
                        .impulse_error = impulse_error(switched, plain)};
  });
}

}  // namespace

constinit const Observable observables::switching = examined_steps<switching_columns, switched_step>(
    {.name = "switching",
     .summary = "steps of a run that switches models, compared with the same steps without",
     .own_solver = true,
     .check = [](const CaseSpec& spec) {
       if (!switches_models(*spec.dynamics))
         fail("solver.switch: expected another model, with algorithm {}, met {}", algorithms_with(StepPart::stage_two),
              to_string(spec.dynamics->solver.model));
       if (subdomains(spec.partition) == 1) fail("partition: expected two subdomains or more, met one");
     }});

}  // namespace nscdd
