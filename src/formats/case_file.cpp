// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/strict_toml.hpp"
#include "formats/case_dynamics.hpp"
#include <nscdd/files/csv.hpp>
#include <nscdd/formats/case_file.hpp>
#include <nscdd/formats/fclib.hpp>
#include <nscdd/formats/packing_file.hpp>

#include <filesystem>

namespace nscdd {
namespace {

// Sets `chosen` to the alternative of that name, with its fields read from the section.
template <std::size_t I = 0>
bool read_generator(StrictTable& section, std::string_view name, Generator& chosen) {
  if constexpr (I == std::variant_size_v<Generator>) {
    return false;
  } else {
    using Alternative = std::variant_alternative_t<I, Generator>;
    if (Alternative::name != name) return read_generator<I + 1>(section, name, chosen);
    Alternative parameters;
    section.read_fields(parameters);
    chosen = parameters;
    return true;
  }
}

std::string generator_names() {
  std::string names;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((names += (I == 0 ? "\"" : ", \"") + std::string(std::variant_alternative_t<I, Generator>::name) + "\""),
     ...);
  }
  (std::make_index_sequence<std::variant_size_v<Generator>>());
  return names;
}

template <class Read>
auto read_named(StrictTable& section, const char* key, Read&& read) {
  std::string name;
  section.read(key, name);
  try {
    return read(name);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: packing.{}: {}", section.location(section.node(key)), key, error.what()));
  }
}

Generator named_generator(StrictTable& section) {
  std::string name;
  section.read("generator", name);
  Generator generator;
  if (!read_generator(section, name, generator))
    section.fail("generator", fmt::format("one of {}", generator_names()), fmt::format("\"{}\"", name));
  return generator;
}

void read_packing_section(StrictTable section, Case& one, const PackingReader& read,
                          const SettledReader& settle) {
  const int forms = section.has("generator") + section.has("file") + section.has("settled");
  if (section.has("settled") && forms > 1)
    section.fail("settled", "one of generator = ..., file = ... and settled = ...", "more");
  if (forms != 1)
    section.fail("generator", "either generator = ... or file = ...", forms > 0 ? "both" : "neither");
  if (section.has("file")) {
    one.packing = read_named(section, "file", [&](const std::string& name) {
      return PackingFile{name, read(name)};
    });
  } else if (section.has("settled")) {
    one.packing = read_named(section, "settled", [&](const std::string& name) {
      if (!settle) throw Error("expected a generator or a file: nothing can be settled here");
      return settle(name);
    });
  } else {
    one.packing = named_generator(section);
  }
  section.finish();
}

void read_problem_section(StrictTable section, Case& one, const ProblemReader& read) {
  if (!section.has("file")) section.fail("file", "the name of a contact problem", "none");
  ContactProblemFile file;
  section.read("file", file.path);
  try {
    if (!read) throw Error(fmt::format("{}: expected no contact problem here, met one", file.path));
    file.problem = read(file.path);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: problem.file: {}", section.location(section.node("file")), error.what()));
  }
  one.packing = std::move(file);
  section.finish();
}

void read_masses_section(StrictTable section, Masses& masses) {
  std::string model;
  section.read("model", model);
  section.read("density", masses.density);
  if (section.has("density") && model.empty()) model = "density";
  if (model == "given") {
    masses.model = MassModel::given;
  } else if (model == "unit") {
    masses.model = MassModel::unit;
  } else if (model == "density") {
    masses.model = MassModel::density;
    if (!section.has("density")) section.fail("density", "a number for model \"density\"", "none");
  } else if (section.has("model")) {
    section.fail("model", "\"given\", \"unit\" or \"density\"", fmt::format("\"{}\"", model));
  }
  if (section.has("density")) {
    if (masses.model != MassModel::density)
      section.fail("density", "no density", fmt::format("one, with model \"{}\"", model));
    check_bounds(masses.density, Field{.description = "", .minimum = 0, .minimum_excluded = true},
                 fmt::format("{}: masses.density", section.location(section.node("density"))));
  }
  section.finish();
}

void read_partition_section(StrictTable section, Partitioner& partitioner) {
  int found = 0;
  std::string forms;
  for_each_partitioner([&](auto one) {
    found += section.has(one.name);
    forms += fmt::format("{}{}", forms.empty() ? "" : " or ", one.key_form);
  });
  if (found != 1) section.fail(GridPartitioner::name, "either " + forms, found == 0 ? "neither" : "both");
  for_each_partitioner([&](auto one) {
    if (!section.has(one.name)) return;
    section.read_fields(one);
    partitioner = one;
  });
  section.finish();
}

void read_prescribed(StrictTable section, Case& one) {
  PrescribedVelocity velocity;
  for (const char* key : {"grain", "velocity"})
    if (!section.has(key)) section.fail(key, "a value", "none");
  section.read("grain", velocity.grain);
  section.read("velocity", velocity.velocity);
  check_bounds(
      velocity.velocity, Field{.description = ""},
      fmt::format("{}: {}", section.location(section.node("velocity")), section.key_path("velocity")));
  section.finish();
  for (const PrescribedVelocity& other : one.prescribed)
    if (other.grain == velocity.grain)
      section.fail("grain", "each grain once", fmt::format("grain {} again", velocity.grain));
  one.prescribed.push_back(velocity);
}

}  // namespace

Case parse_case(std::string_view text, const std::string& file, const PackingReader& read,
                const SettledReader& settle, const ProblemReader& read_problem) {
  const toml::table document = parse_toml(text, file);
  StrictTable root(document, file, "");
  Case one;
  one.name = std::filesystem::path(file).stem().string();
  one.source = file;
  root.read("title", one.title);
  if (root.has("problem")) {
    // The sections of packings are unknown keys then, and named as such.
    read_problem_section(root.section("problem", true), one, read_problem);
    read_partition_section(root.section("partition", true), one.partition);
    root.finish();
    return one;
  }
  read_packing_section(root.section("packing", true), one, read, settle);
  StrictTable contacts = root.section("contacts", false);
  contacts.read_fields(one.contacts);
  contacts.finish();
  if (root.has("masses")) read_masses_section(root.section("masses", false), one.masses);
  root.node("masses");
  read_partition_section(root.section("partition", true), one.partition);
  StrictTable loads = root.section("loads", false);
  loads.read_fields(one.loads);
  loads.finish();
  for (const StrictTable& prescribed : root.tables("prescribed")) read_prescribed(prescribed, one);
  one.dynamics = read_dynamics(root);
  root.finish();
  return one;
}

Case read_case(const std::string& path, const SettledReader& settle) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const auto beside = [&](const std::string& name) {
    return std::filesystem::path(name).is_absolute() ? name : (folder / name).string();
  };
  return parse_case(
      read_text(path), path, [&](const std::string& name) { return read_packing(beside(name)); }, settle,
      [&](const std::string& name) { return read_global_problem(beside(name)); });
}

}  // namespace nscdd
