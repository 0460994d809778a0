// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/room.hpp"

#include <numeric>

namespace nscdd {
namespace {

constexpr double energy_explosion = 10;
constexpr double large_impulses = 10;  // over what drives the step
constexpr double large_work = 10;      // over the energies of motion
constexpr double closing_part = 0.1;   // of the work of boundaries and pushes

}  // namespace

template <int D>
StepRoom room_of(const Simulation& before, const SolvedStep<D>& step, double pushes, double closing) {
  const TimeStepping& scheme = before.dynamics.time;
  const auto motions = step_motions(before.system, before.state, scheme);
  double mass = 0, at_first = 0, free_flight = 0, in_the_end = 0;  // of all free grains
  double speed_squared = 0;                                        // of the fastest driven body or push
  for (Index i = 0; i < before.system.grains(); ++i) {
    const GrainMotion motion = free_motion(start_of(before), motions, i);
    const GrainVelocity<D> free = with_motion<D>(motion, before.system.inverse_mass(i));
    if (free.inverse_mass == 0) {
      speed_squared = std::max(speed_squared, squared_velocity(free) + squared_rim(free));
      continue;
    }
    const auto kinetic = [&](const GrainMotion& v) { return kinetic_energy(with_motion<D>(v, free.inverse_mass)); };
    mass += 1 / free.inverse_mass;
    at_first += kinetic(motion_of(before.state, at(i), before.system.radius[at(i)]));
    free_flight += kinetic(motion);
    in_the_end += kinetic(step.all_grains[at(i)]);
  }
  for (const GrainVelocity<D>& v : step.problem.start)
    if (v.inverse_mass == 0) speed_squared = std::max(speed_squared, squared_velocity(v) + squared_rim(v));
  for (const GrainContact<D>& c : step.contacts) speed_squared = std::max(speed_squared, squared(c.bias));
  speed_squared = before.processes.maximum(speed_squared);
  const Place gravity = gravity_of(scheme, D);
  const double weight = mass * std::sqrt(dot(gravity, gravity));
  return {.motion = at_first + free_flight + mass * speed_squared / 2,
          .in_the_end = in_the_end,
          .lifting = weight * scheme.step * std::sqrt(speed_squared),
          .pushes = pushes,
          .boundaries = step.work.boundary,
          .closing = closing};
}

bool energy_exploded(const StepRoom& room) {
  const double reference = room.motion + room.pushes;
  return reference > 0 && room.in_the_end > energy_explosion * reference;
}

bool no_room(const StepRoom& room, const ContactResidual& residual) {
  const double work = std::max(0.0, room.boundaries) + room.pushes;
  return std::sqrt(residual.impulses) > large_impulses * residual.scale.driving() &&
         room.closing > closing_part * work && work > large_work * (room.motion + room.lifting);
}

template StepRoom room_of(const Simulation&, const SolvedStep<2>&, double, double);
template StepRoom room_of(const Simulation&, const SolvedStep<3>&, double, double);

}  // namespace nscdd
