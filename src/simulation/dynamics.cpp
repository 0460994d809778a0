// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/dynamics.hpp"

#include "core/fail.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

Place along(const BoundarySpec& spec) {
  return {spec.to[0] - spec.from[0], spec.to[1] - spec.from[1], spec.to[2] - spec.from[2]};
}

double length_of(const Place& vector) { return std::hypot(vector[0], vector[1], vector[2]); }

Place unit(const Place& vector) {
  const double length = length_of(vector);
  return {vector[0] / length, vector[1] / length, vector[2] / length};
}

bool is_plane_in_space(const BoundarySpec& spec) { return spec.shape == BoundaryShape::wall && spec.dimension == 3; }

Wall wall_of(const BoundarySpec& spec, Index boundary) {
  if (is_plane_in_space(spec)) return {.point = spec.point, .normal = unit(spec.normal), .boundary = boundary};
  if (spec.shape == BoundaryShape::cylinder)
    return {.point = spec.from,
            .normal = unit(along(spec)),
            .boundary = boundary,
            .radius = spec.side == CylinderSide::inside ? spec.radius : -spec.radius};
  const double length = length_of(along(spec));
  return {.point = spec.from,
          .normal = {(spec.from[1] - spec.to[1]) / length, (spec.to[0] - spec.from[0]) / length, 0},
          .boundary = boundary};
}

void require_dimension(const BoundarySpec& spec, Index dimension) {
  const auto refuse = [&](std::string_view expected, std::string_view met) {
    fail("boundary '{}': expected {} for a packing in {}, met {}", spec.name, expected,
         dimension == 2 ? "the plane" : "space", met);
  };
  if (dimension == 2 && spec.shape == BoundaryShape::cylinder)
    refuse("shape wall, disks or grains", to_string(spec.shape));
  if (dimension == 3 && spec.shape == BoundaryShape::disks)
    refuse("shape wall, cylinder or grains", to_string(spec.shape));
  if (spec.dimension == 0 || spec.dimension == dimension) return;
  if (spec.shape == BoundaryShape::wall)
    refuse(dimension == 2 ? "a wall by from and to" : "a wall by point and normal, and a motion with three components",
           dimension == 2 ? "one in space" : "one in the plane");
  refuse(dimension == 2 ? "two components" : "three components", dimension == 2 ? "three" : "two");
}

void add_disks(GranularSystem& system, std::vector<double>& x, std::vector<double>& y, const BoundarySpec& spec,
               Index boundary) {
  const double length = length_of(along(spec));
  // The fewest gaps that are no wider than asked for; rounding must not add one.
  const Index gaps = std::max<Index>(1, static_cast<Index>(std::ceil(length / spec.distance() * (1 - 1e-12))));
  for (Index k = 0; k <= gaps; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(gaps);
    x.push_back(spec.from[0] + s * (spec.to[0] - spec.from[0]));
    y.push_back(spec.from[1] + s * (spec.to[1] - spec.from[1]));
    system.radius.push_back(spec.radius);
    system.mass.push_back(1);
    system.driven_by.push_back(boundary);
  }
}

void drive_grains(GranularSystem& system, const BoundarySpec& spec, Index boundary, Index grains) {
  const std::string key = fmt::format("boundary[{}].first", boundary);
  const Index first = spec.first < 0 ? spec.first + grains : spec.first;
  const Index last = spec.last < 0 ? spec.last + grains : spec.last;
  if (first < 0 || last >= grains || first > last)
    throw Error(key, fmt::format("expected grains first <= last in 0..{} (or negative, from the end), "
                                 "met {} and {} of boundary '{}'",
                                 grains - 1, spec.first, spec.last, spec.name));
  for (Index i = first; i <= last; ++i) {
    if (system.driven_by[at(i)] >= 0)
      throw Error(key, fmt::format("expected grains driven once, met grain {} of boundaries '{}' and '{}'", i,
                                   system.boundaries[at(system.driven_by[at(i)])].name, spec.name));
    system.driven_by[at(i)] = boundary;
  }
}

