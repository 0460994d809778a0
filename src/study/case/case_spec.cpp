// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/case/case_spec.hpp"

#include "core/fail.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

// Overrides a field of a section. Throws Error naming its fields for another key.
template <class Parameters>
void override_section(std::string_view section, Parameters& parameters, std::string_view key, std::string_view path,
                      std::string_view value) {
  if (override_field(parameters, key, value, path)) return;
  std::vector<std::string> known;
  for (const FieldDescription& field : describe_fields(parameters)) known.push_back(field.key);
  const std::string before = fmt::format("{}.", section);
  fail("{}: no such parameter in this case; expected one of {}{}{}", path, before, fmt::join(known, ", " + before),
       suggestion(key, known, before));
}

// "file:line: ", as far as known.
std::string place(const CaseSpec& spec, std::string_view key) {
  const auto found = spec.places.find(key);
  if (!key.empty() && found != spec.places.end() && !found->second.empty()) return found->second + ": ";
  return spec.source.empty() ? "" : spec.source + ": ";
}

}  // namespace

std::string where(const CaseSpec& spec, std::string_view key) { return place(spec, key).append(key); }

Error located(const CaseSpec& spec, const Error& error) { return Error(place(spec, error.key()) + error.what()); }

void override_case(CaseSpec& spec, std::string_view path, std::string_view value) {
  spec.remarks.erase(std::string(path));
  const auto dot = path.find('.');
  const std::string_view section = path.substr(0, dot);
  const std::string_view key = dot == std::string_view::npos ? std::string_view{} : path.substr(dot + 1);
  if (std::holds_alternative<ContactProblemFile>(spec.packing) && section != "partition")
    fail("{}: this case is a contact problem; expected only partition.*", path);
  const auto set = [&](auto& parameters) { override_section(section, parameters, key, path, value); };
  const auto dynamics = [&]() -> Dynamics& {
    if (spec.dynamics) return *spec.dynamics;
    fail("{}: expected a case with a section [dynamics], met one without", path);
  };
  const auto packing = [&] {
    auto* generator = std::get_if<Generator>(&spec.packing);
    if (generator == nullptr)
      fail("{}: the packing of this case is {} and has no parameters", path,
           std::holds_alternative<PackingFile>(spec.packing) ? "a file" : "settled");
    std::visit(set, *generator);
  };
  const auto masses = [&] {
    set(spec.masses);
    spec.masses.model = MassModel::density;
  };
  const std::vector<std::pair<std::string, std::function<void()>>> sections{
      {"packing", packing},
      {"contacts", [&] { set(spec.contacts); }},
      {"masses", masses},
      {"partition", [&] { std::visit(set, spec.partition); }},
      {"loads", [&] { set(spec.loads); }},
      {"interaction", [&] { set(dynamics().interaction); }},
      {"dynamics", [&] { set(dynamics().time); }},
      {"solver", [&] { set(dynamics().solver); }}};
  std::vector<std::string> known;
  for (const auto& one : sections) known.push_back(one.first);
  const auto found = std::ranges::find(known, section);
  if (found == known.end())
    fail("{}: no such parameter; expected one of {}.*{}", path, fmt::join(known, ".*, "), suggestion(section, known));
  sections[at(found - known.begin())].second();
  spec.places[std::string(path)] = "";  // the value is stated, but no longer that of the file
}

std::string to_toml(const CaseSpec& spec) {
  const auto lines = [](const auto& parameters) { return field_lines(parameters); };
  const std::string partition = "\n[partition]\n" + std::visit(lines, spec.partition);
  std::string text = fmt::format("title = {}\n\n", field_text(spec.title));
  if (const auto* problem = std::get_if<ContactProblemFile>(&spec.packing))
    return text + fmt::format("[problem]\nfile = {}\n", field_text(problem->path)) + partition;
  text += "[packing]\n";
  if (const auto* file = std::get_if<PackingFile>(&spec.packing)) {
    text += fmt::format("file = {}\n", field_text(file->path));
    if (!file->forces.empty()) text += fmt::format("forces = {}\n", field_text(file->forces));
  } else if (const auto* settled = std::get_if<SettledFrom>(&spec.packing)) {
    text += fmt::format("settled = {}\n", field_text(settled->name));
  } else {
    const Generator& generator = std::get<Generator>(spec.packing);
    const auto name = std::visit([](const auto& parameters) { return parameters.name; }, generator);
    text += fmt::format("generator = \"{}\"\n{}", name, std::visit(lines, generator));
  }
  text += "\n[contacts]\n" + field_lines(spec.contacts);
  if (spec.masses.model) {
    text += fmt::format("\n[masses]\nmodel = \"{}\"\n", to_string(*spec.masses.model));
    if (spec.masses.model == MassModel::density) text += fmt::format("density = {}\n", spec.masses.density);
  }
  text += partition;
  if (!spec.loads.none()) text += "\n[loads]\n" + field_lines(spec.loads);
  for (const auto& [grain, velocity, spin] : spec.prescribed) {
    text += fmt::format("\n[[prescribed]]\ngrain = {}\nvelocity = {}\n", grain, field_text(velocity));
    if (spin != std::array<double, 3>{})
      text += fmt::format("spin = {}\n", velocity.size() == 2 ? field_text(spin[2]) : field_text(Components(spin)));
  }
  if (spec.dynamics) text += to_toml(*spec.dynamics);
  return text;
}

void check_dynamics(const CaseSpec& spec) {
  if (!spec.dynamics) fail("case {}: expected a section [dynamics], met none", spec.name);
  subdomains(spec.partition);
  const StepSolver& solver = spec.dynamics->solver;
  const Interaction& interaction = spec.dynamics->interaction;
  if (is_contact_solver(solver.algorithm) && !opens(contact_law(interaction, spec.dynamics->time.step, 1)))
    throw Error("solver.algorithm", fmt::format("expected {} with law {}, met {}{}", algorithms_with(StepPart::sweeps),
                                                to_string(interaction.law), to_string(solver.algorithm),
                                                solver.algorithm == StepSolver{}.algorithm ? ", the default" : ""));
  if (decomposes(solver.algorithm) && solver.coarse_space != CoarseSpace::none && subdomains(spec.partition) == 1)
    throw Error("solver.coarse_space", fmt::format("expected none with one subdomain, which has no interface, met {}",
                                                   to_string(solver.coarse_space)));
  check(solver);
}

void require_effect(const CaseSpec& spec, std::string_view key, std::string_view where) {
  const bool of_cell = key.starts_with("contacts.period_");
  if (key.starts_with("contacts.") && !of_cell)
    fail("{}: expected a parameter of the motion, met one of the linear study alone", where);
  const StepAlgorithm algorithm = spec.dynamics->solver.algorithm;
  if (key.starts_with("partition.") && !decomposes(algorithm) && subdomains(spec.partition) > 1)
    fail("{}: expected solver.algorithm {} with it, met {}, which does not decompose", where,
         algorithms_with(StepPart::subdomains), to_string(algorithm));
  if (!of_cell) require_effect(*spec.dynamics, key, where);
}

}  // namespace nscdd
