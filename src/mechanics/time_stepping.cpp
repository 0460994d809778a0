// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/time_stepping.hpp"

#include "mechanics/connectivity.hpp"
#include "mechanics/contact_blocks.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

#include <numeric>

namespace nscdd {

namespace {

template <int D>
double height_energy(const Direction<D>& gravity, const Direction<D>& place) {  // per mass
  double sum = 0;
  for (std::size_t k = 0; k < D; ++k) sum += gravity[k] * place[k];
  return -sum;
}

template <int D>
StepEnergy energy_in(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  const Direction<D> gravity = gravity_of<D>(scheme);
  StepEnergy energy;
  for (std::size_t i = 0; i < at(system.grains()); ++i) {
    if (system.driven_by[i] >= 0) continue;
    const double m = system.mass[i];
    const GrainVelocity<D> v = with_unknowns(unknowns_of<D>(state, i, system.radius[i]), 0);
    energy.kinetic += m / 2 * (squared_velocity(v) + squared_rim(v) / rim_mass_ratio<D>);
    energy.potential += m * height_energy<D>(gravity, centre_of<D>(state, i));
  }
  return energy;
}

// Angles by which a free grain turns in a step of length h, from its rims before and after, weighted by theta.
template <int D>
std::array<double, D == 2 ? 1 : 3> turning(const GranularState& state, std::size_t i, const GrainUnknowns<D>& after,
                                           double radius, double h, double theta) {
  if constexpr (D == 2) {
    return {h * ((1 - theta) * state.spin[i] + theta * (after[2] / radius))};
  } else {
    return {h * ((1 - theta) * state.spin_x[i] + theta * (after[3] / radius)),
            h * ((1 - theta) * state.spin_y[i] + theta * (after[4] / radius)),
            h * ((1 - theta) * state.spin[i] + theta * (after[5] / radius))};
  }
}

}  // namespace

template <int D>
std::vector<GrainVelocity<D>> velocities_of(const StepProblem<D>& problem,
                                            const std::vector<GrainContact<D>>& contacts) {
  std::vector<GrainVelocity<D>> v = problem.free;
  for (const GrainContact<D>& c : contacts) apply_impulse(c, c.impulse, v);
  return v;
}

StepEnergy energy_of(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  return in_dimension(system, [&](auto dimension) { return energy_in<dimension()>(system, state, scheme); });
}

template <int D>
ContactWork work_of(const StepProblem<D>& problem, const GrainContact<D>& c,
                    const std::vector<GrainVelocity<D>>& velocities) {
  ContactWork work;
  if (!carries(c.impulse)) return work;
  work.dissipation = -dot(c.impulse, relative_velocity(c, problem.start) + relative_velocity(c, velocities)) / 2;
  // Work of the impulses -r on a, r on b at the velocities of those that are driven.
  for (const auto& [body, sign] : {std::pair(c.a, -1.0), std::pair(c.b, 1.0)}) {
    const GrainVelocity<D>& v = velocities[static_cast<std::size_t>(body)];
    if (v.inverse_mass > 0) continue;
    const GrainUnknowns<D> impulse = impulse_on_grain(c.normal, sign, c.impulse), u = unknowns(v);
    work.boundary -= std::inner_product(impulse.begin(), impulse.end(), u.begin(), 0.0);
  }
  return work;
}

template <int D>
std::vector<RememberedImpulse> impulses_to_remember(const StepProblem<D>& problem,
                                                    const std::vector<GrainContact<D>>& contacts) {
  std::vector<RememberedImpulse> impulses;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const GrainContact<D>& c = contacts[k];
    const StepContact& g = problem.geometry[k];
    if (carries(c.impulse)) impulses.push_back({g.a, g.b, to_remember<D>(c.impulse, c.normal)});
  }
  return impulses;
}

