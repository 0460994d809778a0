// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/study/case.hpp>

#include <fmt/format.h>

namespace nscdd {
namespace {

template <class Parameters>
std::string keys_of(std::string_view section, const Parameters& parameters) {
  std::string keys;
  for (const FieldDescription& field : describe_fields(parameters))
    keys += fmt::format("{}{}.{}", keys.empty() ? "" : ", ", section, field.key);
  return keys;
}

// Overrides a field of a section, or says which fields the section has.
template <class Parameters>
void override_section(std::string_view section, Parameters& parameters, std::string_view key,
                      std::string_view path, std::string_view value) {
  if (!override_field(parameters, key, value, path))
    throw Error(fmt::format("{}: no such parameter in this case; expected one of {}", path,
                            keys_of(section, parameters)));
}

void override_dynamics(std::optional<Dynamics>& dynamics, std::string_view section, std::string_view key,
                       std::string_view path, std::string_view value) {
  if (!dynamics)
    throw Error(fmt::format("{}: expected a case with a section [dynamics], met one without", path));
  if (section == "interaction") {
    override_section(section, dynamics->interaction, key, path, value);
  } else if (section == "dynamics") {
    override_section(section, dynamics->time, key, path, value);
  } else {
    if (key == "eta") check_eta(value, path);
    override_section(section, dynamics->solver, key, path, value);
  }
}

// The optional fields of Masses, in the form the visitors take.
struct MassFields {
  double density;
  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("density", self.density,
          Field{.description = "surface density", .unit = "kg/m^2", .minimum = 0, .minimum_excluded = true});
  }
};

// One subdomain, or by the graph of contacts.
Partition partition_without_geometry(const Partitioner& partitioner, const ReferenceProblem& problem,
                                     const std::string& path) {
  if (subdomains(partitioner) == 1)
    return {.subdomains = 1, .subdomain_of_contact = std::vector<Index>(at(problem.contacts()), 0)};
  const auto refuse = [&]() -> std::pair<Packing, ContactNetwork> {
    throw Error(fmt::format(
        "{}: expected subdomains metis:N (partition.metis) for a contact problem, of which no geometry is "
        "known, met {} subdomains by another partitioner",
        path, subdomains(partitioner)));
  };
  return distribute(partitioner, refuse, [&]() -> const ReferenceProblem& { return problem; });
}

Model build_contact_problem(const Case& one, const ContactProblemFile& file) {
  if (!one.prescribed.empty())
    throw Error(fmt::format(
        "{}: expected no prescribed velocities for a contact problem, whose loads are those of its f, met {}",
        file.path, one.prescribed.size()));
  Model model;
  model.name = one.name;
  model.problem = reference_problem(file.problem, file.path);
  model.partition = partition_without_geometry(one.partition, model.problem, file.path);
  model.parts = decompose(model.problem, model.partition);
  return model;
}

// Prescribed velocities with their grains counted from 0, each once.
std::vector<PrescribedVelocity> numbered(std::vector<PrescribedVelocity> prescribed, Index grains) {
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    PrescribedVelocity& velocity = prescribed[k];
    if (velocity.grain < -grains || velocity.grain >= grains)
      throw Error(
          fmt::format("prescribed[{}].grain: expected a grain in 0..{} (or -1 for the last), met grain {}", k,
                      grains - 1, velocity.grain));
    if (velocity.grain < 0) velocity.grain += grains;
    for (const PrescribedVelocity* other = prescribed.data(); other != &velocity; ++other)
      if (other->grain == velocity.grain)
        throw Error(fmt::format("prescribed[{}].grain: expected each grain once, met grain {} again", k,
                                velocity.grain));
  }
  return prescribed;
}

}  // namespace

void override_case(Case& one, std::string_view path, std::string_view value) {
  const auto dot = path.find('.');
  const std::string_view section = path.substr(0, dot);
  const std::string_view key = dot == std::string_view::npos ? std::string_view{} : path.substr(dot + 1);
  if (std::holds_alternative<ContactProblemFile>(one.packing) && section != "partition")
    throw Error(fmt::format("{}: this case is a contact problem; expected partition.* alone", path));
  if (section == "packing") {
    auto* generator = std::get_if<Generator>(&one.packing);
    if (generator == nullptr)
      throw Error(fmt::format("{}: the packing of this case is {} and has no parameters", path,
                              std::holds_alternative<PackingFile>(one.packing) ? "a file" : "settled"));
    std::visit([&](auto& parameters) { override_section(section, parameters, key, path, value); },
               *generator);
  } else if (section == "contacts") {
    override_section(section, one.contacts, key, path, value);
  } else if (section == "masses") {
    MassFields masses{one.masses.density};
    override_section(section, masses, key, path, value);
    one.masses = {MassModel::density, masses.density};
  } else if (section == "partition") {
    std::visit([&](auto& parameters) { override_section(section, parameters, key, path, value); },
               one.partition);
  } else if (section == "loads") {
    override_section(section, one.loads, key, path, value);
  } else if (section == "interaction" || section == "dynamics" || section == "solver") {
    override_dynamics(one.dynamics, section, key, path, value);
  } else {
    throw Error(
        fmt::format("{}: no such parameter; expected packing.*, contacts.*, masses.*, partition.*, loads.*, "
                    "interaction.*, dynamics.* or solver.*",
                    path));
  }
}