// A parameter has an effect only if the one `with` has an expected value.
struct Need {
  std::string path, with, expected, found;
  bool met;
};

template <Named Enum, class Predicate>
Need need(std::string path, std::string with, Choice<Enum> now, const Predicate& right) {
  return {std::move(path), std::move(with), names_where<Enum>(right), std::string(to_string(now)), right(now)};
}

void add_needs(std::vector<Need>& needs, const StepSolver& solver) {
  const bool sweeps = has_part(solver.algorithm, StepPart::sweeps);
  StepSolver::options(solver, [&](StepPart part, std::string_view key, const auto&, const Field&) {
    needs.push_back(need(fmt::format("solver.{}", key), "solver.algorithm", solver.algorithm,
                         [part](StepAlgorithm one) { return has_part(one, part); }));
    if (key == "criterion" && !sweeps) needs.back().met = solver.criterion == Criterion::natural_map;  // its own
  });
  const auto add = [&](const char* path, const char* with, auto now, const auto& right) {
    needs.push_back(need(path, with, now, right));
  };
  const auto is = [](auto value) { return [value](auto now) { return now == value; }; };
  const auto is_not = [](auto value) { return [value](auto now) { return now != value; }; };
  for (const char* path : {"solver.tolerance", "solver.gluing_tolerance"})
    if (sweeps) add(path, "solver.criterion", solver.criterion, is_not(Criterion::none));
  add("solver.seed", "solver.order", solver.order, is(ContactOrder::random));
  add("solver.network", "solver.enrichment", solver.enrichment, is_not(Enrichment::semi_implicit));
  for (const char* path : {"solver.interface_relaxation", "solver.switch"})
    add(path, "solver.interface_method", solver.interface_method, is(InterfaceMethod::richardson));
  add("solver.interface_flexibility", "solver.interface_network", solver.interface_network,
      is_not(InterfaceNetwork::none));
  for (const char* path : {"solver.switch_after", "solver.switch_flexibility"})
    add(path, "solver.switch", solver.model, is_not(SwitchedModel::none));
  add("solver.switch_cells", "solver.switch", solver.model, is(SwitchedModel::homogenised));
}

void add_needs(std::vector<Need>& needs, const Interaction& interaction, double penetration_correction) {
  const auto add_law = [&](const char* path, const auto& right) {
    needs.push_back(need(path, "interaction.law", interaction.law, [&](LawName law) {
      return std::visit(right, Alternatives<ContactLaw>::at(static_cast<std::size_t>(law)));
    }));
  };
  for (const char* path : {"interaction.friction", "interaction.boundary_friction"})
    add_law(path, [](const auto& law) { return law.opens && law.rubs; });
  add_law("interaction.cohesion", [](const auto& law) { return law.pulls; });
  add_law("interaction.epsilon", [](const auto& law) { return !law.opens; });
  add_law("interaction.tangential_restitution", [](const auto& law) { return law.rubs; });
  add_law("solver.switch", [](const auto& law) { return law.opens; });

  const auto add = [&](const char* path, const char* with, const char* expected, double now, bool met) {
    needs.push_back({path, with, expected, field_text(now == 0 ? 0.0 : now), met});
  };
  for (const char* path : {"dynamics.penetration_correction", "dynamics.maximum_push_speed"}) {
    add(path, "interaction.restitution", "0", interaction.restitution, interaction.restitution == 0);
    needs.push_back(need(path, "interaction.signorini", interaction.signorini,
                         [](Signorini condition) { return condition == Signorini::gap; }));
  }
  add("dynamics.maximum_push_speed", "dynamics.penetration_correction", "> 0", penetration_correction,
      penetration_correction != 0);
}

