// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/time_stepping.hpp"

namespace nscdd {

Place gravity_of(const TimeStepping& scheme, Index dimension) {
  const Components<double>& g = scheme.gravity;
  if (dimension == 3 && g == TimeStepping().gravity) return {0, 0, g[1]};
  return {g[0], g[1], g[2]};
}

namespace {

// (1 - theta) F(t) + theta F(t + h), weight included, N and N m. `pose`: where contacts are found.
RigidVelocity mean_load(const FreeBody& body, double time, const TimeStepping& scheme, Index dimension,
                        const Pose& pose) {
  const RigidVelocity begin = body.load.at(time), end = body.load.at(time + scheme.step);
  const Place g = gravity_of(scheme, dimension);
  const RigidVelocity weight{body.mass * g[0], body.mass * g[1], 0, body.mass * g[2]};
  const RigidVelocity load = sum(sum(weight, 1 - scheme.theta, begin), scheme.theta, end);
  if (!body.torque_turns) return load;
  const Eigen::Vector3d torque = principal_axes(body, pose) * Eigen::Vector3d(load.spin_x, load.spin_y, load.spin);
  return {load.x, load.y, torque[2], load.z, torque[0], torque[1]};
}

// Sets the spin that keeps the angular momentum of v, plus a given one, N m s, when the turn of a body changes.
void set_spin_after(RigidVelocity& result, const FreeBody& body, const RigidVelocity& v, const Pose& before,
                    const Pose& after, const Eigen::Vector3d& added) {
  const Eigen::Vector3d inertia(body.inertia.data());
  const Eigen::Matrix3d from = principal_axes(body, before), to = principal_axes(body, after);
  const Eigen::Vector3d own = from.transpose() * Eigen::Vector3d(v.spin_x, v.spin_y, v.spin);
  const Eigen::Vector3d momentum = from * inertia.cwiseProduct(own) + added;
  const Eigen::Vector3d spin = to * (to.transpose() * momentum).cwiseQuotient(inertia);
  result.spin_x = spin[0];
  result.spin_y = spin[1];
  result.spin = spin[2];
}

// V^- + h M^-1 F of a body, along all directions.
RigidVelocity pushed(const FreeBody& body, const RigidVelocity& v, const RigidVelocity& load, double h,
                     const Pose& before, const Pose& after, Index dimension) {
  RigidVelocity result = sum(v, h / body.mass, load);
  if (dimension == 2)
    result.spin = v.spin + (body.free(BodyDirection::spin) ? h * load.spin / body.inertia[2] : 0);
  else if (body.free(BodyDirection::spin))
    set_spin_after(result, body, v, before, after, h * Eigen::Vector3d(load.spin_x, load.spin_y, load.spin));
  return result;
}

// Work of the loads on bodies in a step, without their weight, J, at the mean of both velocities.
double work_of_loads(const StepStart& start, const std::vector<RigidVelocity>& before,
                     const std::vector<RigidVelocity>& after) {
  const auto& [system, state, interaction, scheme] = start;
  TimeStepping weightless = scheme;
  weightless.gravity = {0, 0, 0};
  const std::vector<Pose> poses = poses_at_contacts(start);
  double work = 0;
  for (const Index k : system.free_bodies) {
    const FreeBody& body = *system.boundaries[at(k)].body;
    RigidVelocity load, twice;
    take_free(body, mean_load(body, state.time, weightless, system.dimension, poses[at(k)]), load);
    take_free(body, sum(before[at(k)], 1, after[at(k)]), twice);
    work += scheme.step / 2 *
            (load.x * twice.x + load.y * twice.y + load.z * twice.z + load.spin_x * twice.spin_x +
             load.spin_y * twice.spin_y + load.spin * twice.spin);
  }
  return work;
}

// The velocity of a body along its free directions when its pose has gone on from where contacts were found.
RigidVelocity velocity_to_keep(const FreeBody& body, const RigidVelocity& v, const Pose& at_contacts, const Pose& now,
                               Index dimension) {
  RigidVelocity turned = v, kept;
  if (dimension == 3 && body.free(BodyDirection::spin))
    set_spin_after(turned, body, v, at_contacts, now, Eigen::Vector3d::Zero());
  take_free(body, turned, kept);
  return kept;
}

// Moves bodies with free directions and their grains into a periodic cell; returns their change of potential energy, J.
double keep_bodies_in_cell(const GranularSystem& system, GranularState& state, const Place& gravity) {
  if (!system.period.any()) return 0;
  double lifted = 0;
  std::vector<Place> steps(state.poses.size(), Place{0, 0, 0});
  for (const Index k : system.free_bodies) {
    Pose& pose = state.poses[at(k)];
    const Place step = steps[at(k)] = system.period.into_cell(pose.place());
    pose.x += step[0];
    pose.y += step[1];
    const FreeBody& body = *system.boundaries[at(k)].body;
    for (std::size_t j = 0; j < 3; ++j)
      if (body.directions[j]) lifted -= body.mass * gravity[j] * step[j];
  }
  for (std::size_t i = 0; i < at(system.grains()); ++i)
    if (const Index k = system.driven_by[i]; k >= 0) {
      state.x[i] += steps[at(k)][0];
      state.y[i] += steps[at(k)][1];
    }
  return lifted;
}

}  // namespace

std::vector<Pose> poses_at_contacts(const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  const std::vector<RigidVelocity> first = first_motions(start);
  std::vector<Pose> poses = state.poses;
  for (std::size_t k = 0; k < poses.size(); ++k)
    poses[k] = advanced(poses[k], first[k], (1 - scheme.theta) * scheme.step, system.dimension);
  return poses;
}

std::vector<RigidVelocity> step_motions(const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  const bool at_end = scheme.boundary_instant == BoundaryInstant::end;
  const double instant = state.time + (at_end ? scheme.step : scheme.step / 2);
  std::vector<RigidVelocity> motions = boundary_velocities(system, state, instant);
  if (system.free_bodies.empty()) return motions;
  const std::vector<Pose> poses = poses_at_contacts(start);
  for (const Index k : system.free_bodies) {
    const FreeBody& body = *system.boundaries[at(k)].body;
    take_free(body,
              pushed(body, motions[at(k)], mean_load(body, state.time, scheme, system.dimension, poses[at(k)]),
                     scheme.step, state.poses[at(k)], poses[at(k)], system.dimension),
              motions[at(k)]);
  }
  return motions;
}

std::vector<RigidVelocity> first_motions(const StepStart& start) {
  const auto& [system, state, interaction, scheme] = start;
  if (scheme.boundary_instant == BoundaryInstant::middle)
    return boundary_velocities(system, state, state.time + scheme.step / 2);
  std::vector<RigidVelocity> motions = boundary_velocities(system, state, state.time);
  for (std::size_t k = 0; state.step == 0 && k < motions.size(); ++k) {
    const RigidVelocity now = motions[k];
    motions[k] = system.boundaries[k].motion.initial.value_or(now);
    if (system.boundaries[k].body) take_free(*system.boundaries[k].body, now, motions[k]);
  }
  return motions;
}

std::vector<RigidVelocity> with_free_bodies(const StepStart& start, std::vector<RigidVelocity> motions,
                                            const std::vector<GrainMotion>& velocities) {
  const GranularSystem& system = start.system;
  if (system.free_bodies.empty()) return motions;
  const std::vector<Pose> poses = poses_at_contacts(start);
  for (const Index k : system.free_bodies) {
    const FreeBody& body = *system.boundaries[at(k)].body;
    const GrainMotion& motion = velocities[at(system.boundaries[at(k)].node)];
    take_free(body, rigid_velocity(body, poses[at(k)], motion, system.dimension), motions[at(k)]);
  }
  return motions;
}

GrainMotion start_motion(const StepStart& start, const std::vector<Pose>& poses,
                         const std::vector<RigidVelocity>& motions, Index grain) {
  const auto& [system, state, interaction, scheme] = start;
  if (grain >= system.grains()) {
    const Index k = system.free_bodies[at(grain - system.grains())];
    return motion_of(*system.boundaries[at(k)].body, poses[at(k)], motions[at(k)], system.dimension);
  }
  const double radius = system.radius[at(grain)];
  if (system.free(grain)) return motion_of(state, at(grain), radius);
  const auto k = at(system.driven_by[at(grain)]);
  const Place centre = carried(centre_of(state, at(grain)), state.poses[k], poses[k]);
  const auto [x, y, z] = velocity_of_point(motions[k], poses[k], centre);
  if (system.boundaries[k].orientation != Orientation::turning) return {x, y, z};
  return {x, y, z, radius * motions[k].spin_x, radius * motions[k].spin_y, radius * motions[k].spin};
}

GrainMotion free_motion(const StepStart& start, const std::vector<Pose>& poses,
                        const std::vector<RigidVelocity>& motions, Index grain) {
  GrainMotion v = start_motion(start, poses, motions, grain);
  if (grain >= start.system.grains() || !start.system.free(grain)) return v;
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
  for (const Index k : system.free_bodies) {
    const FreeBody& body = *system.boundaries[at(k)].body;
    const Pose& pose = state.poses[at(k)];
    const GrainMotion v = motion_of(body, pose, state.body_velocities[at(k)], system.dimension);
    const Place centre = pose.place();
    for (std::size_t j = 0; j < 6; ++j) energy.kinetic += body.mass / 2 * v[j] * v[j] / (j < 3 ? 1 : ratio);
    for (std::size_t j = 0; j < 3; ++j)
      if (body.directions[j]) energy.potential -= body.mass * gravity[j] * centre[j];
  }
  return energy;
}

StepEnergy finish_step(const StepStart& start, GranularState& state, const std::vector<GrainMotion>& velocities,
                       const ContactWork& work) {
  const GranularSystem& system = start.system;
  const TimeStepping& scheme = start.scheme;
  const double h = scheme.step;
  const StepEnergy before = energy_of(system, state, scheme);
  const bool at_end = scheme.boundary_instant == BoundaryInstant::end;
  const auto first = boundary_velocities(system, state, at_end ? state.time : state.time + h / 2);
  const auto motions = with_free_bodies(start, step_motions(start), velocities);
  const Place gravity = gravity_of(scheme, system.dimension);
  double lifted = 0;  // J, of grains that enter a periodic cell at its other end
  const double loads = system.free_bodies.empty() ? 0 : work_of_loads(start, first, motions);
  // Part of the step in which a boundary has the velocity that contacts see.
  const auto whole = [&](std::size_t k) { return at_end || system.boundaries[k].body ? scheme.theta : 1; };
  const std::vector<Pose> poses = state.poses;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    if (whole(k) < 1) state.poses[k] = advanced(poses[k], first[k], (1 - whole(k)) * h, system.dimension);
    const Pose at_contacts = state.poses[k];
    state.poses[k] = advanced(at_contacts, motions[k], whole(k) * h, system.dimension);
    if (const auto& body = system.boundaries[k].body)
      state.body_velocities[k] = velocity_to_keep(*body, motions[k], at_contacts, state.poses[k], system.dimension);
  }
  for (std::size_t i = 0; i < at(system.grains()); ++i) {
    const GrainMotion old = motion_of(state, i, 1);
    const GrainMotion& v = velocities[i];
    const double radius = system.radius[i], theta = scheme.theta;
    Place centre = centre_of(state, i), angle{0, 0, 0};
    if (const Index k = system.driven_by[i]; k >= 0) {
      centre = carried(centre, poses[at(k)], state.poses[at(k)]);
      if (system.boundaries[at(k)].orientation == Orientation::turning)
        angle = rotation_between(poses[at(k)], state.poses[at(k)]);
    } else {
      for (std::size_t j = 0; j < 3; ++j) {
        centre[j] += h * ((1 - theta) * old[j] + theta * v[j]);
        angle[j] = h * ((1 - theta) * old[3 + j] + theta * (v[3 + j] / radius));
      }
      const Place step = system.period.into_cell(centre);
      centre = moved_along(centre, 1, step);
      lifted -= system.mass[i] * dot(gravity, step);
    }
    move_grain(state, i, centre, angle);
    set_motion(state, i, v, radius);
  }
  lifted += keep_bodies_in_cell(system, state, gravity);
  ++state.step;
  state.time = static_cast<double>(state.step) * h;
  StepEnergy energy = energy_of(system, state, scheme);
  energy.boundary_work = work.boundary + loads;
  energy.dissipation = work.dissipation;
  energy.numerical = energy.kinetic + energy.potential - before.kinetic - before.potential - energy.boundary_work +
                     work.dissipation - lifted;
  return energy;
}

}  // namespace nscdd
