// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"

#include "app/data_files.hpp"
#include "app/settled_cases.hpp"
#include "files/csv.hpp"
#include "formats/case_file.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>
#include <nscdd/formats/fclib.hpp>
#include <nscdd/formats/packing_file.hpp>

#include <fmt/format.h>

#include <filesystem>

namespace nscdd::app {
namespace {

PrescribedVelocity parse_prescribed(const std::string& text) {
  const std::string what = "--prescribed";
  const auto first = text.find(':');
  const auto second = first == std::string::npos ? first : text.find(':', first + 1);
  if (second == std::string::npos || text.find(':', second + 1) != std::string::npos)
    throw Error(fmt::format("{}: expected GRAIN:VX:VY such as 3:-1:0, met '{}'", what, text));
  PrescribedVelocity velocity;
  velocity.grain = parse_integer(text.substr(0, first), what);
  velocity.velocity = {parse_number(text.substr(first + 1, second - first - 1), what),
                       parse_number(text.substr(second + 1), what)};
  check_bounds(velocity.velocity, Field{.description = ""}, what);
  return velocity;
}

}  // namespace

CaseSpec find_spec(const std::string& name) {
  const std::string path = find_case(name);
  if (std::filesystem::path(path).extension() == ".toml") return read_case(path);
  const auto format = packing_format(path);
  if (!format)
    throw Error(fmt::format("{}: expected a case file (.toml) or a packing file (.csv, .h5 or .hdf5)", path));
  CaseSpec spec;
  spec.name = std::filesystem::path(path).stem().string();
  if (*format == PackingFormat::hdf5 && holds_fclib(read_text(path), path))
    spec.packing = ContactProblemFile{path};
  else
    spec.packing = PackingFile{path};
  return spec;
}

Case resolve_case(const CaseSpec& spec, const std::vector<std::string>& outputs) {
  require_no_input(outputs, files_behind(spec));
  return resolve_settled(spec);
}

void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos)
      throw Error(fmt::format("--set: expected KEY=VALUE such as packing.grains=16, met '{}'", setting));
    override_case(spec, setting.substr(0, equals), setting.substr(equals + 1));
  }
}

void CaseOptions::declare(Command& command) {
  command
      .add_option("CASE", name,
                  "case or packing file, contact problem (FCLIB), or a known case; case files end in .toml, "
                  "packing files in .csv or .h5 with x,y,radius[,mass], contact problems of FCLIB in .hdf5")
      ->required();
  command.add_option("--subdomains", subdomains, "partition: NXxNY for a regular grid, metis:N for METIS");
  command.add_option("--prescribed", prescribed, "arriving velocity GRAIN:VX:VY, m/s (grains from 0, -1 the last)");
  command.add_option("--density", density, "masses = density x pi radius^2, kg/m^2");
  command.add_option("--tolerance", tolerance, "contact where gap <= tolerance x smaller radius (1e-7)");
  command.add_option("--overlap-tolerance", overlap_tolerance, "overlap accepted, times smaller radius (1e-7)");
  command.add_option("--set", settings, "KEY=VALUE: a parameter of the case, such as packing.grains=16");
}

Case CaseOptions::resolve(const std::vector<std::string>& outputs) const {
  CaseSpec spec = find_spec(name);
  apply(spec);
  return resolve_case(spec, outputs);
}

void CaseOptions::apply(CaseSpec& spec) const {
  if (!subdomains.empty()) spec.partition = parse_partitioner(subdomains, "--subdomains");
  if (!prescribed.empty()) {
    spec.prescribed.clear();
    std::erase_if(spec.lines, [](const auto& line) { return line.first.starts_with("prescribed"); });
  }
  for (const std::string& text : prescribed) {
    const PrescribedVelocity velocity = parse_prescribed(text);
    for (const PrescribedVelocity& other : spec.prescribed)
      if (other.grain == velocity.grain)
        throw Error(fmt::format("--prescribed: expected each grain once, met grain {} again", velocity.grain));
    spec.prescribed.push_back(velocity);
  }
  if (density) override_case(spec, "masses.density", field_text(*density));
  if (tolerance) override_case(spec, "contacts.tolerance", field_text(*tolerance));
  if (overlap_tolerance) override_case(spec, "contacts.overlap_tolerance", field_text(*overlap_tolerance));
  apply_settings(spec, settings);
}

}  // namespace nscdd::app
