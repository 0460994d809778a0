// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/case_dynamics.hpp"

#include <algorithm>
#include <array>

namespace nscdd {
namespace {

void require_keys(const StrictTable& section, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (!section.has(key)) section.fail(key, "a value", "none");
}

// One entry [t, vx, vy, spin] of a motion.
std::array<double, 4> motion_entry(const StrictTable& section, const toml::node& node) {
  const char* expected = "entries of four finite numbers [t, vx, vy, spin]";
  const toml::array* entry = node.as_array();
  if (entry == nullptr) section.fail(&node, "motion", expected, StrictTable::describe(node));
  if (entry->size() != 4) section.fail(&node, "motion", expected, fmt::format("an array of {}", entry->size()));
  std::array<double, 4> values{};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<double> value = (*entry)[i].value<double>();
    if (!value || !std::isfinite(*value))
      section.fail(&(*entry)[i], "motion", expected, StrictTable::describe((*entry)[i]));
    values[i] = *value;
  }
  return values;
}

void read_motion_table(StrictTable& section, Motion& motion) {
  const toml::node* found = section.node("motion");
  const toml::array* entries = found->as_array();
  if (entries == nullptr || entries->empty())
    section.fail(found, "motion", "entries [[t, vx, vy, spin], ...]",
                 entries == nullptr ? StrictTable::describe(*found) : "an empty array");
  for (const toml::node& node : *entries) {
    const auto [t, vx, vy, spin] = motion_entry(section, node);
    if (!motion.time.empty() && !(t > motion.time.back()))
      section.fail(&node, "motion", "ascending times", fmt::format("{} s after {} s", t, motion.time.back()));
    motion.time.push_back(t);
    motion.velocity.push_back({vx, vy, spin});
  }
}

void check_finite(StrictTable& section, const char* key, const auto& value) {
  check_bounds(value, Field{.description = ""}, section.where(key));
}

Motion read_motion(StrictTable& section) {
  Motion motion;
  section.read("centre", motion.centre);
  check_finite(section, "centre", motion.centre);
  std::array<double, 2> velocity{};
  double spin = 0;
  section.read("velocity", velocity);
  section.read("spin", spin);
  check_finite(section, "velocity", velocity);
  check_finite(section, "spin", spin);
  const bool uniform = section.has("velocity") || section.has("spin");
  if (section.node("motion") == nullptr) {
    if (uniform) {
      motion.time = {0};
      motion.velocity = {{velocity[0], velocity[1], spin}};
    }
    return motion;
  }
  if (uniform) section.fail("motion", "either motion = ... or velocity and spin", "both");
  read_motion_table(section, motion);
  return motion;
}

// A key that is given with another value than its default must have an effect. (A case that the program wrote
// has every key, those without effect at their defaults.)
template <class Parameters>
void require_effects(const StrictTable& section, const Dynamics& dynamics, const Parameters& parameters) {
  const std::vector<FieldDescription> now = describe_fields(parameters), by_default = describe_fields(Parameters{});
  for (std::size_t k = 0; k < now.size(); ++k)
    if (section.has(now[k].key) && now[k].value != by_default[k].value)
      require_effect(dynamics, section.key_path(now[k].key), section.where(now[k].key));
}

void read_ends(StrictTable& section, BoundarySpec& spec) {
  require_keys(section, {"from", "to"});
  section.read("from", spec.from);
  section.read("to", spec.to);
  check_finite(section, "from", spec.from);
  check_finite(section, "to", spec.to);
  if (spec.from == spec.to) section.fail("to", "another point than from", "the same");
}

// A trajectory holds one name per line.
void read_name(StrictTable& section, std::string& name) {
  section.read("name", name);
  const auto breaks = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (name.empty() || std::any_of(name.begin(), name.end(), breaks))
    section.fail("name", "a text of one line, without control characters and not empty", field_text(name));
}

BoundarySpec read_boundary(StrictTable section) {
  BoundarySpec spec;
  require_keys(section, {"name", "shape"});
  read_name(section, spec.name);
  section.read("shape", spec.shape);
  if (spec.shape == BoundaryShape::grains) {
    require_keys(section, {"first", "last"});
    section.read("first", spec.first);
    section.read("last", spec.last);
  } else {
    read_ends(section, spec);
  }
  if (spec.shape == BoundaryShape::disks) {
    require_keys(section, {"radius"});
    section.read("radius", spec.radius);
    section.read("spacing", spec.spacing);
    check_bounds(spec.radius, Field{.description = "", .minimum = 0, .minimum_excluded = true},
                 section.where("radius"));
    check_bounds(spec.spacing, Field{.description = "", .minimum = 0}, section.where("spacing"));
  }
  if (spec.shape != BoundaryShape::wall) section.read("orientation", spec.orientation);
  spec.motion = read_motion(section);
  section.finish();
  try {
    check(spec);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", section.location(nullptr), error.what()));
  }
  return spec;
}

}  // namespace

std::optional<Dynamics> read_dynamics(StrictTable& root) {
  const bool moves = root.has("dynamics");
  for (const char* key : {"interaction", "solver", "boundary"})
    if (!moves && root.has(key)) root.fail(key, "a section [dynamics] with it", "none");
  for (const char* key : {"dynamics", "interaction", "solver", "boundary"}) root.node(key);
  if (!moves) return std::nullopt;
  Dynamics dynamics;
  StrictTable interaction = root.section("interaction", false);
  interaction.read_fields(dynamics.interaction);
  interaction.finish();
  StrictTable time = root.section("dynamics", true);
  time.read_fields(dynamics.time);
  time.finish();
  StrictTable solver = root.section("solver", false);
  solver.read_fields(dynamics.solver);
  solver.finish();
  require_effects(interaction, dynamics, dynamics.interaction);
  require_effects(time, dynamics, dynamics.time);
  require_effects(solver, dynamics, dynamics.solver);
  for (const StrictTable& boundary : root.tables("boundary")) {
    dynamics.boundaries.push_back(read_boundary(boundary));
    for (std::size_t k = 0; k + 1 < dynamics.boundaries.size(); ++k)
      if (dynamics.boundaries[k].name == dynamics.boundaries.back().name)
        boundary.fail("name", "each name once", fmt::format("{} again", field_text(dynamics.boundaries[k].name)));
  }
  return dynamics;
}

}  // namespace nscdd
