// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/case_file.hpp"

#include "files/csv.hpp"
#include "files/strict_toml.hpp"
#include "formats/datbox.hpp"
#include <nscdd/formats/fclib.hpp>
#include <nscdd/formats/packing_file.hpp>
#include <nscdd/formats/read_model.hpp>

#include <filesystem>

namespace nscdd {
namespace {

constexpr Field finite{.description = ""};
constexpr Field not_negative{.description = "", .minimum = 0};
constexpr Field positive{.description = "", .minimum = 0, .minimum_excluded = true};

Generator read_generator(StrictTable& section) {
  using Generators = Alternatives<Generator>;
  std::string name;
  section.read("generator", name);
  Generator generator = Generators::at(position_of(name, Generators::names, section.where("generator")));
  std::visit([&](auto& parameters) { section.read_fields(parameters); }, generator);
  return generator;
}

void read_packing_section(StrictTable section, CaseSpec& spec) {
  const int forms = section.has("generator") + section.has("file") + section.has("settled");
  if (section.has("settled") && forms > 1)
    section.fail("settled", "one of generator = ..., file = ... and settled = ...", "more");
  if (forms != 1) section.fail("generator", "either generator = ... or file = ...", forms > 0 ? "both" : "neither");
  if (section.has("generator")) {
    spec.packing = read_generator(section);
  } else if (section.has("file")) {
    section.read("file", spec.packing.emplace<PackingFile>().path);
  } else {
    section.read("settled", spec.packing.emplace<SettledFrom>().name);
  }
  section.finish();
}

void read_masses_section(StrictTable section, Masses& masses) {
  const bool dense = section.has("density");
  Choice<MassModel> model = dense ? MassModel::density : MassModel::given;
  section.read("model", model);
  section.read("density", masses.density);
  if (dense || section.has("model")) masses.model = model;
  if (dense != (masses.model == MassModel::density))
    section.fail("density", dense ? "no density" : "a number for model \"density\"",
                 dense ? fmt::format("one, with model \"{}\"", to_string(model)) : "none");
  if (dense) check_bounds(masses.density, positive, section.where("density"));
  section.finish();
}

void read_partition_section(StrictTable section, Partitioner& partitioner) {
  int found = 0;
  std::vector<std::string_view> forms;
  for_each_partitioner([&](auto one) {
    found += section.has(one.name);
    forms.push_back(one.key_form);
  });
  if (found != 1)
    section.fail(GridPartitioner::name, fmt::format("either {}", fmt::join(forms, " or ")),
                 found == 0 ? "neither" : "both");
  for_each_partitioner([&](auto one) {
    if (!section.has(one.name)) return;
    section.read_fields(one);
    partitioner = one;
  });
  section.finish();
}

void read_prescribed(StrictTable section, CaseSpec& spec) {
  PrescribedVelocity velocity;
  section.require_keys({"grain", "velocity"});
  section.read("grain", velocity.grain);
  section.read("velocity", velocity.velocity, finite);
  section.finish();
  for (const PrescribedVelocity& other : spec.prescribed)
    if (other.grain == velocity.grain)
      section.fail("grain", "each grain once", fmt::format("grain {} again", velocity.grain));
  spec.prescribed.push_back(velocity);
}

// The numbers of a boundary have two components in the plane and three in space, all of them alike.
class BoundaryNumbers {
 public:
  explicit BoundaryNumbers(StrictTable& section) : section_(section) {}

