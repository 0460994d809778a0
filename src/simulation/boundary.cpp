// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/boundary.hpp"

#include "core/fail.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

Place along(const BoundarySpec& spec) { return difference(spec.to, spec.from); }

double length_of(const Place& vector) { return std::hypot(vector[0], vector[1], vector[2]); }

Place unit(const Place& vector) { return divided(vector, length_of(vector)); }

bool is_plane_in_space(const BoundarySpec& spec) { return spec.shape == BoundaryShape::wall && spec.dimension == 3; }
bool is_plank_in_space(const BoundarySpec& spec) { return spec.shape == BoundaryShape::plank && spec.dimension == 3; }
bool is_circle(const BoundarySpec& spec) { return spec.shape == BoundaryShape::cylinder && spec.dimension == 2; }

Wall wall_of(const BoundarySpec& spec, Index boundary) {
  if (is_plane_in_space(spec)) return {.point = spec.point, .normal = unit(spec.normal), .boundary = boundary};
  if (spec.shape == BoundaryShape::cylinder)
    return {.point = moved_along(spec.from, spec.ends ? 0.5 : 0, along(spec)),
            .normal = is_circle(spec) ? Place{0, 0, 1} : unit(along(spec)),
            .boundary = boundary,
            .radius = spec.side == CylinderSide::inside ? spec.radius : -spec.radius,
            .half_length = spec.ends ? length_of(along(spec)) / 2 : 0};
  if (is_plank_in_space(spec))
    return {.point = spec.point,
            .normal = unit(spec.normal),
            .boundary = boundary,
            .radius = spec.radius,
            .axis = unit(spec.axis),
            .half_length = spec.length / 2,
            .half_width = spec.width / 2};
  const double length = length_of(along(spec));
  const Place normal{(spec.from[1] - spec.to[1]) / length, (spec.to[0] - spec.from[0]) / length, 0};
  if (spec.shape != BoundaryShape::plank) return {.point = spec.from, .normal = normal, .boundary = boundary};
  return {.point = {(spec.from[0] + spec.to[0]) / 2, (spec.from[1] + spec.to[1]) / 2, 0},
          .normal = normal,
          .boundary = boundary,
          .radius = spec.radius,
          .axis = unit(along(spec)),
          .half_length = length / 2};
}

void add_disks(GranularSystem& system, std::vector<double>& x, std::vector<double>& y, const BoundarySpec& spec,
               Index boundary) {
  const Index gaps = disks_in(spec) - 1;
  for (Index k = 0; k <= gaps; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(gaps);
    const Place centre = moved_along(spec.from, s, along(spec));
    x.push_back(centre[0]);
    y.push_back(centre[1]);
    system.radius.push_back(spec.radius);
    system.mass.push_back(1);
    system.driven_by.push_back(boundary);
  }
}

std::string grains_key(const BoundarySpec& spec, Index boundary) {
  return fmt::format("boundary[{}].{}", boundary, spec.grains.empty() ? "first" : "grains");
}

void drive_grains(GranularSystem& system, const BoundarySpec& spec, Index number, Index boundary, Index grains) {
  for (const Index i : grains_of(spec, number, grains)) {
    if (system.driven_by[at(i)] >= 0)
      throw Error(grains_key(spec, number),
                  fmt::format("expected grains driven once, met grain {} of boundaries '{}' and '{}'", i,
                              system.boundaries[at(system.driven_by[at(i)])].name, spec.name));
    system.driven_by[at(i)] = boundary;
  }
}

std::string components_text(const Place& values, bool space) {
  return space ? field_text(Components<double>(values)) : field_text(Components<double>(values[0], values[1]));
}

std::string velocity_lines(const RigidVelocity& v, bool space, const FunctionKeys& keys, const char* before = "") {
  return fmt::format("{0}{1} = {2}\n{0}{3} = {4}\n", before, keys.linear, components_text({v.x, v.y, v.z}, space),
                     keys.angular, space ? components_text({v.spin_x, v.spin_y, v.spin}, true) : field_text(v.spin));
}

