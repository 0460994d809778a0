// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/granular_system.hpp"

#include "core/fail.hpp"

namespace nscdd {

void number_bodies(GranularSystem& system) {
  system.free_bodies.clear();
  for (Index k = 0; k < count(system.boundaries); ++k) {
    Boundary& boundary = system.boundaries[at(k)];
    boundary.node = boundary.body ? system.bodies() : -1;
    if (boundary.body) system.free_bodies.push_back(k);
  }
}

std::vector<RigidVelocity> boundary_velocities(const GranularSystem& system, const GranularState& state, double time) {
  std::vector<RigidVelocity> result;
  for (const Boundary& boundary : system.boundaries) result.push_back(boundary.motion.at(time));
  for (const Index k : system.free_bodies)
    take_free(*system.boundaries[at(k)].body, state.body_velocities[at(k)], result[at(k)]);
  return result;
}

GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y,
                            std::vector<double> z) {
  GranularState state;
  for (const auto values : numbers_of_grains(system.dimension)) (state.*values).assign(at(system.grains()), 0.0);
  if (system.dimension == 3) state.turn_w.assign(at(system.grains()), 1.0);
  state.x = std::move(x);
  state.y = std::move(y);
  state.z = std::move(z);
  for (const Boundary& boundary : system.boundaries) {
    const auto& centre = boundary.motion.centre;
    state.poses.push_back({.x = centre[0], .y = centre[1], .z = centre[2]});
  }
  state.body_velocities.resize(system.free_bodies.empty() ? 0 : system.boundaries.size());
  return state;
}

std::vector<std::vector<double> GranularState::*> numbers_of_grains(Index dimension) {
  using State = GranularState;
  if (dimension == 2)
    return {&State::x, &State::y, &State::angle, &State::velocity_x, &State::velocity_y, &State::spin};
  return {&State::x,      &State::y,      &State::z,          &State::turn_w,     &State::turn_x,
          &State::turn_y, &State::turn_z, &State::velocity_x, &State::velocity_y, &State::velocity_z,
          &State::spin_x, &State::spin_y, &State::spin};
}

void set_motion(GranularState& state, std::size_t i, const GrainMotion& v, double radius) {
  state.velocity_x[i] = v[0];
  state.velocity_y[i] = v[1];
  state.spin[i] = v[5] / radius;
  if (state.z.empty()) return;
  state.velocity_z[i] = v[2];
  state.spin_x[i] = v[3] / radius;
  state.spin_y[i] = v[4] / radius;
}

void move_grain(GranularState& state, std::size_t i, const Place& centre, const Place& angle) {
  state.x[i] = centre[0];
  state.y[i] = centre[1];
  if (state.z.empty()) {
    state.angle[i] += angle[2];
    return;
  }
  state.z[i] = centre[2];
  const Eigen::Quaterniond now = turned({state.turn_w[i], state.turn_x[i], state.turn_y[i], state.turn_z[i]}, angle);
  state.turn_w[i] = now.w();
  state.turn_x[i] = now.x();
  state.turn_y[i] = now.y();
  state.turn_z[i] = now.z();
}

void release_grains(GranularSystem& system, GranularState& state) {
  for (std::size_t k = 0; k < system.boundaries.size(); ++k) {
    const auto& source = system.boundaries[k].source;
    const auto next = source ? std::ranges::find(system.driven_by, static_cast<Index>(k)) : system.driven_by.end();
    if (next == system.driven_by.end()) continue;
    const auto grain = next - system.driven_by.begin();
    bool occupied = false;
    for (Index i = 0; i < system.grains() && !occupied; ++i) {
      if (system.waits(i)) continue;
      const double touch = system.radius[at(i)] + system.radius[at(grain)];
      const double near = system.moves(i) && state.step > 0 ? std::max(source->distance, touch) : touch;
      occupied = system.length(system.apart(source->point, centre_of(state, at(i)))) <= near;
    }
    if (occupied) continue;
    *next = -1;
    state.released.push_back(grain);
    move_grain(state, at(grain), source->point, {});
  }
}

void free_released_grains(GranularSystem& system, const GranularState& state) {
  for (const Index grain : state.released) system.driven_by[at(grain)] = -1;
}

std::string body_name(const GranularSystem& system, Index body) {
  if (body >= system.grains())
    return fmt::format("the wall of boundary '{}'",
                       system.boundaries[at(system.walls[at(body - system.grains())].boundary)].name);
  const std::string_view shape = shape_of_grains(system.dimension);
  if (system.free(body)) return fmt::format("{} {}", shape, body);
  return fmt::format("{} {} of boundary '{}'", shape, body, system.boundaries[at(system.driven_by[at(body)])].name);
}

void check(const GranularSystem& system, const GranularState& state) {
  const auto n = at(system.grains());
  const std::string shapes = fmt::format("{}s", shape_of_grains(system.dimension));
  const auto arrays = numbers_of_grains(system.dimension);
  if (system.mass.size() != n)
    fail("granular state: expected {} {}, met an array of {}", n, shapes, system.mass.size());
  for (const auto values : arrays)
    if ((state.*values).size() != n)
      fail("granular state: expected {} {}, met an array of {}", n, shapes, (state.*values).size());
  if (system.driven_by.size() != n || state.poses.size() != system.boundaries.size())
    fail("granular state: expected {} {} and {} boundaries, met {} and {}", system.driven_by.size(), shapes,
         system.boundaries.size(), n, state.poses.size());
  const std::size_t moving = system.free_bodies.empty() ? 0 : system.boundaries.size();
  if (state.body_velocities.size() != moving)
    fail("granular state: expected velocities of {} boundaries, met {}", moving, state.body_velocities.size());
  bool any_free = !system.free_bodies.empty();
  for (std::size_t i = 0; i < n; ++i) {
    const auto name = [&] { return fmt::format("{} {}", shape_of_grains(system.dimension), i); };
    if (system.driven_by[i] >= count(system.boundaries))
      fail("{}: expected one of {} boundaries, met number {}", name(), system.boundaries.size(), system.driven_by[i]);
    any_free = any_free || system.driven_by[i] < 0;
    for (const auto values : arrays)
      if (!std::isfinite((state.*values)[i]))
        fail("{}: expected finite positions and velocities, met {}", name(), (state.*values)[i]);
  }
  if (!any_free) throw Error("granular system: expected a free grain or body, met driven ones only");
  for (const Boundary& boundary : system.boundaries) check(boundary, system.dimension);
  check(system.period, system.radius);
}

}  // namespace nscdd
