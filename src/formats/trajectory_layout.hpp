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

/// Each visits the columns of a list of structs: `visit(name, unit, get)`, where std::invoke(get, element) is a
/// reference to the number, double, Index or ContactStatus.
inline constexpr auto state_columns = [](auto&& visit) {
  visit("step", "1", &GranularState::step);
  visit("time", "s", &GranularState::time);
  visit("decomposed_at", "1", &GranularState::decomposed_at);
  visit("eta", "1/kg", &GranularState::eta);
};

inline constexpr auto pose_columns = [](auto&& visit) {
  visit("x", "m", &Pose::x);
  visit("y", "m", &Pose::y);
  visit("angle", "rad", &Pose::angle);
};

inline constexpr auto contact_columns = [](auto&& visit) {
  visit(
      "a", "1", [](auto& c) -> auto& { return c.geometry.a; });
  visit(
      "b", "1", [](auto& c) -> auto& { return c.geometry.b; });
  visit(
      "normal_x", "1", [](auto& c) -> auto& { return c.geometry.normal[0]; });
  visit(
      "normal_y", "1", [](auto& c) -> auto& { return c.geometry.normal[1]; });
  visit(
      "point_x", "m", [](auto& c) -> auto& { return c.geometry.point[0]; });
  visit(
      "point_y", "m", [](auto& c) -> auto& { return c.geometry.point[1]; });
  visit(
      "gap", "m", [](auto& c) -> auto& { return c.geometry.gap; });
  visit(
      "impulse_n", "N s", [](auto& c) -> auto& { return c.impulse.n; });
  visit(
      "impulse_t", "N s", [](auto& c) -> auto& { return c.impulse.t; });
  visit("status", "1", &TrajectoryContact::status);
  visit("subdomain", "1", &TrajectoryContact::subdomain);
};

inline constexpr auto gluing_columns = [](auto&& visit) {
  visit("grain", "1", &RememberedGluing::grain);
  visit("subdomain", "1", &RememberedGluing::subdomain);
  visit("impulse_x", "N s", &RememberedGluing::x);
  visit("impulse_y", "N s", &RememberedGluing::y);
  visit("impulse_rim", "N s", &RememberedGluing::rim);
};

inline constexpr auto wall_columns = [](auto&& visit) {
  visit(
      "point_x", "m", [](auto& wall) -> auto& { return wall.point[0]; });
  visit(
      "point_y", "m", [](auto& wall) -> auto& { return wall.point[1]; });
  visit(
      "normal_x", "1", [](auto& wall) -> auto& { return wall.normal[0]; });
  visit(
      "normal_y", "1", [](auto& wall) -> auto& { return wall.normal[1]; });
  visit("boundary", "1", &Wall::boundary);
};

/// Type in the file of a number.
inline double stored(double value) { return value; }
inline std::int32_t stored(Index value) { return static_cast<std::int32_t>(value); }
inline std::int8_t stored(ContactStatus value) { return static_cast<std::int8_t>(value); }

}  // namespace nscdd::layout