std::string motion_entry(double time, const RigidVelocity& v, bool space) {
  std::vector<double> entry{time, v.x, v.y, v.spin};
  if (space) entry = {time, v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin};
  std::vector<std::string> numbers;
  for (const double number : entry) numbers.push_back(field_text(number));
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string function_lines(const Motion& motion, const FunctionKeys& keys, bool space) {
  std::string text;
  std::vector<std::string> entries;
  for (std::size_t k = 0; k < motion.velocity.size(); ++k)
    entries.push_back(motion_entry(motion.time[k], motion.velocity[k], space));
  if (entries.size() == 1 && motion.time.front() == 0)
    text += velocity_lines(motion.velocity.front(), space, keys);
  else if (!entries.empty())
    text += fmt::format("{} = [{}]\n", keys.table, fmt::join(entries, ", "));
  if (motion.initial) text += velocity_lines(*motion.initial, space, keys, "initial_");
  return text;
}

std::string oscillation_lines(const Motion& motion, const FunctionKeys& keys, bool space) {
  std::string text;
  for (const Oscillation& one : motion.oscillations)
    text += fmt::format("[[boundary.{}]]\nomega = {}\nphase = {}\nramp = {}\ngrowth = {}\n{}", keys.oscillation,
                        field_text(one.omega), field_text(one.phase), field_text(one.ramp), field_text(one.growth),
                        velocity_lines(one.amplitude, space, keys));
  return text;
}

std::string body_lines(const FreeBody& body, bool space) {
  std::vector<std::string> free;
  for (std::size_t k = 0; k < body.directions.size(); ++k)
    if (body.directions[k]) free.push_back(fmt::format("\"{}\"", to_string(static_cast<BodyDirection>(k))));
  std::string text = fmt::format("free = [{}]\nmass = {}\n", fmt::join(free, ", "), field_text(body.mass));
  text += fmt::format("inertia = {}\n", space ? components_text(body.inertia, true) : field_text(body.inertia[2]));
  if (const Eigen::Quaterniond& q = body.axes; space && q.w() != 1)
    text += fmt::format("axes = [{}, {}, {}, {}]\n", field_text(q.w()), field_text(q.x()), field_text(q.y()),
                        field_text(q.z()));
  if (body.torque_turns) text += "torque_turns = true\n";
  return text + function_lines(body.load, keys_of_load, space);
}

// Throws Error naming the boundary if it is not for that dimension.
void require_dimension(const BoundarySpec& spec, Index dimension) {
  const auto refuse = [&](std::string_view expected, std::string_view met) {
    fail("boundary '{}': expected {} for a packing in {}, met {}", spec.name, expected,
         dimension == 2 ? "the plane" : "space", met);
  };
  if (dimension == 3 && spec.shape == BoundaryShape::disks)
    refuse("shape wall, cylinder, plank or grains", to_string(spec.shape));
  if (spec.dimension == 0 || spec.dimension == dimension) return;
  if (spec.shape == BoundaryShape::wall || spec.shape == BoundaryShape::plank)
    refuse(dimension == 2 ? "a wall or plank by from and to"
                          : "a wall or plank by point and normal, and a motion with three components",
           dimension == 2 ? "one in space" : "one in the plane");
  refuse(dimension == 2 ? "two components" : "three components", dimension == 2 ? "three" : "two");
}

}  // namespace

Index disks_in(const BoundarySpec& spec) {
  if (spec.shape != BoundaryShape::disks) return 0;
  // The fewest gaps that are no wider than asked for; rounding must not add one.
  return 1 + std::max<Index>(1, static_cast<Index>(std::ceil(length_of(along(spec)) / spec.distance() * (1 - 1e-12))));
}

std::vector<Index> grains_of(const BoundarySpec& spec, Index boundary, Index grains) {
  const auto refuse = [&](const std::string& expected, const std::string& met) {
    throw Error(grains_key(spec, boundary),
                fmt::format("expected {} in 0..{} (or negative, from the end), met {} of boundary '{}'", expected,
                            grains - 1, met, spec.name));
  };
  const auto number = [&](Index i) { return i < 0 ? i + grains : i; };
  std::vector<Index> all;
  if (spec.grains.empty()) {
    const Index first = number(spec.first), last = number(spec.last);
    if (first < 0 || last >= grains || first > last)
      refuse("grains first <= last", fmt::format("{} and {}", spec.first, spec.last));
    for (Index i = first; i <= last; ++i) all.push_back(i);
  }
  for (const Index i : spec.grains) {
    all.push_back(number(i));
    if (all.back() < 0 || all.back() >= grains) refuse("grains", std::to_string(i));
  }
  std::ranges::sort(all);
  if (const auto twice = std::ranges::adjacent_find(all); twice != all.end())
    refuse("different grains", fmt::format("grain {} twice", *twice));
  return all;
}

void add_boundary(GranularSystem& system, std::vector<double>& x, std::vector<double>& y, const BoundarySpec& spec,
                  Index number, Index grains) {
  try {
    check(spec);
    require_dimension(spec, system.dimension);
    if (!spec.part) {
      system.boundaries.push_back({spec.name, spec.motion, spec.orientation, spec.body, -1, spec.source});
      check(system.boundaries.back(), system.dimension);
    }
  } catch (const Error& error) {
    throw Error(fmt::format("boundary[{}]", number), error.what());
  }
  const auto own =
      spec.part ? std::ranges::find(system.boundaries, spec.name, &Boundary::name) : std::prev(system.boundaries.end());
  if (own == system.boundaries.end())
    fail("boundary '{}': expected its first shape before others, met none", spec.name);
  const Index boundary = own - system.boundaries.begin();
  if (spec.shape == BoundaryShape::disks)
    add_disks(system, x, y, spec, boundary);
  else if (spec.shape == BoundaryShape::grains)
    drive_grains(system, spec, number, boundary, grains);
  else
    system.walls.push_back(wall_of(spec, boundary));
}

