// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/granular_system.hpp"

#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nscdd {

GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y) {
  GranularState state;
  const std::vector<double> zero(at(system.disks()), 0.0);
  state.x = std::move(x);
  state.y = std::move(y);
  state.angle = state.velocity_x = state.velocity_y = state.spin = zero;
  for (const Boundary& boundary : system.boundaries)
    state.poses.push_back({boundary.motion.centre[0], boundary.motion.centre[1], 0});
  return state;
}

std::string body_name(const GranularSystem& system, Index body) {
  if (body >= system.disks())
    return fmt::format("the wall of boundary '{}'",
                       system.boundaries[at(system.walls[at(body - system.disks())].boundary)].name);
  if (system.free(body)) return fmt::format("disk {}", body);
  return fmt::format("disk {} of boundary '{}'", body, system.boundaries[at(system.driven_by[at(body)])].name);
}

void check(const GranularSystem& system, const GranularState& state) {
  const auto n = at(system.disks());
  for (const auto* field :
       {&system.mass, &state.x, &state.y, &state.angle, &state.velocity_x, &state.velocity_y, &state.spin})
    if (field->size() != n)
      throw Error(fmt::format("granular state: expected {} disks, met an array of {}", n, field->size()));
  if (system.driven_by.size() != n || state.poses.size() != system.boundaries.size())
    throw Error(fmt::format("granular state: expected {} disks and {} boundaries, met {} and {}",
                            system.driven_by.size(), system.boundaries.size(), n, state.poses.size()));
  bool any_free = false;
  for (std::size_t i = 0; i < n; ++i) {
    if (system.driven_by[i] >= count(system.boundaries))
      throw Error(fmt::format("disk {}: expected one of {} boundaries, met number {}", i, system.boundaries.size(),
                              system.driven_by[i]));
    any_free = any_free || system.driven_by[i] < 0;
    for (const auto* field : {&state.x, &state.y, &state.angle, &state.velocity_x, &state.velocity_y, &state.spin})
      if (!std::isfinite((*field)[i]))
        throw Error(fmt::format("disk {}: expected finite positions and velocities, met {}", i, (*field)[i]));
  }
  if (!any_free) throw Error("granular system: expected a free grain, met driven ones only");
  for (const Boundary& boundary : system.boundaries) check(boundary);
}

ContactLaw contact_law(const Interaction& interaction, double h) {
  ContactLaw law;
  // Tries every alternative; the choices of the field are their names.
  const auto attempt = [&]<class... Laws>(const std::variant<Laws...>&) {
    return ((to_string(interaction.law) == Laws::name && (law = Laws::of(interaction, h), true)) || ...);
  };
  static_cast<void>(attempt(law));
  return law;
}

}  // namespace nscdd
