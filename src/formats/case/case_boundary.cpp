// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/strict_toml.hpp"
#include "formats/case/case_file.hpp"

namespace nscdd {
namespace {

// Reads the numbers of a boundary, which must all be for the plane or all for space.
class BoundaryNumbers {
 public:
  explicit BoundaryNumbers(StrictTable& section) : section_(section) {}

  void read(const char* key, std::array<double, 3>& value) {
    if (section_.node(key) == nullptr) return;
    Components<double> numbers;
    section_.read(key, numbers, Field{});
    take(section_.node(key), key, static_cast<Index>(numbers.size()));
    value = {numbers[0], numbers[1], numbers[2]};
  }
  /// The keys velocity and spin, if before them is "", or initial_velocity and initial_spin.
  RigidVelocity read_velocity(const std::string& before = "") {
    std::array<double, 3> velocity{}, spin{};
    read((before + "velocity").c_str(), velocity);
    const std::string key = before + "spin";
    if (const Index dimension = read_spin(section_, key, spin); dimension > 0)
      take(section_.node(key), key.c_str(), dimension);
    return {velocity[0], velocity[1], spin[2], velocity[2], spin[0], spin[1]};
  }
  // Notes the dimension of an entry. Throws Error if other entries have another one.
  void take(const toml::node* node, const char* key, Index dimension) {
    if (dimension_ == 0) {
      dimension_ = dimension;
      first_ = key;
    }
    if (dimension_ == dimension) return;
    const auto place = [](Index of) { return of == 2 ? "the plane" : "space"; };
    section_.fail(node, key, fmt::format("numbers for {} as in {}", place(dimension_), first_),
                  fmt::format("numbers for {}", place(dimension)));
  }
  Index dimension() const { return dimension_; }

