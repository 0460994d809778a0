// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"

#include "app/data_files.hpp"
#include "app/settled_cases.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>
#include <nscdd/files/csv.hpp>
#include <nscdd/formats/case_file.hpp>
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

// A packing file, or a contact problem, in place of a case.
Case packing_case(const std::string& path) {
  if (!packing_format(path))
    throw Error(fmt::format("{}: expected a case file (.toml) or a packing file (.csv, .h5 or .hdf5)", path));
  Case one;
  one.name = std::filesystem::path(path).stem().string();
  if (packing_format(path) == PackingFormat::hdf5 && holds_fclib(read_text(path), path))
    one.packing = ContactProblemFile{path, read_global_problem(path)};
  else
    one.packing = PackingFile{path, read_packing(path)};
  return one;
}

}  // namespace

Case read_any_case(const std::string& name, const std::vector<std::string>& outputs,
                   const std::function<void(Case&)>& change) {
  const std::string path = find_case(name);
  Case one;
  if (std::filesystem::path(path).extension() == ".toml") {
    one = read_unsettled_case_file(path);
    change(one);
    require_no_input(outputs, files_behind(one, path));
    if (!std::holds_alternative<SettledPacking>(one.packing)) return one;
    one = read_case_file(path);
  } else {
    one = packing_case(path);
    require_no_input(outputs, files_behind(one, path));
  }
  change(one);
  return one;
}

void apply_settings(Case& one, const std::vector<std::string>& settings) {
  for (const std::string& setting : settings) {
    const auto equals = setting.find('=');
    if (equals == std::string::npos)
      throw Error(fmt::format("--set: expected KEY=VALUE such as packing.grains=16, met '{}'", setting));
    override_case(one, setting.substr(0, equals), setting.substr(equals + 1));
  }
}

void CaseOptions::declare(Command& command) {
  command
      .add_option("CASE", name,
                  "case or packing file, contact problem (FCLIB), or a known case; case files end in .toml, "
                  "packing files in .csv or .h5 with x,y,radius[,mass], contact problems of FCLIB in .hdf5")
      ->required();
  command.add_option("--subdomains", subdomains, "partition: NXxNY for a regular grid, metis:N for METIS");
  command.add_option("--prescribed", prescribed,
                     "arriving velocity GRAIN:VX:VY, m/s (grains from 0, -1 the last)");
  command.add_option("--density", density, "masses = density x pi radius^2, kg/m^2");
  command.add_option("--tolerance", tolerance, "contact where gap <= tolerance x smaller radius (1e-7)");
  command.add_option("--overlap-tolerance", overlap_tolerance,
                     "overlap accepted, times smaller radius (1e-7)");
  command.add_option("--set", settings, "KEY=VALUE: a parameter of the case, such as packing.grains=16");
}

Case CaseOptions::resolve(const std::vector<std::string>& outputs) const {
  return read_any_case(name, outputs, [this](Case& one) { apply(one); });
}

void CaseOptions::apply(Case& one) const {
  if (!subdomains.empty()) one.partition = parse_partitioner(subdomains, "--subdomains");
  if (!prescribed.empty()) one.prescribed.clear();
  for (const std::string& text : prescribed) {
    const PrescribedVelocity velocity = parse_prescribed(text);
    for (const PrescribedVelocity& other : one.prescribed)
      if (other.grain == velocity.grain)
        throw Error(
            fmt::format("--prescribed: expected each grain once, met grain {} again", velocity.grain));
    one.prescribed.push_back(velocity);
  }
  if (density) override_case(one, "masses.density", field_text(*density));
  if (tolerance) override_case(one, "contacts.tolerance", field_text(*tolerance));
  if (overlap_tolerance) override_case(one, "contacts.overlap_tolerance", field_text(*overlap_tolerance));
  apply_settings(one, settings);
}

}  // namespace nscdd::app
