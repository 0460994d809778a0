// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/time_stepping.hpp"

#include "mechanics/connectivity.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

std::vector<DiskVelocity> velocities_of(const StepProblem& problem, std::span<const DiskContact> contacts) {
  std::vector<DiskVelocity> v = problem.free;
  for (const DiskContact& c : contacts) apply_impulse(c, c.impulse, v);
  return v;
}

StepEnergy energy_of(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  StepEnergy energy;
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    const double m = system.mass[at(i)], rim = system.radius[at(i)] * state.spin[at(i)];
    energy.kinetic += m / 2 *
                      (state.velocity_x[at(i)] * state.velocity_x[at(i)] +
                       state.velocity_y[at(i)] * state.velocity_y[at(i)] + rim * rim / rim_mass_ratio);
    energy.potential -= m * (scheme.gravity[0] * state.x[at(i)] + scheme.gravity[1] * state.y[at(i)]);
  }
  return energy;
}

StepEnergy finish_step(const GranularSystem& system, GranularState& state, const StepProblem& problem,
                       const TimeStepping& scheme, std::span<const DiskContact> contacts,
                       std::span<const DiskVelocity> velocities) {
  const double h = problem.h, theta = scheme.theta;
  const StepEnergy before = energy_of(system, state, scheme);
  const auto motions = boundary_velocities(system, state.time + h / 2);
  const std::vector<Pose> poses = state.poses;
  for (std::size_t k = 0; k < poses.size(); ++k) state.poses[k] = advanced(poses[k], motions[k], h);
  for (std::size_t i = 0; i < at(system.disks()); ++i) {
    const DiskVelocity& v = velocities[i];
    const double spin = v.rim / system.radius[i];
    if (system.driven_by[i] < 0) {
      state.x[i] += h * ((1 - theta) * state.velocity_x[i] + theta * v.x);
      state.y[i] += h * ((1 - theta) * state.velocity_y[i] + theta * v.y);
      state.angle[i] += h * ((1 - theta) * state.spin[i] + theta * spin);
    } else {
      const auto k = at(system.driven_by[i]);
      const auto centre = carried({state.x[i], state.y[i]}, poses[k], state.poses[k]);
      state.x[i] = centre[0];
      state.y[i] = centre[1];
      state.angle[i] += h * spin;
    }
    state.velocity_x[i] = v.x;
    state.velocity_y[i] = v.y;
    state.spin[i] = spin;
  }
  state.impulses.clear();
  double boundary_work = 0, dissipation = 0;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const DiskContact& c = contacts[k];
    if (c.impulse.n == 0 && c.impulse.t == 0) continue;
    const StepContact& g = problem.geometry[k];
    state.impulses.push_back({g.a, g.b, c.impulse});
    dissipation -= dot(c.impulse, relative_velocity(c, problem.start) + relative_velocity(c, velocities)) / 2;
    // Work of the impulses -r on a, r on b at the velocities of those that are driven.
    for (const auto& [body, sign] : {std::pair(c.a, -1.0), std::pair(c.b, 1.0)}) {
      const DiskVelocity& v = velocities[static_cast<std::size_t>(body)];
      if (v.inverse_mass > 0) continue;
      const auto impulse = impulse_on_grain(c.normal, sign, c.impulse);
      boundary_work -= impulse[0] * v.x + impulse[1] * v.y + impulse[2] * v.rim;
    }
  }
  ++state.step;
  state.time = static_cast<double>(state.step) * h;
  StepEnergy energy = energy_of(system, state, scheme);
  energy.boundary_work = boundary_work;
  energy.dissipation = dissipation;
  energy.numerical =
      energy.kinetic + energy.potential - before.kinetic - before.potential - boundary_work + dissipation;
  return energy;
}

GlobalFrictionProblem friction_problem(std::span<const DiskVelocity> bodies, std::span<const DiskContact> contacts,
                                       std::span<const double> radius) {
  std::vector<BodyRows> rows_of(bodies.size());  // lever arms are radii; walls, which have none, are driven
  std::vector<double> inertia, momentum;
  std::vector<DiskVelocity> driven(bodies.begin(), bodies.end());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const DiskVelocity& v = bodies[i];
    if (v.inverse_mass == 0) continue;
    rows_of[i] = {count(inertia), radius[i]};
    const double m = 1 / v.inverse_mass, rim_mass = m / rim_mass_ratio;
    inertia.insert(inertia.end(), {m, m, rim_mass * radius[i] * radius[i]});
    momentum.insert(momentum.end(), {m * v.x, m * v.y, rim_mass * radius[i] * v.rim});
    driven[i].x = driven[i].y = driven[i].rim = 0;
  }
  const Index rows = count(inertia), size = static_cast<Index>(contacts.size());
  GlobalFrictionProblem problem;
  problem.mass = SparseMatrix(Vector::Map(inertia.data(), rows).asDiagonal());
  problem.f = Vector::Map(momentum.data(), rows);
  problem.w.resize(2 * size);
  problem.friction.resize(size);
  ConnectivityBuilder<2> h(rows, 2 * contacts.size());
  for (Index c = 0; c < size; ++c) {
    const DiskContact& k = contacts[at(c)];
    for (const LocalVector<2>& direction : contact_directions<2>())
      h.add(k.normal, rows_of[at(k.a)], rows_of[at(k.b)], direction);
    const LocalVector<2> w = relative_velocity(k, driven) + k.bias;
    problem.w.segment<2>(2 * c) << w.n, w.t;
    problem.friction[c] = k.friction;
  }
  problem.h = h.matrix();
  return problem;
}

}  // namespace nscdd
