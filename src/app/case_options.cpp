// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"

#include "formats/case/case_file.hpp"

namespace nscdd::app {
namespace {

PrescribedVelocity parse_prescribed(const std::string& text) {
  const std::string what = "--prescribed";
  const std::vector<std::string_view> parts = split(text, ':');
  if (parts.size() != 3 && parts.size() != 4)
    fail("{}: expected GRAIN:VX:VY such as 3:-1:0, or GRAIN:VX:VY:VZ in space, met '{}'", what, text);
  const auto component = [&](std::size_t k) { return parse_number(parts[k], what); };
  PrescribedVelocity velocity{parse_integer(parts[0], what), {component(1), component(2)}};
  if (parts.size() == 4) velocity.velocity = {component(1), component(2), component(3)};
  check_bounds(velocity.velocity, Field{}, what);
  return velocity;
}

}  // namespace

void add_given(GivenParameters& given, const std::string& key, const std::string& option) {
  const auto before = std::ranges::find(given, key, &GivenParameter::key);
  if (before != given.end()) fail("{}: expected {} once, met {} too", option, key, before->option);
  given.push_back({key, option});
}

void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings, GivenParameters& given) {
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos) fail("--set: expected KEY=VALUE such as packing.grains=16, met '{}'", setting);
    const std::string key = setting.substr(0, equals);
    add_given(given, key, "--set " + key);
    override_case(spec, key, setting.substr(equals + 1));
  }
}

void CaseOptions::declare(Command& command) {
  command.required("CASE", name,
                   "case or packing file, contact problem, or a known case; case files end in .toml, packing files in "
                   ".csv or .h5 with x,y,radius[,mass], or in .txt with lines x y radius, or are a folder DATBOX of "
                   "LMGC90, contact problems of FCLIB in .hdf5, of Siconos in .dat, of LMGC90 in Vloc_Rloc.INI or "
                   "lmgc90.h5:ID_3");
  declare_options(command);
}

void CaseOptions::declare_options(Command& command) {
  command.add("--subdomains PARTITION", subdomains, "partition: NXxNY[xNZ] for a regular grid, metis:N for METIS");
  command.add("--prescribed GRAIN:VX:VY", prescribed,
              "arriving velocity of a grain, m/s (grains from 0, -1 the last); in space GRAIN:VX:VY:VZ");
  command.add("--density", density, "masses = density x area, kg/m^2, or in space x volume, kg/m^3");
  command.add("--tolerance", tolerance, "contact where gap <= tolerance x smaller radius (1e-7)");
  command.add("--overlap-tolerance", overlap_tolerance, "overlap accepted, times smaller radius (1e-7)");
  command.add("--set KEY=VALUE", settings, "a parameter of the case, such as packing.grains=16");
}

void set_partition(CaseSpec& spec, const std::string& subdomains, GivenParameters& given) {
  if (subdomains.empty()) return;
  spec.partition = parse_partitioner(subdomains, "--subdomains");
  std::erase_if(spec.places, [](const auto& one) { return one.first.starts_with("partition"); });
  const auto name = [](const auto& partitioner) { return partitioner.name; };
  add_given(given, fmt::format("partition.{}", std::visit(name, spec.partition)), "--subdomains");
}

Case CaseOptions::resolve(const std::vector<std::string>& outputs) const {
  CaseSpec spec = spec_of_file(find_case(name));
  GivenParameters given;
  set_partition(spec, subdomains, given);
  if (!prescribed.empty()) {
    spec.prescribed.clear();
    std::erase_if(spec.places, [](const auto& one) { return one.first.starts_with("prescribed"); });
  }
  for (const std::string& text : prescribed) {
    const PrescribedVelocity velocity = parse_prescribed(text);
    if (std::ranges::count(spec.prescribed, velocity.grain, &PrescribedVelocity::grain) > 0)
      fail("--prescribed: expected each grain once, met grain {} again", velocity.grain);
    spec.prescribed.push_back(velocity);
  }
  for (const auto& [value, key, option] : {std::tuple(density, "masses.density", "--density"),
                                           {tolerance, "contacts.tolerance", "--tolerance"},
                                           {overlap_tolerance, "contacts.overlap_tolerance", "--overlap-tolerance"}}) {
    if (!value) continue;
    add_given(given, key, option);
    override_case(spec, key, field_text(*value));
  }
  apply_settings(spec, settings, given);
  return resolve_case(spec, outputs);
}

Provenance provenance(const Context& context, const std::vector<Case>& cases) {
  std::string resolved;
  for (const Case& one : cases) {
    resolved += fmt::format("# case {}\n{}\n", one.spec.name, to_toml(one.spec));
    if (!one.settled_from.empty()) resolved += one.settled_from + "\n";
  }
  return {{"program", "nscdd " + version()},
          {"libraries", libraries()},
          {"command_line", context.command_line},
          {"cases", resolved}};
}

}  // namespace nscdd::app
