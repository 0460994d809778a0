// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cases.hpp"
#include "app/progress.hpp"
#include "files/csv.hpp"
#include "formats/case_file.hpp"
#include <nscdd/core/fields.hpp>
#include <nscdd/core/version.hpp>
#include <nscdd/formats/fclib.hpp>
#include <nscdd/formats/packing_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace nscdd::app {
namespace {

PrescribedVelocity parse_prescribed(const std::string& text) {
  const std::string what = "--prescribed";
  const auto first = text.find(':'), last = text.rfind(':');
  if (std::ranges::count(text, ':') != 2) refuse("{}: expected GRAIN:VX:VY such as 3:-1:0, met '{}'", what, text);
  PrescribedVelocity velocity;
  velocity.grain = parse_integer(text.substr(0, first), what);
  velocity.velocity = {parse_number(text.substr(first + 1, last - first - 1), what),
                       parse_number(text.substr(last + 1), what)};
  check_bounds(velocity.velocity, Field{.description = ""}, what);
  return velocity;
}

}  // namespace

CaseSpec find_spec(const std::string& name) {
  const std::string path = find_case(name);
  if (std::filesystem::path(path).extension() == ".toml") return read_case(path);
  const auto format = packing_format(path);
  if (!format) refuse("{}: expected a case file (.toml) or a packing file (.csv, .h5 or .hdf5)", path);
  CaseSpec spec;
  spec.name = std::filesystem::path(path).stem().string();
  if (*format == PackingFormat::hdf5 && holds_fclib(read_text(path), path))
    spec.packing = ContactProblemFile{path};
  else
    spec.packing = PackingFile{path};
  return spec;
}

void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos) refuse("--set: expected KEY=VALUE such as packing.grains=16, met '{}'", setting);
    override_case(spec, setting.substr(0, equals), setting.substr(equals + 1));
  }
}

void CaseOptions::declare(Command& command) {
  command.add_required("CASE", name,
                       "case or packing file, contact problem (FCLIB), or a known case; case files end in .toml, "
                       "packing files in .csv or .h5 with x,y,radius[,mass], contact problems of FCLIB in .hdf5");
  command.add("--subdomains", subdomains, "partition: NXxNY for a regular grid, metis:N for METIS");
  command.add("--prescribed", prescribed, "arriving velocity GRAIN:VX:VY, m/s (grains from 0, -1 the last)");
  command.add("--density", density, "masses = density x pi radius^2, kg/m^2");
  command.add("--tolerance", tolerance, "contact where gap <= tolerance x smaller radius (1e-7)");
  command.add("--overlap-tolerance", overlap_tolerance, "overlap accepted, times smaller radius (1e-7)");
  command.add("--set", settings, "KEY=VALUE: a parameter of the case, such as packing.grains=16");
}

Case CaseOptions::resolve(const std::vector<std::string>& outputs) const {
  CaseSpec spec = find_spec(name);
  if (!subdomains.empty()) spec.partition = parse_partitioner(subdomains, "--subdomains");
  if (!prescribed.empty()) {
    spec.prescribed.clear();
    std::erase_if(spec.lines, [](const auto& line) { return line.first.starts_with("prescribed"); });
  }
  for (const std::string& text : prescribed) {
    const PrescribedVelocity velocity = parse_prescribed(text);
    for (const PrescribedVelocity& other : spec.prescribed)
      if (other.grain == velocity.grain)
        refuse("--prescribed: expected each grain once, met grain {} again", velocity.grain);
    spec.prescribed.push_back(velocity);
  }
  if (density) override_case(spec, "masses.density", field_text(*density));
  if (tolerance) override_case(spec, "contacts.tolerance", field_text(*tolerance));
  if (overlap_tolerance) override_case(spec, "contacts.overlap_tolerance", field_text(*overlap_tolerance));
  apply_settings(spec, settings);
  return resolve_case(spec, outputs);
}

Provenance provenance(const Context& context, const std::vector<Case>& cases) {
  std::string libraries, resolved;
  for (const auto& [name, version] : dependency_versions()) libraries += fmt::format("{} {}\n", name, version);
  for (const Case& one : cases) {
    resolved += fmt::format("# case {}\n{}\n", one.spec.name, to_toml(one.spec));
    if (!one.settled_from.empty()) resolved += one.settled_from + "\n";
  }
  return {{"program", "nscdd " + version()},
          {"libraries", libraries},
          {"command_line", context.command_line},
          {"cases", resolved}};
}

}  // namespace nscdd::app
