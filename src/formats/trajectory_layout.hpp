// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5_file.hpp"
#include "formats/trajectory.hpp"

#include <fmt/format.h>

#include <functional>
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

/// The number of a struct within another one, or within an array of two, as `get` of a column.
template <class Whole, class Part, class Number>
auto within(Part Whole::*part, Number Part::*number) {
  return [=](auto& whole) -> auto& { return whole.*part.*number; };
}
template <class Whole, class Part, class Pair>
auto within(Part Whole::*part, Pair Part::*pair, std::size_t i) {
  return [=](auto& whole) -> auto& { return (whole.*part.*pair)[i]; };
}
template <class Whole, class Pair>
auto entry(Pair Whole::*pair, std::size_t i) {
  return [=](auto& whole) -> auto& { return (whole.*pair)[i]; };
}

/// Visits the columns of a list of structs: `visit(name, unit, get)`, where std::invoke(get, element) is a
/// reference to the number, double, Index or ContactStatus.
inline constexpr auto pose_columns = [](auto&& visit) {
  visit("x", "m", &Pose::x);
  visit("y", "m", &Pose::y);
  visit("angle", "rad", &Pose::angle);
};

inline constexpr auto contact_columns = [](auto&& visit) {
  constexpr auto geometry = &TrajectoryContact::geometry;
  visit("a", "1", within(geometry, &StepContact::a));
  visit("b", "1", within(geometry, &StepContact::b));
  visit("normal_x", "1", within(geometry, &StepContact::normal, 0));
  visit("normal_y", "1", within(geometry, &StepContact::normal, 1));
  visit("point_x", "m", within(geometry, &StepContact::point, 0));
  visit("point_y", "m", within(geometry, &StepContact::point, 1));
  visit("gap", "m", within(geometry, &StepContact::gap));
  visit("impulse_n", "N s", within(&TrajectoryContact::impulse, &LocalVector::n));
  visit("impulse_t", "N s", within(&TrajectoryContact::impulse, &LocalVector::t));
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
  visit("point_x", "m", entry(&Wall::point, 0));
  visit("point_y", "m", entry(&Wall::point, 1));
  visit("normal_x", "1", entry(&Wall::normal, 0));
  visit("normal_y", "1", entry(&Wall::normal, 1));
  visit("boundary", "1", &Wall::boundary);
};

/// Name of the group of a kept step.
inline std::string step_name(Index step) { return fmt::format("{:06}", step); }

/// Type in the file of a number.
inline double stored(double value) { return value; }
inline std::int32_t stored(Index value) { return static_cast<std::int32_t>(value); }
inline std::int8_t stored(ContactStatus value) { return static_cast<std::int8_t>(value); }

}  // namespace nscdd::layout