template <int D>
StepEnergy finish_step(const GranularSystem& system, GranularState& state, const TimeStepping& scheme,
                       const std::vector<GrainUnknowns<D>>& velocities, const ContactWork& work) {
  const double h = scheme.step, theta = scheme.theta;
  const StepEnergy before = energy_of(system, state, scheme);
  const auto motions = step_motions(system, state, scheme);
  const std::vector<Pose> poses = state.poses;
  for (std::size_t k = 0; k < poses.size(); ++k) state.poses[k] = advanced<D>(poses[k], motions[k], h);
  for (std::size_t i = 0; i < at(system.grains()); ++i) {
    const GrainUnknowns<D>& v = velocities[i];
    const double radius = system.radius[i];
    Direction<D> move;
    if (system.driven_by[i] < 0) {
      const GrainUnknowns<D> old = unknowns_of<D>(state, i, radius);
      for (std::size_t k = 0; k < D; ++k) move[k] = h * ((1 - theta) * old[k] + theta * v[k]);
      move_grain<D>(state, i, move, turning<D>(state, i, v, radius, h, theta));
    } else {
      const auto k = at(system.driven_by[i]);
      const Direction<D> centre = carried(centre_of<D>(state, i), poses[k], state.poses[k]);
      move_grain<D>(state, i, {}, turning<D>(state, i, v, radius, h, 1));
      set_centre<D>(state, i, centre);
    }
    set_velocity<D>(state, i, v, radius);
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

template <int D>
GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<D>>& bodies,
                                       const std::vector<GrainContact<D>>& contacts, std::span<const double> radius) {
  std::vector<BodyRows> rows_of(bodies.size());  // lever arms are radii; walls, which have none, are driven
  std::vector<double> inertia, momentum;
  std::vector<GrainVelocity<D>> driven = bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].inverse_mass == 0) continue;
    rows_of[i] = {count(inertia), radius[i]};
    const double m = 1 / bodies[i].inverse_mass;
    const GrainUnknowns<D> v = unknowns(bodies[i]);
    for (Index k = 0; k < unknowns_of_grain<D>; ++k) {
      const double mass = m * inertia_ratio<D>(k), arm = k < D ? 1 : radius[i];  // v is the speed of the rim
      inertia.push_back(mass * arm * arm);
      momentum.push_back(mass * arm * v[at(k)]);
    }
    driven[i] = with_unknowns(GrainUnknowns<D>{}, bodies[i].inverse_mass);
  }
  const Index rows = count(inertia), size = static_cast<Index>(contacts.size());
  GlobalFrictionProblem problem;
  problem.dimension = D;
  problem.mass = SparseMatrix(Vector::Map(inertia.data(), rows).asDiagonal());
  problem.f = Vector::Map(momentum.data(), rows);
  problem.w.resize(D * size);
  problem.friction.resize(size);
  ConnectivityBuilder<D> h(rows, D * contacts.size());
  for (Index c = 0; c < size; ++c) {
    const GrainContact<D>& k = contacts[at(c)];
    for (const LocalVector<D>& direction : contact_directions<D>())
      h.add(k.normal, rows_of[at(k.a)], rows_of[at(k.b)], direction);
    set_component<D>(problem.w, c, relative_velocity(k, driven) + k.bias);
    problem.friction[c] = k.friction;
  }
  problem.h = h.matrix();
  return problem;
}

template std::vector<GrainVelocity<2>> velocities_of(const StepProblem<2>&, const std::vector<GrainContact<2>>&);
template std::vector<GrainVelocity<3>> velocities_of(const StepProblem<3>&, const std::vector<GrainContact<3>>&);
template ContactWork work_of(const StepProblem<2>&, const GrainContact<2>&, const std::vector<GrainVelocity<2>>&);
template ContactWork work_of(const StepProblem<3>&, const GrainContact<3>&, const std::vector<GrainVelocity<3>>&);
template std::vector<RememberedImpulse> impulses_to_remember(const StepProblem<2>&,
                                                             const std::vector<GrainContact<2>>&);
template std::vector<RememberedImpulse> impulses_to_remember(const StepProblem<3>&,
                                                             const std::vector<GrainContact<3>>&);
template StepEnergy finish_step<2>(const GranularSystem&, GranularState&, const TimeStepping&,
                                   const std::vector<GrainUnknowns<2>>&, const ContactWork&);
template StepEnergy finish_step<3>(const GranularSystem&, GranularState&, const TimeStepping&,
                                   const std::vector<GrainUnknowns<3>>&, const ContactWork&);
template GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<2>>&,
                                                const std::vector<GrainContact<2>>&, std::span<const double>);
template GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<3>>&,
                                                const std::vector<GrainContact<3>>&, std::span<const double>);

}  // namespace nscdd
