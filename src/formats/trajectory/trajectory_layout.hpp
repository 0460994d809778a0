// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/hdf5_file.hpp"
#include "formats/trajectory/trajectory.hpp"

/// Names and units in a trajectory, shared by reader and writer.
namespace nscdd::layout {

/// An array with a number for each grain.
struct StateArray {
  const char* name;
  const char* unit;
  std::vector<double> GranularState::*values;
  Index only = 0;  ///< the only dimension that has it; 0: both
};

inline std::vector<StateArray> state_arrays(Index dimension) {
  using State = GranularState;
  std::vector<StateArray> arrays{{"x", "m", &State::x},
                                 {"y", "m", &State::y},
                                 {"z", "m", &State::z, 3},
                                 {"angle", "rad", &State::angle, 2},
                                 {"turn_w", "1", &State::turn_w, 3},
                                 {"turn_x", "1", &State::turn_x, 3},
                                 {"turn_y", "1", &State::turn_y, 3},
                                 {"turn_z", "1", &State::turn_z, 3},
                                 {"velocity_x", "m/s", &State::velocity_x},
                                 {"velocity_y", "m/s", &State::velocity_y},
                                 {"velocity_z", "m/s", &State::velocity_z, 3},
                                 {"spin_x", "rad/s", &State::spin_x, 3},
                                 {"spin_y", "rad/s", &State::spin_y, 3},
                                 {dimension == 3 ? "spin_z" : "spin", "rad/s", &State::spin}};
  std::erase_if(arrays, [&](const StateArray& one) { return one.only != 0 && one.only != dimension; });
  return arrays;
}

/// Columns of a list of structs: visit(name, unit, get); get(element) points to a double, Index or ContactStatus.
inline constexpr auto state_columns = [](auto&& visit) {
  visit("step", "1", [](auto& state) { return &state.step; });
  visit("time", "s", [](auto& state) { return &state.time; });
  visit("decomposed_at", "1", [](auto& state) { return &state.decomposed_at; });
  visit("eta", "1/kg", [](auto& state) { return &state.eta; });
};

/// Visits NAMEx, NAMEy and, in space, NAMEz: the numbers of the member `array` from `first` on.
void visit_vector(auto&& visit, Index dimension, const std::string& name, const char* unit, auto array,
                  std::size_t first = 0) {
  for (std::size_t k = 0; k < at(dimension); ++k)
    visit((name + "xyz"[k]).c_str(), unit,
          [array, i = first + k](auto& element) { return &std::invoke(array, element)[i]; });
}

inline auto pose_columns(Index dimension) {
  return [space = dimension == 3](auto&& visit) {
    visit("x", "m", [](auto& pose) { return &pose.x; });
    visit("y", "m", [](auto& pose) { return &pose.y; });
    if (!space) return visit("angle", "rad", [](auto& pose) { return &pose.angle; });
    visit("z", "m", [](auto& pose) { return &pose.z; });
    visit("turn_w", "1", [](auto& pose) { return &pose.turn.w(); });
    visit("turn_x", "1", [](auto& pose) { return &pose.turn.x(); });
    visit("turn_y", "1", [](auto& pose) { return &pose.turn.y(); });
    visit("turn_z", "1", [](auto& pose) { return &pose.turn.z(); });
  };
}

inline auto velocity_columns(Index dimension) {
  return [space = dimension == 3](auto&& visit) {
    visit("velocity_x", "m/s", [](auto& v) { return &v.x; });
    visit("velocity_y", "m/s", [](auto& v) { return &v.y; });
    visit(space ? "spin_z" : "spin", "rad/s", [](auto& v) { return &v.spin; });
    if (!space) return;
    visit("velocity_z", "m/s", [](auto& v) { return &v.z; });
    visit("spin_x", "rad/s", [](auto& v) { return &v.spin_x; });
    visit("spin_y", "rad/s", [](auto& v) { return &v.spin_y; });
  };
}

inline auto geometry_columns(Index dimension) {
  return [dimension](auto&& visit) {
    visit("a", "1", [](auto& c) { return &c.geometry.a; });
    visit("b", "1", [](auto& c) { return &c.geometry.b; });
    visit_vector(
        visit, dimension, "normal_", "1", [](auto& c) -> auto& { return c.geometry.normal; });
    visit_vector(
        visit, dimension, "point_", "m", [](auto& c) -> auto& { return c.geometry.point; });
    visit("gap", "m", [](auto& c) { return &c.geometry.gap; });
  };
}

inline auto chain_columns(Index dimension) {
  return [dimension](auto&& visit) {
    visit("step", "1", [](auto& c) { return &c.step; });
    geometry_columns(dimension)(visit);
    visit("self_stress", "1", [](auto& c) { return &c.stress; });
  };
}

inline auto contact_columns(Index dimension) {
  return [dimension, space = dimension == 3](auto&& visit) {
    geometry_columns(dimension)(visit);
    visit("impulse_n", "N s", [](auto& c) { return &c.impulse.n; });
    visit(space ? "impulse_t1" : "impulse_t", "N s", [](auto& c) { return &c.impulse.t; });
    if (space) visit("impulse_t2", "N s", [](auto& c) { return &c.second_tangential; });
    visit("status", "1", [](auto& c) { return &c.status; });
    visit("subdomain", "1", [](auto& c) { return &c.subdomain; });
  };
}

inline auto gluing_columns(Index dimension) {
  return [dimension](auto&& visit) {
    visit("grain", "1", [](auto& gluing) { return &gluing.grain; });
    visit("subdomain", "1", [](auto& gluing) { return &gluing.subdomain; });
    visit_vector(visit, dimension, "impulse_", "N s", &RememberedGluing::impulse);
    if (dimension == 2) return visit("impulse_rim", "N s", [](auto& gluing) { return &gluing.impulse[2]; });
    visit_vector(visit, dimension, "impulse_rim_", "N s", &RememberedGluing::impulse, 3);
  };
}

inline constexpr auto bond_columns = [](auto&& visit) {
  visit("a", "1", [](auto& bond) { return &bond.a; });
  visit("b", "1", [](auto& bond) { return &bond.b; });
  visit("gap", "m", [](auto& bond) { return &bond.gap; });
};

inline constexpr auto start_columns = [](auto&& visit) {
  visit("a", "1", [](auto& one) { return &one.a; });
  visit("b", "1", [](auto& one) { return &one.b; });
  visit("impulse_1", "N s", [](auto& one) { return &one.impulse[0]; });
  visit("impulse_2", "N s", [](auto& one) { return &one.impulse[1]; });
  visit("impulse_3", "N s", [](auto& one) { return &one.impulse[2]; });
  visit("slid", "1", [](auto& one) { return &one.slid; });
};

inline constexpr auto released_columns = [](auto&& visit) { visit("grain", "1", [](auto& grain) { return &grain; }); };

inline constexpr auto model_columns = [](auto&& visit) {
  visit("switched", "1", [](auto& model) { return &model.switched; });
  visit("standing", "1", [](auto& model) { return &model.standing; });
  visit("switched_iterations", "1", [](auto& model) { return &model.switched_iterations; });
  visit("switch_backs", "1", [](auto& model) { return &model.switch_backs; });
  visit("velocity_distance", "m/s", [](auto& model) { return &model.velocity_distance; });
  visit("impulse_distance", "1", [](auto& model) { return &model.impulse_distance; });
};

/// `radii`, `lengths`: whether the walls of a system have any, and so columns; in space all have radii.
inline auto wall_columns(Index dimension, bool radii, bool lengths) {
  return [dimension, space = dimension == 3, radii, lengths](auto&& visit) {
    visit_vector(visit, dimension, "point_", "m", &Wall::point);
    visit_vector(visit, dimension, "normal_", "1", &Wall::normal);
    if (space || radii) visit("radius", "m", [](auto& wall) { return &wall.radius; });
    if (lengths) {
      visit_vector(visit, dimension, "axis_", "1", &Wall::axis);
      visit("half_length", "m", [](auto& wall) { return &wall.half_length; });
      if (space) visit("half_width", "m", [](auto& wall) { return &wall.half_width; });
    }
    visit("boundary", "1", [](auto& wall) { return &wall.boundary; });
  };
}

/// A number in its type in the file.
inline double stored(double value) { return value; }
inline std::int32_t stored(Index value) { return static_cast<std::int32_t>(value); }
inline std::int8_t stored(bool value) { return value ? 1 : 0; }
inline std::int8_t stored(ContactStatus value) { return static_cast<std::int8_t>(value); }

}  // namespace nscdd::layout