// The first need of a parameter that is not met.
std::optional<Need> missing_for(const Dynamics& dynamics, std::string_view path) {
  std::vector<Need> needs;
  add_needs(needs, dynamics.solver);
  add_needs(needs, dynamics.interaction, dynamics.time.penetration_correction);
  for (const Need& one : needs)
    if (one.path == path && !one.met) return one;
  return std::nullopt;
}

std::string components_text(const Place& values, bool space) {
  return space ? field_text(Components<double>(values)) : field_text(Components<double>(values[0], values[1]));
}

std::string velocity_lines(const RigidVelocity& v, bool space, const char* before = "") {
  return fmt::format("{0}velocity = {1}\n{0}spin = {2}\n", before, components_text({v.x, v.y, v.z}, space),
                     space ? components_text({v.spin_x, v.spin_y, v.spin}, true) : field_text(v.spin));
}

std::string motion_entry(double time, const RigidVelocity& v, bool space) {
  std::vector<double> entry{time, v.x, v.y, v.spin};
  if (space) entry = {time, v.x, v.y, v.z, v.spin_x, v.spin_y, v.spin};
  std::vector<std::string> numbers;
  for (const double number : entry) numbers.push_back(field_text(number));
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string motion_lines(const Motion& motion, bool space) {
  std::string text;
  if (motion.centre != Place{0, 0, 0}) text += fmt::format("centre = {}\n", components_text(motion.centre, space));
  std::vector<std::string> entries;
  for (std::size_t k = 0; k < motion.velocity.size(); ++k)
    entries.push_back(motion_entry(motion.time[k], motion.velocity[k], space));
  if (entries.size() == 1 && motion.time.front() == 0)
    text += velocity_lines(motion.velocity.front(), space);
  else if (!entries.empty())
    text += fmt::format("motion = [{}]\n", fmt::join(entries, ", "));
  if (motion.initial) text += velocity_lines(*motion.initial, space, "initial_");
  for (const Oscillation& one : motion.oscillations)
    text += fmt::format("[[boundary.oscillation]]\nomega = {}\nphase = {}\nramp = {}\ngrowth = {}\n{}",
                        field_text(one.omega), field_text(one.phase), field_text(one.ramp), field_text(one.growth),
                        velocity_lines(one.amplitude, space));
  return text;
}

// Defaults of parameters without effect, so that equal runs have equal texts.
template <class Parameters>
std::string effective_lines(const Dynamics& dynamics, std::string_view section, const Parameters& parameters) {
  const std::vector<FieldDescription> now = describe_fields(parameters), by_default = describe_fields(Parameters{});
  std::string lines;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const bool effective = has_effect(dynamics, fmt::format("{}.{}", section, now[k].key));
    if (now[k].key.starts_with("switch") && !switches_models(dynamics)) continue;  // as if there were none
    lines += fmt::format("{} = {}\n", now[k].key, effective ? now[k].value : by_default[k].value);
  }
  return lines;
}

std::string boundary_lines(const BoundarySpec& spec) {
  std::string text = fmt::format("name = {}\nshape = \"{}\"\n", field_text(spec.name), to_string(spec.shape));
  if (spec.shape == BoundaryShape::grains) {
    text += fmt::format("first = {}\nlast = {}\n", spec.first, spec.last);
  } else if (is_plane_in_space(spec)) {
    text += fmt::format("point = {}\n", components_text(spec.point, true));
    text += fmt::format("normal = {}\n", components_text(spec.normal, true));
  } else {
    const bool space = spec.dimension == 3;
    text += fmt::format("from = {}\nto = {}\n", components_text(spec.from, space), components_text(spec.to, space));
    if (spec.shape == BoundaryShape::disks)
      text += fmt::format("radius = {}\nspacing = {}\n", field_text(spec.radius), field_text(spec.spacing));
    if (spec.shape == BoundaryShape::cylinder)
      text += fmt::format("radius = {}\nside = \"{}\"\n", field_text(spec.radius), to_string(spec.side));
  }
  if (spec.orientation != Orientation::turning)
    text += fmt::format("orientation = \"{}\"\n", to_string(spec.orientation));
  return text + motion_lines(spec.motion, spec.dimension == 3);
}

}  // namespace