std::string to_toml(const BoundarySpec& spec) {
  const bool space = spec.dimension == 3;
  std::string text = fmt::format("{} = {}\nshape = \"{}\"\n", spec.part ? "part_of" : "name", field_text(spec.name),
                                 to_string(spec.shape));
  if (spec.shape == BoundaryShape::grains) {
    text += spec.grains.empty() ? fmt::format("first = {}\nlast = {}\n", spec.first, spec.last)
                                : fmt::format("grains = [{}]\n", fmt::join(spec.grains, ", "));
    if (spec.source)
      text += fmt::format("release = {}\nrelease_distance = {}\n", components_text(spec.source->point, space),
                          field_text(spec.source->distance));
  } else if (is_plane_in_space(spec) || is_plank_in_space(spec)) {
    text += fmt::format("point = {}\n", components_text(spec.point, true));
    text += fmt::format("normal = {}\n", components_text(spec.normal, true));
    if (is_plank_in_space(spec))
      text += fmt::format("axis = {}\nlength = {}\nwidth = {}\nradius = {}\n", components_text(spec.axis, true),
                          field_text(spec.length), field_text(spec.width), field_text(spec.radius));
  } else {
    text += fmt::format("from = {}\n", components_text(spec.from, space));
    if (!is_circle(spec)) text += fmt::format("to = {}\n", components_text(spec.to, space));
    if (spec.shape != BoundaryShape::wall) text += fmt::format("radius = {}\n", field_text(spec.radius));
    if (spec.shape == BoundaryShape::disks) text += fmt::format("spacing = {}\n", field_text(spec.spacing));
    if (spec.shape == BoundaryShape::cylinder)
      text += fmt::format("side = \"{}\"\n{}", to_string(spec.side), spec.ends ? "ends = true\n" : "");
  }
  if (spec.orientation != Orientation::turning)
    text += fmt::format("orientation = \"{}\"\n", to_string(spec.orientation));
  if (!spec.colour.empty()) text += fmt::format("colour = {}\n", field_text(spec.colour));
  const Motion& motion = spec.motion;
  // Free bodies need one; of cylinders the default has changed since version 0.2.
  if (!spec.part && (spec.body || spec.shape == BoundaryShape::cylinder || motion.centre != spec.default_centre()))
    text += fmt::format("centre = {}\n", components_text(motion.centre, space));
  text += function_lines(motion, keys_of_motion, space);
  if (spec.body) text += body_lines(*spec.body, space);
  text += oscillation_lines(motion, keys_of_motion, space);
  if (spec.body) text += oscillation_lines(spec.body->load, keys_of_load, space);
  return text;
}

void check(const BoundarySpec& spec) {
  if (spec.source &&
      (spec.body || !spec.motion.velocity.empty() || !spec.motion.oscillations.empty() || spec.motion.initial))
    fail("boundary '{}': release: expected a boundary without velocity, motion and free directions, met one with them",
         spec.name);
  if (spec.shape == BoundaryShape::grains) return;
  if (is_plane_in_space(spec) || is_plank_in_space(spec)) {
    const double length = length_of(spec.normal);
    if (!(length > 0) || !std::isfinite(length))
      fail("boundary '{}': normal: expected a direction, met ({})", spec.name, fmt::join(spec.normal, ", "));
    if (!is_plank_in_space(spec)) return;
    const double along = length_of(spec.axis);
    if (!(std::abs(dot(spec.axis, spec.normal)) < 1e-6 * along * length))
      fail("boundary '{}': axis: expected a direction across the normal, met ({})", spec.name,
           fmt::join(spec.axis, ", "));
    if (!(spec.length > 0 && spec.radius > 0 && spec.width >= 0))
      fail("boundary '{}': length, width, radius: expected numbers > 0 (width 0 or more), met {}, {} and {}", spec.name,
           spec.length, spec.width, spec.radius);
    return;
  }
  const double length = is_circle(spec) ? 1 : length_of(along(spec));
  if (!(length > 0) || !std::isfinite(length)) {
    const auto place = [&](const Place& p) {
      return fmt::format("({})", fmt::join(std::span(p).first(spec.dimension == 3 ? 3 : 2), ", "));
    };
    fail("boundary '{}': from, to: expected distinct ends, met {} and {}", spec.name, place(spec.from), place(spec.to));
  }
  if (spec.shape == BoundaryShape::wall) return;
  if (!(spec.radius > 0))
    fail("boundary '{}': radius: expected one > 0 of {}, met {}", spec.name,
         spec.shape == BoundaryShape::disks ? "its disks" : fmt::format("the {}", to_string(spec.shape)), spec.radius);
  if (spec.ends && (is_circle(spec) || spec.side == CylinderSide::inside))
    fail("boundary '{}': ends: expected side outside of a cylinder in space, met another one; walls close a hollow one",
         spec.name);
  if (spec.shape != BoundaryShape::disks) return;
  constexpr double most = 1e7;
  if (!(length / spec.distance() < most))
    fail("boundary '{}': spacing: expected at most {} disks, met {} m in steps of {} m", spec.name, most, length,
         spec.distance());
}

}  // namespace nscdd