  void read(const char* key, std::array<double, 3>& value) {
    if (section_.node(key) == nullptr) return;
    Components<double> numbers;
    section_.read(key, numbers, finite);
    take(section_.node(key), key, static_cast<Index>(numbers.size()));
    value = {numbers[0], numbers[1], numbers[2]};
  }
  /// A spin is one number in the plane, and three in space.
  void read_spin(std::array<double, 3>& spin) {
    const toml::node* found = section_.node("spin");
    if (found == nullptr) return;
    if (!found->is_array()) {
      section_.read("spin", spin[2], finite);
      take(found, "spin", 2);
      return;
    }
    read("spin", spin);
    if (dimension_ == 2) section_.fail("spin", "one number in the plane, or three in space", "an array of 2");
  }
  /// Notes that an entry has this dimension, and throws Error where others have another one.
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

// One entry of a motion: four numbers in the plane, [t, vx, vy, spin], or seven in space.
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
  std::array<double, 3> velocity{}, spin{};
  numbers.read("velocity", velocity);
  numbers.read_spin(spin);
  const bool uniform = section.has("velocity") || section.has("spin");
  if (section.node("motion") == nullptr) {
    if (uniform) {
      motion.time = {0};
      motion.velocity = {{velocity[0], velocity[1], spin[2], velocity[2], spin[0], spin[1]}};
    }
    return motion;
  }
  if (uniform) section.fail("motion", "either motion = ... or velocity and spin", "both");
  read_motion_table(section, numbers, motion);
  return motion;
}

// A key that is given with another value than its default must have an effect. (A case that the program wrote has
// every key, those without effect at their defaults.) Where no algorithm is stated all keys of [solver] must: they may
// have been written for another algorithm than the default.
template <class Parameters>
void require_effects(const StrictTable& section, const Dynamics& dynamics, const Parameters& parameters) {
  const std::vector<FieldDescription> now = describe_fields(parameters), by_default = describe_fields(Parameters{});
  const bool stated = !std::is_same_v<Parameters, StepSolver> || section.has("algorithm");
  for (std::size_t k = 0; k < now.size(); ++k)
    if (section.has(now[k].key) && (!stated || now[k].value != by_default[k].value))
      require_effect(dynamics, section.key_path(now[k].key), section.where(now[k].key), stated);
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
    section.read("radius", spec.radius, positive);
  }
  if (spec.shape == BoundaryShape::disks) section.read("spacing", spec.spacing, not_negative);
  if (spec.shape == BoundaryShape::cylinder) section.read("side", spec.side);
  if (spec.shape == BoundaryShape::disks || spec.shape == BoundaryShape::grains)
    section.read("orientation", spec.orientation);
  spec.motion = read_motion(section, numbers);
  spec.dimension = numbers.dimension();
  section.finish();
  section.located("", [&] { check(spec); });
  return spec;
}

// The sections [dynamics], [interaction], [solver] and [[boundary]]. The last three need the first.
std::optional<Dynamics> read_dynamics(StrictTable& root, bool effects_wanted) {
  const bool moves = root.has("dynamics");
  for (const char* key : {"dynamics", "interaction", "solver", "boundary"}) root.node(key);
  for (const char* key : {"interaction", "solver", "boundary"})
    if (!moves && root.has(key)) {
      root.finish();  // [dynamics] may be spelt otherwise
      root.fail(key, "a section [dynamics] with it", "none");
    }
  if (!moves) return std::nullopt;
  Dynamics dynamics;
  const StrictTable interaction = root.read_section("interaction", dynamics.interaction);
  const StrictTable time = root.read_section("dynamics", dynamics.time);
  const StrictTable solver = root.read_section("solver", dynamics.solver);
  if (effects_wanted) {
    require_effects(interaction, dynamics, dynamics.interaction);
    require_effects(time, dynamics, dynamics.time);
    require_effects(solver, dynamics, dynamics.solver);
  }
  for (const StrictTable& boundary : root.tables("boundary")) {
    dynamics.boundaries.push_back(read_boundary(boundary));
    for (std::size_t k = 0; k + 1 < dynamics.boundaries.size(); ++k)
      if (dynamics.boundaries[k].name == dynamics.boundaries.back().name)
        boundary.fail("name", "each name once", fmt::format("{} again", field_text(dynamics.boundaries[k].name)));
  }
  return dynamics;
}

// The lines of everything below a node, by its path.
void note_lines(const toml::node& node, const std::string& path, CaseSpec& spec) {
  if (const auto line = node.source().begin.line; line > 0) spec.lines[path] = line;
  if (const toml::table* table = node.as_table())
    for (const auto& [key, value] : *table)
      note_lines(value, (path.empty() ? "" : path + ".") + std::string(key.str()), spec);
  if (const toml::array* array = node.as_array())
    for (std::size_t i = 0; i < array->size(); ++i) note_lines((*array)[i], fmt::format("{}[{}]", path, i), spec);
}

// A contact problem has none of the sections of a packing: they are unknown keys, and named as such.
void read_sections(StrictTable& root, CaseSpec& spec, bool effects_wanted) {
  root.read("title", spec.title);
  if (root.has("problem")) {
    StrictTable section = root.section("problem", true);
    if (!section.has("file")) section.fail("file", "the name of a contact problem", "none");
    section.read("file", spec.packing.emplace<ContactProblemFile>().path);
    section.finish();
    read_partition_section(root.section("partition", true), spec.partition);
    return;
  }
  read_packing_section(root.section("packing", true), spec);
  root.read_section("contacts", spec.contacts);
  if (root.has("masses")) read_masses_section(root.section("masses", false), spec.masses);
  root.node("masses");
  read_partition_section(root.section("partition", true), spec.partition);
  root.read_section("loads", spec.loads);
  for (const StrictTable& prescribed : root.tables("prescribed")) read_prescribed(prescribed, spec);
  spec.dynamics = read_dynamics(root, effects_wanted);
}

}  // namespace

CaseSpec parse_case(std::string_view text, const std::string& file, bool of_trajectory) {
  const toml::table document = parse_toml(text, file);
  StrictTable root(document, file, "");
  CaseSpec spec;
  spec.name = std::filesystem::path(file).stem().string();
  spec.source = file;
  read_sections(root, spec, !of_trajectory);
  root.finish();
  note_lines(document, "", spec);
  return spec;
}

CaseSpec read_case(const std::string& path) { return parse_case(read_text(path), path); }

Case resolve(CaseSpec spec) {
  Case one{std::move(spec)};
  const auto beside = [folder = std::filesystem::path(one.spec.source).parent_path()](const std::string& name) {
    return (folder / name).string();
  };
  if (const auto* file = std::get_if<PackingFile>(&one.spec.packing))
    one.packing = at_key(one.spec, "packing.file", [&] {
      const std::string path = beside(file->path);
      const bool moves = one.spec.dynamics.has_value() && holds_datbox(path);
      return moves ? datbox_packing(read_datbox(path), DatboxDisks::all) : read_packing(path);
    });
  if (const auto* file = std::get_if<ContactProblemFile>(&one.spec.packing))
    one.problem = at_key(one.spec, "problem.file", [&] { return read_global_problem(beside(file->path)); });
  if (std::holds_alternative<SettledFrom>(one.spec.packing))
    throw Error(where(one.spec, "packing.settled") + ": expected a generator or a file: nothing can be settled here");
  return one;
}

Model read_model(const std::string& case_file, const std::vector<std::pair<std::string, std::string>>& overrides) {
  CaseSpec spec = read_case(case_file);
  for (const auto& [key, value] : overrides) override_case(spec, key, value);
  return build(resolve(std::move(spec)));
}

}  // namespace nscdd