GranularScene scene(const Packing& packing, const Dynamics& dynamics) {
  if (packing.mass.empty()) throw Error("dynamics: expected grains with masses, met a packing without");
  GranularScene result;
  GranularSystem& system = result.system;
  system.dimension = packing.dimension();
  system.radius = packing.radius;
  system.mass = packing.mass;
  system.driven_by.assign(packing.radius.size(), -1);
  std::vector<double> x = packing.x, y = packing.y;
  for (const BoundarySpec& spec : dynamics.boundaries) {
    check(spec);
    require_dimension(spec, system.dimension);
    const Index boundary = count(system.boundaries);
    system.boundaries.push_back({spec.name, spec.motion, spec.orientation});
    if (spec.shape == BoundaryShape::disks)
      add_disks(system, x, y, spec, boundary);
    else if (spec.shape == BoundaryShape::grains)
      drive_grains(system, spec, boundary, packing.size());
    else
      system.walls.push_back(wall_of(spec, boundary));
  }
  // Disks of boundaries may have doubled the capacity.
  for (std::vector<double>* values : {&system.radius, &system.mass, &x, &y}) values->shrink_to_fit();
  system.driven_by.shrink_to_fit();
  result.state = initial_state(system, std::move(x), std::move(y), packing.z);
  check(system, result.state);
  return result;
}

bool has_effect(const Dynamics& dynamics, std::string_view path) { return !missing_for(dynamics, path); }

void require_effect(const Dynamics& dynamics, std::string_view path, std::string_view where, bool algorithm_stated) {
  if (const auto missing = missing_for(dynamics, path))
    fail("{}: expected {} {} with it, met {}{}", where, missing->with, missing->expected, missing->found,
         missing->with == "solver.algorithm" && !algorithm_stated ? ", the default" : "");
}

bool switches_models(const Dynamics& dynamics) {
  return dynamics.solver.model != SwitchedModel::none && has_effect(dynamics, "solver.switch");
}

void check(const BoundarySpec& spec) {
  if (spec.shape == BoundaryShape::grains) return;
  if (is_plane_in_space(spec)) {
    const double length = length_of(spec.normal);
    if (!(length > 0) || !std::isfinite(length))
      fail("boundary '{}': normal: expected a direction, met ({})", spec.name, fmt::join(spec.normal, ", "));
    return;
  }
  const double length = length_of(along(spec));
  if (!(length > 0) || !std::isfinite(length)) {
    const auto place = [&](const Place& p) {
      return fmt::format("({})", fmt::join(std::span(p).first(spec.dimension == 3 ? 3 : 2), ", "));
    };
    fail("boundary '{}': from, to: expected distinct ends, met {} and {}", spec.name, place(spec.from), place(spec.to));
  }
  if (spec.shape == BoundaryShape::wall) return;
  if (!(spec.radius > 0))
    fail("boundary '{}': radius: expected one > 0 of {}, met {}", spec.name,
         spec.shape == BoundaryShape::disks ? "its disks" : "the cylinder", spec.radius);
  if (spec.shape == BoundaryShape::cylinder) return;
  constexpr double most = 1e7;
  if (!(length / spec.distance() < most))
    fail("boundary '{}': spacing: expected at most {} disks, met {} m in steps of {} m", spec.name, most, length,
         spec.distance());
}

std::string to_toml(const Dynamics& dynamics) {
  std::string text = "\n[interaction]\n" + effective_lines(dynamics, "interaction", dynamics.interaction);
  text += "\n[dynamics]\n" + effective_lines(dynamics, "dynamics", dynamics.time);
  text += "\n[solver]\n" + effective_lines(dynamics, "solver", dynamics.solver);
  for (const BoundarySpec& spec : dynamics.boundaries) text += "\n[[boundary]]\n" + boundary_lines(spec);
  return text;
}

}  // namespace nscdd
