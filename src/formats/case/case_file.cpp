// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/case/case_file.hpp"

#include "core/fail.hpp"
#include "files/csv.hpp"
#include "files/strict_toml.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"
#include "simulation/clumps.hpp"
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
    auto& file = spec.packing.emplace<PackingFile>();
    section.read("file", file.path);
    section.read("forces", file.forces);
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
  if (dense) check_bounds(masses.density, Field{.above = 0}, section.where("density"));
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
  section.read("velocity", velocity.velocity, Field{});
  const auto dimension = static_cast<Index>(velocity.velocity.size());
  if (const Index of_spin = read_spin(section, "spin", velocity.spin); of_spin > 0 && of_spin != dimension)
    section.fail("spin",
                 dimension == 2 ? "one number in the plane, as velocity" : "three numbers in space, as velocity",
                 dimension == 2 ? "three" : "one");
  section.finish();
  if (std::ranges::count(spec.prescribed, velocity.grain, &PrescribedVelocity::grain) > 0)
    section.fail("grain", "each grain once", fmt::format("grain {} again", velocity.grain));
  spec.prescribed.push_back(velocity);
}

// A key with another value than its default must have an effect. (A case that the program wrote has all keys.) Without
// `algorithm` all keys of [solver] must: they may have been written for another algorithm than the default.
template <class Parameters>
void require_effects(const StrictTable& section, const Dynamics& dynamics, const Parameters& parameters) {
  const std::vector<FieldDescription> now = describe_fields(parameters), by_default = describe_fields(Parameters{});
  const bool stated = !std::is_same_v<Parameters, StepSolver> || section.has("algorithm");
  for (std::size_t k = 0; k < now.size(); ++k)
    if (section.has(now[k].key) && (!stated || now[k].value != by_default[k].value))
      require_effect(dynamics, section.key_path(now[k].key), section.where(now[k].key), stated);
}

// Whether a boundary has an initial velocity along a direction in which it is driven.
bool starts_driven(const BoundarySpec& spec) {
  if (!spec.motion.initial || !spec.body) return spec.motion.initial.has_value();
  RigidVelocity initial = *spec.motion.initial;
  for (std::size_t k = 0; k < spec.body->directions.size(); ++k)
    if (!spec.body->directions[k] && along(initial, static_cast<BodyDirection>(k)) != 0) return true;
  return false;
}

// The sections [dynamics] and, only with it, [interaction], [solver] and [[boundary]].
std::optional<Dynamics> read_dynamics(StrictTable& root, bool effects_wanted) {
  const bool moves = root.has("dynamics");
  for (const char* key : {"dynamics", "interaction", "solver", "boundary", "colour", "pair"}) root.node(key);
  for (const char* key : {"interaction", "solver", "boundary", "colour", "pair"})
    if (!moves && root.has(key)) {
      root.finish();  // names a misspelt [dynamics]
      root.fail(key, "a section [dynamics] with it", "none");
    }
  if (!moves) return std::nullopt;
  Dynamics dynamics;
  const StrictTable interaction = root.read_section("interaction", dynamics.interaction);
  const StrictTable time = root.read_section("dynamics", dynamics.time);
  StrictTable solver = root.section("solver", false);
  if (!effects_wanted) solver.node("interface_network");  // of version 0.2.0, see interface_preconditioner
  solver.read_fields(dynamics.solver);
  solver.finish();
  if (effects_wanted) {
    require_effects(interaction, dynamics, dynamics.interaction);
    require_effects(time, dynamics, dynamics.time);
    require_effects(solver, dynamics, dynamics.solver);
  }
  for (const StrictTable& boundary : root.tables("boundary")) {
    const BoundarySpec spec = read_boundary(boundary);
    const auto whole = std::ranges::find(dynamics.boundaries, spec.name, &BoundarySpec::name);
    const bool named = whole != dynamics.boundaries.end();
    if (named && !spec.part) boundary.fail("name", "each name once", fmt::format("{} again", field_text(spec.name)));
    if (spec.part && (!named || whole->source))
      boundary.fail("part_of", "the name of a boundary before this one that is no source", field_text(spec.name));
    if (effects_wanted && dynamics.time.boundary_instant == BoundaryInstant::middle && starts_driven(spec))
      boundary.fail(boundary.has("initial_velocity") ? "initial_velocity" : "initial_spin",
                    fmt::format("{}dynamics.boundary_instant = \"end\" with it",
                                spec.body ? "0 along driven directions, or " : ""),
                    "\"middle\", the default");
    dynamics.boundaries.push_back(spec);
  }
  read_pairs(root, dynamics, effects_wanted);
  return dynamics;
}

