// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "formats/case/case_file.hpp"
#include <nscdd/formats/packing_file.hpp>

namespace nscdd::app {
namespace {

struct GenerateOptions {
  std::string spec, output;
  std::vector<std::string> settings;
  bool force = false;
};

// A generator at its defaults, or a case.
CaseSpec spec_of(const std::string& name) {
  using Generators = Alternatives<Generator>;
  const auto found = std::find(Generators::names.begin(), Generators::names.end(), name);
  if (found == Generators::names.end()) return spec_of_file(find_case(name));
  CaseSpec spec;
  spec.name = name;
  spec.packing = Generators::at(static_cast<std::size_t>(found - Generators::names.begin()));
  return spec;
}

int run_generate(const GenerateOptions& options, const Context& context) {
  const auto format = options.output == "-" ? PackingFormat::csv : packing_format(options.output);
  if (!format)
    fail("{}: expected a file name that ends in .csv, .h5 or .hdf5, or - for CSV on standard output", options.output);
  CaseSpec spec = spec_of(options.spec);
  for (const std::string& setting : options.settings)
    if (!setting.starts_with("packing.") && !setting.starts_with("masses."))
      fail("--set: expected packing.KEY=VALUE or masses.density=VALUE, met '{}'", setting);
  GivenParameters given;
  apply_settings(spec, options.settings, given);
  const Case one = resolve_case(spec, {options.output});
  OutputFile file(options.output, options.force);
  const Packing packing = packing_of(one, progress("generate"));
  std::string bytes;
  try {
    bytes = packing_bytes(*format, packing, provenance(context, {one}));
  } catch (const Error& error) {
    fail("{}: {}", options.spec, error.what());
  }
  file.bytes(bytes);
  file.finish();
  return 0;
}

}  // namespace

Action declare_generate(Command& command) {
  auto options = std::make_shared<GenerateOptions>();
  command.required(
      "SPEC", options->spec,
      "generator with its defaults (see nscdd list), case file (.toml), known case, or packing of another format");
  command.required("-o,--output FILE", options->output,
                   "where the packing goes: .csv, .h5 or .hdf5, or - for CSV on standard output");
  command.add("--set KEY=VALUE", options->settings,
              "a parameter of the generator, such as packing.grains=16, or masses.density");
  command.add("--force", options->force, "replace an existing output");
  command.footer =
      R"(Columns x, y, radius (m) and, where the case has masses, mass (kg); the numbers read back bit for bit. A
name that is both a generator and a case is the generator: give the path of the case file for the case.
Examples:
  nscdd generate deposit --set packing.grains=500 --set packing.seed=7 -o bed.csv
  nscdd generate hexagonal --set packing.vacancies=0.1 -o -
  nscdd generate disks12 -o disks12.h5)";
  return [options](const Context& context) { return run_generate(*options, context); };
}

}  // namespace nscdd::app
