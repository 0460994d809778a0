// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/case_file.hpp"

#include "files/csv.hpp"
#include "files/strict_toml.hpp"
#include "formats/case_dynamics.hpp"
#include <nscdd/formats/fclib.hpp>
#include <nscdd/formats/packing_file.hpp>
#include <nscdd/formats/read_model.hpp>

#include <filesystem>

namespace nscdd {
namespace {

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

void read_problem_section(StrictTable section, CaseSpec& spec) {
  if (!section.has("file")) section.fail("file", "the name of a contact problem", "none");
  section.read("file", spec.packing.emplace<ContactProblemFile>().path);
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
  if (dense)
    check_bounds(masses.density, Field{.description = "", .minimum = 0, .minimum_excluded = true},
                 section.where("density"));
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

void read_prescribed(StrictTable section, CaseSpec& spec) {
  PrescribedVelocity velocity;
  for (const char* key : {"grain", "velocity"})
    if (!section.has(key)) section.fail(key, "a value", "none");
  section.read("grain", velocity.grain);
  section.read("velocity", velocity.velocity);
  check_bounds(velocity.velocity, Field{.description = ""},
               fmt::format("{}: {}", section.location(section.node("velocity")), section.key_path("velocity")));
  section.finish();
  for (const PrescribedVelocity& other : spec.prescribed)
    if (other.grain == velocity.grain)
      section.fail("grain", "each grain once", fmt::format("grain {} again", velocity.grain));
  spec.prescribed.push_back(velocity);
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
void read_sections(StrictTable& root, CaseSpec& spec) {
  root.read("title", spec.title);
  if (root.has("problem")) {
    read_problem_section(root.section("problem", true), spec);
    read_partition_section(root.section("partition", true), spec.partition);
    return;
  }
  read_packing_section(root.section("packing", true), spec);
  StrictTable contacts = root.section("contacts", false);
  contacts.read_fields(spec.contacts);
  contacts.finish();
  if (root.has("masses")) read_masses_section(root.section("masses", false), spec.masses);
  root.node("masses");
  read_partition_section(root.section("partition", true), spec.partition);
  StrictTable loads = root.section("loads", false);
  loads.read_fields(spec.loads);
  loads.finish();
  for (const StrictTable& prescribed : root.tables("prescribed")) read_prescribed(prescribed, spec);
  spec.dynamics = read_dynamics(root);
}

}  // namespace

CaseSpec parse_case(std::string_view text, const std::string& file) {
  const toml::table document = parse_toml(text, file);
  StrictTable root(document, file, "");
  CaseSpec spec;
  spec.name = std::filesystem::path(file).stem().string();
  spec.source = file;
  read_sections(root, spec);
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
    one.packing = at_key(one.spec, "packing.file", [&] { return read_packing(beside(file->path)); });
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
