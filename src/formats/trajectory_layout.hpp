// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5_arrays.hpp"
#include <nscdd/formats/trajectory.hpp>

#include <string>

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

/// Visits the columns of a list of structs: `visit(name, unit, get)` with `get(element)` a reference to the
/// number, double, Index or ContactStatus.
template <class Visit>
void pose_columns(Visit&& visit) {
  visit(
      "x", "m", [](auto& p) -> auto& { return p.x; });
  visit(
      "y", "m", [](auto& p) -> auto& { return p.y; });
  visit(
      "angle", "rad", [](auto& p) -> auto& { return p.angle; });
}

template <class Visit>
void contact_columns(Visit&& visit) {
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
  visit(
      "status", "1", [](auto& c) -> auto& { return c.status; });
  visit(
      "subdomain", "1", [](auto& c) -> auto& { return c.subdomain; });
}

template <class Visit>
void gluing_columns(Visit&& visit) {
  visit(
      "grain", "1", [](auto& g) -> auto& { return g.grain; });
  visit(
      "subdomain", "1", [](auto& g) -> auto& { return g.subdomain; });
  visit(
      "impulse_x", "N s", [](auto& g) -> auto& { return g.x; });
  visit(
      "impulse_y", "N s", [](auto& g) -> auto& { return g.y; });
  visit(
      "impulse_rim", "N s", [](auto& g) -> auto& { return g.rim; });
}

template <class Visit>
void wall_columns(Visit&& visit) {
  visit(
      "point_x", "m", [](auto& w) -> auto& { return w.point[0]; });
  visit(
      "point_y", "m", [](auto& w) -> auto& { return w.point[1]; });
  visit(
      "normal_x", "1", [](auto& w) -> auto& { return w.normal[0]; });
  visit(
      "normal_y", "1", [](auto& w) -> auto& { return w.normal[1]; });
  visit(
      "boundary", "1", [](auto& w) -> auto& { return w.boundary; });
}

/// Type in the file of a number.
inline double stored(double value) { return value; }
inline std::int32_t stored(Index value) { return static_cast<std::int32_t>(value); }
inline std::int8_t stored(ContactStatus value) { return static_cast<std::int8_t>(value); }

}  // namespace nscdd::layout
