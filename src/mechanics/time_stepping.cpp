// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/time_stepping.hpp"

namespace nscdd {

Place gravity_of(const TimeStepping& scheme, Index dimension) {
  const Components<double>& g = scheme.gravity;
  if (dimension == 3 && g == TimeStepping().gravity) return {0, 0, g[1]};
  return {g[0], g[1], g[2]};
}

std::vector<RigidVelocity> step_motions(const GranularSystem& system, const GranularState& state,
                                        const TimeStepping& scheme) {
  const bool at_end = scheme.boundary_instant == BoundaryInstant::end;
  return boundary_velocities(system, state.time + (at_end ? scheme.step : scheme.step / 2));
}

std::vector<RigidVelocity> first_motions(const GranularSystem& system, const GranularState& state,
                                         const TimeStepping& scheme) {
  if (scheme.boundary_instant == BoundaryInstant::middle) return step_motions(system, state, scheme);
  std::vector<RigidVelocity> motions = boundary_velocities(system, state.time);
  for (std::size_t k = 0; state.step == 0 && k < motions.size(); ++k)
    motions[k] = system.boundaries[k].motion.initial.value_or(motions[k]);
  return motions;
}

GrainMotion start_motion(const StepStart& start, const std::vector<RigidVelocity>& motions, Index grain) {
  const auto& [system, state, interaction, scheme] = start;
  const double radius = system.radius[at(grain)];
  if (system.free(grain)) return motion_of(state, at(grain), radius);
  const auto k = at(system.driven_by[at(grain)]);
  const auto [x, y, z] = velocity_of_point(motions[k], state.poses[k], centre_of(state, at(grain)));
  if (system.boundaries[k].orientation != Orientation::turning) return {x, y, z};
  return {x, y, z, radius * motions[k].spin_x, radius * motions[k].spin_y, radius * motions[k].spin};
}

GrainMotion free_motion(const StepStart& start, const std::vector<RigidVelocity>& motions, Index grain) {
  GrainMotion v = start_motion(start, motions, grain);
  if (!start.system.free(grain)) return v;
  const Place gravity = gravity_of(start.scheme, start.system.dimension);
  for (std::size_t k = 0; k < 3; ++k) v[k] += start.scheme.step * gravity[k];
  return v;
}

StepEnergy energy_of(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  const Place gravity = gravity_of(scheme, system.dimension);
  const double ratio = system.dimension == 2 ? rim_mass_ratio<2> : rim_mass_ratio<3>;
  StepEnergy energy;
  for (std::size_t i = 0; i < at(system.grains()); ++i) {
    if (system.driven_by[i] >= 0) continue;
    const double m = system.mass[i];
    const GrainVelocity<3> v = with_motion<3>(motion_of(state, i, system.radius[i]), 0);
    energy.kinetic += m / 2 * (squared_velocity(v) + squared_rim(v) / ratio);
    energy.potential += m * -dot(gravity, centre_of(state, i));
  }
  return energy;
}

StepEnergy finish_step(const GranularSystem& system, GranularState& state, const TimeStepping& scheme,
                       const std::vector<GrainMotion>& velocities, const ContactWork& work) {
  const double h = scheme.step;
  const StepEnergy before = energy_of(system, state, scheme);
  const auto first = boundary_velocities(system, state.time), motions = step_motions(system, state, scheme);
  const bool at_end = scheme.boundary_instant == BoundaryInstant::end;
  const double whole = at_end ? scheme.theta : 1;  // part of the step with the velocities that contacts see
  const std::vector<Pose> poses = state.poses;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (at_end) state.poses[k] = advanced(poses[k], first[k], (1 - whole) * h, system.dimension);
    state.poses[k] = advanced(state.poses[k], motions[k], whole * h, system.dimension);
  }
  for (std::size_t i = 0; i < at(system.grains()); ++i) {
    GrainMotion old = motion_of(state, i, 1);
    const GrainMotion& v = velocities[i];
    const Index k = system.driven_by[i];
    const double radius = system.radius[i], theta = k < 0 ? scheme.theta : whole;
    if (at_end && k >= 0 && system.boundaries[at(k)].orientation == Orientation::turning)
      old = {0, 0, 0, first[at(k)].spin_x, first[at(k)].spin_y, first[at(k)].spin};
    Place centre = centre_of(state, i), angle;
    for (std::size_t j = 0; j < 3; ++j) angle[j] = h * ((1 - theta) * old[3 + j] + theta * (v[3 + j] / radius));
    if (k >= 0)
      centre = carried(centre, poses[at(k)], state.poses[at(k)]);
    else
      for (std::size_t j = 0; j < 3; ++j) centre[j] += h * ((1 - theta) * old[j] + theta * v[j]);
    move_grain(state, i, centre, angle);
    set_motion(state, i, v, radius);
  }
  ++state.step;
  state.time = static_cast<double>(state.step) * h;
  StepEnergy energy = energy_of(system, state, scheme);
  energy.boundary_work = work.boundary;
  energy.dissipation = work.dissipation;
  energy.numerical =
      energy.kinetic + energy.potential - before.kinetic - before.potential - work.boundary + work.dissipation;
  return energy;
}

}  // namespace nscdd
