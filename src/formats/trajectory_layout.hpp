// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5_file.hpp"
#include "formats/trajectory.hpp"

/// Names and units of a trajectory, the same for writing and for reading.
namespace nscdd::layout {

struct StateArray {
  const char* name;
  const char* unit;
  std::vector<double> GranularState::*values;
};
inline constexpr StateArray state_arrays[] = {{"x", "m", &GranularState::x},
                                              {"y", "m", &GranularState::y},
                                              {"angle", "rad", &GranularState::angle},
                                              {"velocity_x", "m/s", &GranularState::velocity_x},
                                              {"velocity_y", "m/s", &GranularState::velocity_y},
                                              {"spin", "rad/s", &GranularState::spin}};

/// Columns of a list of structs: visit(name, unit, get); get(element) points to a double, Index or ContactStatus.
inline constexpr auto state_columns = [](auto&& visit) {
  visit("step", "1", [](auto& state) { return &state.step; });
  visit("time", "s", [](auto& state) { return &state.time; });
  visit("decomposed_at", "1", [](auto& state) { return &state.decomposed_at; });
  visit("eta", "1/kg", [](auto& state) { return &state.eta; });
};

inline constexpr auto pose_columns = [](auto&& visit) {
  visit("x", "m", [](auto& pose) { return &pose.x; });
  visit("y", "m", [](auto& pose) { return &pose.y; });
  visit("angle", "rad", [](auto& pose) { return &pose.angle; });
};

inline constexpr auto contact_columns = [](auto&& visit) {
  visit("a", "1", [](auto& c) { return &c.geometry.a; });
  visit("b", "1", [](auto& c) { return &c.geometry.b; });
  visit("normal_x", "1", [](auto& c) { return &c.geometry.normal[0]; });
  visit("normal_y", "1", [](auto& c) { return &c.geometry.normal[1]; });
  visit("point_x", "m", [](auto& c) { return &c.geometry.point[0]; });
  visit("point_y", "m", [](auto& c) { return &c.geometry.point[1]; });
  visit("gap", "m", [](auto& c) { return &c.geometry.gap; });
  visit("impulse_n", "N s", [](auto& c) { return &c.impulse.n; });
  visit("impulse_t", "N s", [](auto& c) { return &c.impulse.t; });
  visit("status", "1", [](auto& c) { return &c.status; });
  visit("subdomain", "1", [](auto& c) { return &c.subdomain; });
};

inline constexpr auto gluing_columns = [](auto&& visit) {
  visit("grain", "1", [](auto& gluing) { return &gluing.grain; });
  visit("subdomain", "1", [](auto& gluing) { return &gluing.subdomain; });
  visit("impulse_x", "N s", [](auto& gluing) { return &gluing.x; });
  visit("impulse_y", "N s", [](auto& gluing) { return &gluing.y; });
  visit("impulse_rim", "N s", [](auto& gluing) { return &gluing.rim; });
};

inline constexpr auto model_columns = [](auto&& visit) {
  visit("switched", "1", [](auto& model) { return &model.switched; });
  visit("standing", "1", [](auto& model) { return &model.standing; });
  visit("switched_iterations", "1", [](auto& model) { return &model.switched_iterations; });
  visit("switch_backs", "1", [](auto& model) { return &model.switch_backs; });
  visit("velocity_distance", "m/s", [](auto& model) { return &model.velocity_distance; });
  visit("impulse_distance", "1", [](auto& model) { return &model.impulse_distance; });
};

inline constexpr auto wall_columns = [](auto&& visit) {
  visit("point_x", "m", [](auto& wall) { return &wall.point[0]; });
  visit("point_y", "m", [](auto& wall) { return &wall.point[1]; });
  visit("normal_x", "1", [](auto& wall) { return &wall.normal[0]; });
  visit("normal_y", "1", [](auto& wall) { return &wall.normal[1]; });
  visit("boundary", "1", [](auto& wall) { return &wall.boundary; });
};

/// Type in the file of a number.
inline double stored(double value) { return value; }
inline std::int32_t stored(Index value) { return static_cast<std::int32_t>(value); }
inline std::int8_t stored(ContactStatus value) { return static_cast<std::int8_t>(value); }

}  // namespace nscdd::layout