// Stores the place of each node below `node`, by its path.
void note_places(const toml::node& node, const std::string& path, CaseSpec& spec) {
  if (const auto line = node.source().begin.line; line > 0) spec.places[path] = fmt::format("{}:{}", spec.source, line);
  if (const toml::table* table = node.as_table())
    for (const auto& [key, value] : *table)
      note_places(value, (path.empty() ? "" : path + ".") + std::string(key.str()), spec);
  if (const toml::array* array = node.as_array())
    for (std::size_t i = 0; i < array->size(); ++i) note_places((*array)[i], fmt::format("{}[{}]", path, i), spec);
}

// Sections of a packing are unknown keys of a contact problem.
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
  if (const auto* file = std::get_if<PackingFile>(&spec.packing); file && !file->forces.empty() && !spec.dynamics)
    root.section("packing", true).fail("forces", "a section [dynamics] with it", "none");
  const auto spins = [](const PrescribedVelocity& one) { return one.spin != std::array<double, 3>{}; };
  if (!spec.dynamics && std::ranges::any_of(spec.prescribed, spins))
    root.fail("prescribed", "a spin only with [dynamics], since the linear study has none", "one without");
}

// What is no input of the program.
std::string what_is_met(const std::filesystem::path& path, const std::string& text) {
  if (std::filesystem::is_directory(path)) return "a folder without BODIES.DAT";
  if (!std::filesystem::exists(path)) return "no such file";
  if (text.empty() && path.extension() == ".txt") return "an empty file";
  if (text.empty()) return fmt::format("a name that ends with '{}'", path.extension().string());
  return fmt::format("the first line {}", field_text(text.substr(0, std::min<std::size_t>(text.find('\n'), 60))));
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
  note_places(document, "", spec);
  return spec;
}

CaseSpec read_case(const std::string& path) { return parse_case(read_text(path), path); }

CaseSpec spec_of_file(const std::string& path, bool moving) {
  const bool record = record_at(path).has_value();  // a contact problem, and the initial state of a case that moves
  if (holds_datbox(path) && (moving || !record)) return case_of_datbox(path, moving);
  const std::filesystem::path extension = std::filesystem::path(path).extension();
  if (extension == ".toml") return read_case(path);
  CaseSpec spec;
  if (record || has_vloc_rloc_name(path)) {
    spec.name = datbox_name(std::filesystem::absolute(path).parent_path().string());
    spec.packing = ContactProblemFile{path};
    return spec;
  }
  spec.name = std::filesystem::path(path).stem().string();
  const auto format = packing_format(path);
  bool problem = format == PackingFormat::hdf5 && holds_fclib(read_text(path), path);
  if (!format) {
    const bool siconos = has_siconos_name(path);
    const std::string text = siconos || extension == ".txt" ? read_text(path) : "";
    require_utf8(text, path);
    const bool packing = is_text_packing(text);
    if (!packing && !siconos)
      fail(
          "{}: expected a case file (.toml), a packing file (.csv, .h5 or .hdf5, or .txt with lines 'x y radius'), a "
          "folder with BODIES.DAT or a contact problem (.hdf5, .dat or Vloc_Rloc.INI), met {}",
          path, what_is_met(path, text));
    problem = !packing;
  }
  if (problem)
    spec.packing = ContactProblemFile{path};
  else
    spec.packing = PackingFile{path};
  if (moving && !problem) spec.dynamics.emplace();
  return spec;
}

void add_clumps(Case& one) {
  if (!one.spec.dynamics || one.packing.clump.empty()) return;
  try {
    add_clumps(one.spec.dynamics->boundaries, with_masses(one.packing, one.spec.masses), one.spec.contacts.period());
  } catch (const Error& error) {
    throw located(one.spec, error);
  }
}

Case resolve(CaseSpec spec) {
  Case one{std::move(spec)};
  const auto beside = [folder = std::filesystem::path(one.spec.source).parent_path()](const std::string& name) {
    return (folder / name).string();
  };
  if (const auto* file = std::get_if<PackingFile>(&one.spec.packing)) {
    one.packing = at_key(one.spec, "packing.file", [&] {
      const std::string path = beside(file->path);
      const bool moves = one.spec.dynamics.has_value() && holds_datbox(path);
      return moves ? datbox_packing(read_datbox(path), DatboxGrains::all) : read_packing(path);
    });
    const auto read_forces = [&] { return read_contact_forces(beside(file->forces)); };
    if (!file->forces.empty())
      one.start = one.spec.source.empty() ? read_forces() : at_key(one.spec, "packing.forces", read_forces);
  }
  add_clumps(one);
  if (const auto* file = std::get_if<ContactProblemFile>(&one.spec.packing))
    one.problem =
        at_key(one.spec, "problem.file", [&] { return read_global_problem(beside(file->path), &one.points); });
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