 private:
  StrictTable& section_;
  Index dimension_ = 0;
  std::string first_;
};

std::vector<double> motion_entry(const StrictTable& section, const toml::node& node) {
  const char* expected =
      "entries of four finite numbers [t, vx, vy, spin], or in space seven [t, vx, vy, vz, spin_x, spin_y, spin_z]";
  const toml::array* entry = node.as_array();
  if (entry == nullptr) section.fail(&node, "motion", expected, StrictTable::describe(node));
  if (entry->size() != 4 && entry->size() != 7)
    section.fail(&node, "motion", expected, fmt::format("an array of {}", entry->size()));
  std::vector<double> values;
  for (std::size_t i = 0; i < entry->size(); ++i) {
    const std::optional<double> value = (*entry)[i].value<double>();
    if (!value || !std::isfinite(*value))
      section.fail(&(*entry)[i], "motion", expected, StrictTable::describe((*entry)[i]));
    values.push_back(*value);
  }
  return values;
}

void read_motion_table(StrictTable& section, BoundaryNumbers& numbers, Motion& motion) {
  const toml::node* found = section.node("motion");
  const toml::array* entries = found->as_array();
  if (entries == nullptr || entries->empty())
    section.fail(found, "motion", "entries [[t, vx, vy, spin], ...]",
                 entries == nullptr ? StrictTable::describe(*found) : "an empty array");
  for (const toml::node& node : *entries) {
    const std::vector<double> entry = motion_entry(section, node);
    numbers.take(&node, "motion", entry.size() == 4 ? 2 : 3);
    if (const double t = entry[0]; !motion.time.empty() && !(t > motion.time.back()))
      section.fail(&node, "motion", "ascending times", fmt::format("{} s after {} s", t, motion.time.back()));
    motion.time.push_back(entry[0]);
    if (entry.size() == 4)
      motion.velocity.push_back({entry[1], entry[2], entry[3]});
    else
      motion.velocity.push_back({entry[1], entry[2], entry[6], entry[3], entry[4], entry[5]});
  }
}

Motion read_motion(StrictTable& section, BoundaryNumbers& numbers) {
  Motion motion;
  numbers.read("centre", motion.centre);
  const bool uniform = section.has("velocity") || section.has("spin");
  const RigidVelocity velocity = numbers.read_velocity();
  if (section.node("motion") != nullptr) {
    if (uniform) section.fail("motion", "either motion = ... or velocity and spin", "both");
    read_motion_table(section, numbers, motion);
  } else if (uniform) {
    motion.time = {0};
    motion.velocity = {velocity};
  }
  if (section.has("initial_velocity") || section.has("initial_spin"))
    motion.initial = numbers.read_velocity("initial_");
  for (StrictTable one : section.tables("oscillation")) {
    Oscillation& oscillation = motion.oscillations.emplace_back();
    BoundaryNumbers own(one);
    oscillation.amplitude = own.read_velocity();
    if (own.dimension() == 0) one.fail("velocity", "velocity or spin, the amplitudes", "neither");
    numbers.take(section.node("oscillation"), "oscillation", own.dimension());
    one.require_keys({"omega"});
    one.read("omega", oscillation.omega, Field{.unit = "rad/s"});
    one.read("phase", oscillation.phase, Field{.unit = "rad"});
    one.read("ramp", oscillation.ramp, Field{.minimum = 0, .maximum = 1});
    one.read("growth", oscillation.growth, Field{.unit = "1/s", .minimum = 0});
    one.finish();
  }
  return motion;
}

void read_ends(StrictTable& section, BoundaryNumbers& numbers, BoundarySpec& spec) {
  section.require_keys({"from", "to"});
  numbers.read("from", spec.from);
  numbers.read("to", spec.to);
  if (spec.shape == BoundaryShape::wall && numbers.dimension() == 3)
    section.fail("from", "point and normal of a wall in space", "from and to");
  if (spec.from == spec.to) section.fail("to", "another point than from", "the same");
}

// A trajectory holds one name per line.
void read_name(StrictTable& section, std::string& name) {
  section.read("name", name);
  const auto breaks = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (name.empty() || std::any_of(name.begin(), name.end(), breaks))
    section.fail("name", "a text of one line, without control characters and not empty", field_text(name));
}

}  // namespace

Index read_spin(StrictTable& section, std::string_view key, std::array<double, 3>& spin) {
  const toml::node* found = section.node(key);
  if (found == nullptr) return 0;
  if (!found->is_array()) {
    section.read(key, spin[2], Field{});
    return 2;
  }
  Components<double> numbers;
  section.read(key, numbers, Field{});
  if (numbers.size() == 2) section.fail(key, "one number in the plane, or three in space", "an array of 2");
  spin = {numbers[0], numbers[1], numbers[2]};
  return 3;
}

BoundarySpec read_boundary(StrictTable section) {
  BoundarySpec spec;
  section.require_keys({"name", "shape"});
  read_name(section, spec.name);
  section.read("shape", spec.shape);
  BoundaryNumbers numbers(section);
  if (spec.shape == BoundaryShape::grains) {
    section.require_keys({"first", "last"});
    section.read("first", spec.first);
    section.read("last", spec.last);
  } else if (spec.shape == BoundaryShape::wall && (section.has("point") || section.has("normal"))) {
    section.require_keys({"point", "normal"});
    numbers.read("point", spec.point);
    numbers.read("normal", spec.normal);
    if (numbers.dimension() == 2) section.fail("point", "from and to of a wall in the plane", "point and normal");
  } else {
    read_ends(section, numbers, spec);
  }
  if (spec.shape == BoundaryShape::disks || spec.shape == BoundaryShape::cylinder) {
    section.require_keys({"radius"});
    section.read("radius", spec.radius, Field{.above = 0});
  }
  if (spec.shape == BoundaryShape::disks) section.read("spacing", spec.spacing, Field{.minimum = 0});
  if (spec.shape == BoundaryShape::cylinder) section.read("side", spec.side);
  if (spec.shape == BoundaryShape::disks || spec.shape == BoundaryShape::grains)
    section.read("orientation", spec.orientation);
  spec.motion = read_motion(section, numbers);
  spec.dimension = numbers.dimension();
  section.finish();
  section.located("", [&] { check(spec); });
  return spec;
}

}  // namespace nscdd