std::string to_toml(const Case& one) {
  const std::string partition =
      "\n[partition]\n" + std::visit([](const auto& p) { return field_lines(p); }, one.partition);
  if (const auto* file = std::get_if<ContactProblemFile>(&one.packing))
    return fmt::format("title = {}\n\n[problem]\nfile = {}\n", field_text(one.title),
                       field_text(file->path)) +
           partition;
  std::string text = fmt::format("title = {}\n\n[packing]\n", field_text(one.title));
  if (const auto* file = std::get_if<PackingFile>(&one.packing)) {
    text += fmt::format("file = {}\n", field_text(file->path));
  } else if (const auto* settled = std::get_if<SettledPacking>(&one.packing)) {
    text += fmt::format("settled = {}\n", field_text(settled->from));
  } else {
    std::visit(
        [&](const auto& parameters) {
          text += fmt::format("generator = \"{}\"\n{}", parameters.name, field_lines(parameters));
        },
        std::get<Generator>(one.packing));
  }
  text += "\n[contacts]\n" + field_lines(one.contacts);
  if (one.masses.model) {
    text += "\n[masses]\n";
    switch (*one.masses.model) {
      case MassModel::given:
        text += "model = \"given\"\n";
        break;
      case MassModel::unit:
        text += "model = \"unit\"\n";
        break;
      case MassModel::density:
        text += fmt::format("model = \"density\"\ndensity = {}\n", one.masses.density);
        break;
    }
  }
  text += partition;
  if (!one.loads.none()) text += "\n[loads]\n" + field_lines(one.loads);
  for (const PrescribedVelocity& velocity : one.prescribed)
    text += fmt::format("\n[[prescribed]]\ngrain = {}\nvelocity = {}\n", velocity.grain,
                        field_text(velocity.velocity));
  if (one.dynamics) text += to_toml(*one.dynamics);
  return text;
}

Packing packing_of(const Case& one, const Monitor& monitor) {
  if (const auto* file = std::get_if<ContactProblemFile>(&one.packing))
    throw Error(
        fmt::format("{}: expected a packing, met a contact problem, which has no geometry", file->path));
  Packing packing;
  if (const auto* file = std::get_if<PackingFile>(&one.packing))
    packing = file->packing;
  else if (const auto* settled = std::get_if<SettledPacking>(&one.packing))
    packing = settled->packing;
  else
    packing = generate(std::get<Generator>(one.packing), monitor);
  check(packing);
  return one.masses.model ? with_masses(std::move(packing), one.masses) : packing;
}

void require_geometry(const Model& model, std::string_view what) {
  if (!model.has_geometry())
    throw Error(
        fmt::format("{}: {}: expected a packing, met a contact problem, of which no geometry is known",
                    model.name, what));
}

namespace {

// What the first step would refuse is refused here, before anything is written.
void check_first_step(const Simulation& simulation) {
  const Dynamics& dynamics = simulation.dynamics;
  const StepProblem first =
      prepare_step(simulation.system, simulation.state, dynamics.interaction, dynamics.time, false);
  check_overlaps(simulation.system, first, largest_overlap);
}

// What arrives in the linear study starts with that velocity here.
void set_moving(const Case& one, const Packing& packing, GranularScene& start) {
  ContactNetwork none;
  none.grains = packing.size();
  const std::vector<PrescribedVelocity> prescribed = numbered(one.prescribed, packing.size());
  for (std::size_t k = 0; k < prescribed.size(); ++k)
    if (const Index grain = prescribed[k].grain; !start.system.free(grain))
      throw Error(fmt::format("prescribed[{}].grain: expected a free grain, met {}", k,
                              body_name(start.system, grain)));
  const Vector v = assemble(packing, none, prescribed, one.loads).arriving_velocity;
  for (Index i = 0; i < packing.size(); ++i) {
    if (!start.system.free(i)) continue;
    start.state.velocity_x[at(i)] = v[2 * i];
    start.state.velocity_y[at(i)] = v[2 * i + 1];
  }
}

Simulation unnamed_simulation_of(const Case& one, const Monitor& monitor) {
  check_dynamics(one);
  const Packing packing = with_masses(packing_of(one, monitor), one.masses);
  GranularScene start = scene(packing, *one.dynamics);
  set_moving(one, packing, start);
  Simulation simulation{std::move(start.system), std::move(start.state), *one.dynamics, one.partition};
  check_first_step(simulation);
  return simulation;
}

}  // namespace

Simulation simulation_of(const Case& one, const Monitor& monitor) {
  try {
    return unnamed_simulation_of(one, monitor);
  } catch (const Error& error) {
    if (one.source.empty()) throw;
    throw Error(fmt::format("{}: {}", one.source, error.what()));
  }
}

Model build(const Case& one, const Monitor& monitor) {
  if (const auto* file = std::get_if<ContactProblemFile>(&one.packing))
    return build_contact_problem(one, *file);
  Model model;
  model.name = one.name;
  model.packing = with_masses(packing_of(one, monitor), one.masses);
  model.network = detect_contacts(model.packing, one.contacts);
  const std::vector<PrescribedVelocity> prescribed = numbered(one.prescribed, model.packing.size());
  model.problem = assemble(model.packing, model.network, prescribed, one.loads);
  model.partition = distribute(
      one.partition, [&] { return std::tie(model.packing, model.network); },
      [&]() -> const ReferenceProblem& { return model.problem; });
  model.parts = decompose(model.problem, model.partition);
  return model;
}

}  // namespace nscdd
