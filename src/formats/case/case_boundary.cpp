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
  /// The keys of a value, with "" or "initial_" before them.
  RigidVelocity read_value(const FunctionKeys& keys, const std::string& before = "") {
    std::array<double, 3> velocity{}, spin{};
    read((before + keys.linear).c_str(), velocity);
    const std::string key = before + keys.angular;
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

std::vector<double> table_entry(const StrictTable& section, const toml::node& node, const char* key) {
  const std::string expected =
      key == std::string_view(keys_of_motion.table)
          ? "entries of four finite numbers [t, vx, vy, spin], or in space seven [t, vx, vy, vz, spin_x, spin_y, "
            "spin_z]"
          : "entries of four finite numbers [t, fx, fy, torque], or in space seven [t, fx, fy, fz, torque_x, torque_y, "
            "torque_z]";
  const toml::array* entry = node.as_array();
  if (entry == nullptr) section.fail(&node, key, expected, StrictTable::describe(node));
  if (entry->size() != 4 && entry->size() != 7)
    section.fail(&node, key, expected, fmt::format("an array of {}", entry->size()));
  std::vector<double> values;
  for (std::size_t i = 0; i < entry->size(); ++i) {
    const std::optional<double> value = (*entry)[i].value<double>();
    if (!value || !std::isfinite(*value)) section.fail(&(*entry)[i], key, expected, StrictTable::describe((*entry)[i]));
    values.push_back(*value);
  }
  return values;
}

void read_table(StrictTable& section, BoundaryNumbers& numbers, const char* key, Motion& motion) {
  const toml::node* found = section.node(key);
  const toml::array* entries = found->as_array();
  if (entries == nullptr || entries->empty())
    section.fail(found, key, "entries [[t, ...], ...]",
                 entries == nullptr ? StrictTable::describe(*found) : "an empty array");
  for (const toml::node& node : *entries) {
    const std::vector<double> entry = table_entry(section, node, key);
    numbers.take(&node, key, entry.size() == 4 ? 2 : 3);
    if (const double t = entry[0]; !motion.time.empty() && !(t > motion.time.back()))
      section.fail(&node, key, "ascending times", fmt::format("{} s after {} s", t, motion.time.back()));
    motion.time.push_back(entry[0]);
    if (entry.size() == 4)
      motion.velocity.push_back({entry[1], entry[2], entry[3]});
    else
      motion.velocity.push_back({entry[1], entry[2], entry[6], entry[3], entry[4], entry[5]});
  }
}

void read_oscillation(StrictTable one, const FunctionKeys& keys, BoundaryNumbers& numbers, const toml::node* node,
                      Oscillation& oscillation) {
  BoundaryNumbers own(one);
  oscillation.amplitude = own.read_value(keys);
  if (own.dimension() == 0)
    one.fail(keys.linear, fmt::format("{} or {}, the amplitudes", keys.linear, keys.angular), "neither");
  numbers.take(node, keys.oscillation, own.dimension());
  one.require_keys({"omega"});
  one.read("omega", oscillation.omega, Field{.unit = "rad/s"});
  one.read("phase", oscillation.phase, Field{.unit = "rad"});
  one.read("ramp", oscillation.ramp, Field{.minimum = 0, .maximum = 1});
  one.read("growth", oscillation.growth, Field{.unit = "1/s", .minimum = 0});
  one.finish();
}

void read_function(StrictTable& section, BoundaryNumbers& numbers, const FunctionKeys& keys, Motion& motion) {
  const bool uniform = section.has(keys.linear) || section.has(keys.angular);
  const RigidVelocity value = numbers.read_value(keys);
  if (section.node(keys.table) != nullptr) {
    if (uniform)
      section.fail(keys.table, fmt::format("either {} = ... or {} and {}", keys.table, keys.linear, keys.angular),
                   "both");
    read_table(section, numbers, keys.table, motion);
  } else if (uniform) {
    motion.time = {0};
    motion.velocity = {value};
  }
  for (const StrictTable& one : section.tables(keys.oscillation))
    read_oscillation(one, keys, numbers, section.node(keys.oscillation), motion.oscillations.emplace_back());
}

Motion read_motion(StrictTable& section, BoundaryNumbers& numbers, const Place& centre) {
  Motion motion{.centre = centre, .time = {}, .velocity = {}};
  numbers.read("centre", motion.centre);
  read_function(section, numbers, keys_of_motion, motion);
  if (section.has("initial_velocity") || section.has("initial_spin"))
    motion.initial = numbers.read_value(keys_of_motion, "initial_");
  return motion;
}

// The directions along which a boundary moves freely, and what moves it; empty without the key `free`.
std::optional<FreeBody> read_body(StrictTable& section, BoundaryNumbers& numbers) {
  if (!section.has("free")) return std::nullopt;
  FreeBody body;
  const toml::node* found = section.node("free");
  const toml::array* names = found->as_array();
  const std::string expected = fmt::format("an array of {}", names_where<BodyDirection>());
  if (names == nullptr || names->empty())
    section.fail(found, "free", expected, names == nullptr ? StrictTable::describe(*found) : "an empty array");
  for (const toml::node& node : *names) {
    const auto name = node.value<std::string>();
    if (!name) section.fail(&node, "free", expected, StrictTable::describe(node));
    bool& direction =
        body.directions[section.located("free", [&] { return position_of(*name, names_of(BodyDirection{}), "free"); })];
    if (std::exchange(direction, true))
      section.fail(&node, "free", "each direction once", field_text(*name) + " again");
  }
  section.require_keys({"mass", "centre"});
  section.read("mass", body.mass, Field{.unit = "kg", .above = 0});
  if (const Index dimension = read_spin(section, "inertia", body.inertia); dimension > 0)
    numbers.take(section.node("inertia"), "inertia", dimension);
  if (!std::ranges::all_of(body.inertia, [](double one) { return one >= 0; }))
    section.fail("inertia", "moments of inertia >= 0", StrictTable::describe(*section.node("inertia")));
  for (const char* key : {"axes", "torque_turns"})
    if (section.has(key)) {
      numbers.take(section.node(key), key, 3);
      if (!body.free(BodyDirection::spin)) section.fail(key, "a body with free rotations", "none");
    }
  section.read("torque_turns", body.torque_turns);
  if (section.has("axes")) {
    const toml::array* entries = section.node("axes")->as_array();
    std::vector<double> q;
    for (std::size_t k = 0; entries != nullptr && k < entries->size(); ++k)
      q.push_back((*entries)[k].value<double>().value_or(not_a_number));
    const double size = q.size() == 4 ? std::hypot(std::hypot(q[0], q[1], q[2]), q[3]) : 0;
    if (!(std::abs(size - 1) < 1e-6))
      section.fail("axes", "a unit quaternion [w, x, y, z] of the principal axes", "another value");
    body.axes = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    if (std::abs(size - 1) > 1e-15) body.axes.normalize();  // else a case that is written and read has other bits
  }
  read_function(section, numbers, keys_of_load, body.load);
  return body;
}

void read_ends(StrictTable& section, BoundaryNumbers& numbers, BoundarySpec& spec) {
  section.require_keys({"from"});
  numbers.read("from", spec.from);
  if (spec.shape == BoundaryShape::cylinder && numbers.dimension() == 2) return;  // a circle
  section.require_keys({"to"});
  numbers.read("to", spec.to);
  if ((spec.shape == BoundaryShape::wall || spec.shape == BoundaryShape::plank) && numbers.dimension() == 3)
    section.fail("from", fmt::format("point and normal of a {} in space", to_string(spec.shape)), "from and to");
  if (spec.from == spec.to) section.fail("to", "another point than from", "the same");
}

void read_grains(StrictTable& section, std::vector<Index>& grains) {
  const toml::node* found = section.node("grains");
  const toml::array* numbers = found->as_array();
  for (std::size_t k = 0; numbers != nullptr && k < numbers->size(); ++k)
    if (const auto* number = (*numbers)[k].as_integer()) grains.push_back(static_cast<Index>(**number));
  if (numbers == nullptr || grains.empty() || grains.size() != numbers->size())
    section.fail("grains", "an array of integers, in place of first and last", StrictTable::describe(*found));
}

void read_source(StrictTable& section, BoundaryNumbers& numbers, BoundarySpec& spec) {
  section.require_keys({"release", "release_distance"});
  GrainSource& source = spec.source.emplace();
  numbers.read("release", source.point);
  section.read("release_distance", source.distance, Field{.unit = "m", .above = 0});
  if (section.has("colour"))
    section.fail("colour", "none with release: [[colour]] gives the grains theirs", "a colour");
}

// A trajectory holds one name per line.
void read_name(StrictTable& section, const char* key, std::string& name) {
  section.read(key, name);
  const auto breaks = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
  if (name.empty() || std::any_of(name.begin(), name.end(), breaks))
    section.fail(key, "a text of one line, without control characters and not empty", field_text(name));
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
  spec.part = section.has("part_of");
  const char* name = spec.part ? "part_of" : "name";
  section.require_keys({name, "shape"});
  read_name(section, name, spec.name);
  section.read("shape", spec.shape);
  const auto is = [&](auto... shapes) { return ((spec.shape == shapes) || ...); };
  BoundaryNumbers numbers(section);
  if (is(BoundaryShape::grains)) {
    if (section.has("grains")) {
      read_grains(section, spec.grains);
    } else {
      section.require_keys({"first", "last"});
      section.read("first", spec.first);
      section.read("last", spec.last);
    }
    if (!spec.part && (section.has("release") || section.has("release_distance"))) read_source(section, numbers, spec);
  } else if (is(BoundaryShape::wall, BoundaryShape::plank) && (section.has("point") || section.has("normal"))) {
    section.require_keys({"point", "normal"});
    numbers.read("point", spec.point);
    numbers.read("normal", spec.normal);
    if (numbers.dimension() == 2)
      section.fail("point", fmt::format("from and to of a {} in the plane", to_string(spec.shape)), "point and normal");
    if (is(BoundaryShape::plank)) {
      section.require_keys({"axis", "length"});
      numbers.read("axis", spec.axis);
      section.read("length", spec.length, Field{.unit = "m", .above = 0});
      section.read("width", spec.width, Field{.unit = "m", .minimum = 0});
    }
  } else {
    read_ends(section, numbers, spec);
  }
  if (is(BoundaryShape::disks, BoundaryShape::cylinder, BoundaryShape::plank)) {
    section.require_keys({"radius"});
    section.read("radius", spec.radius, Field{.above = 0});
  }
  if (is(BoundaryShape::disks)) section.read("spacing", spec.spacing, Field{.minimum = 0});
  if (is(BoundaryShape::cylinder)) {
    section.read("side", spec.side);
    section.read("ends", spec.ends);
  }
  if (!spec.part) {
    if (is(BoundaryShape::disks, BoundaryShape::grains)) section.read("orientation", spec.orientation);
    section.read("colour", spec.colour);
    spec.motion = read_motion(section, numbers, spec.default_centre());
    spec.body = read_body(section, numbers);
  }
  spec.dimension = numbers.dimension();
  section.finish();
  section.located("", [&] { check(spec); });
  return spec;
}

}  // namespace nscdd
