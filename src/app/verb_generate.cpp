// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/progress.hpp"
#include "app/provenance.hpp"
#include "app/verbs.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/formats/packing_file.hpp>

#include <fmt/format.h>

#include <memory>
#include <optional>

namespace nscdd::app {
namespace {

struct Options {
  std::string spec, output;
  std::vector<std::string> settings;
  bool force = false;
};

// A case with the generator of that name, at its defaults.
template <std::size_t I = 0>
std::optional<Case> bare_generator(const std::string& name) {
  if constexpr (I == std::variant_size_v<Generator>) {
    return std::nullopt;
  } else {
    using Alternative = std::variant_alternative_t<I, Generator>;
    if (name != Alternative::name) return bare_generator<I + 1>(name);
    Case one;
    one.name = name;
    one.packing = Generator{Alternative{}};
    return one;
  }
}

void apply(const Options& options, Case& one) {
  for (const std::string& setting : options.settings)
    if (setting.rfind("packing.", 0) != 0 && setting.rfind("masses.", 0) != 0)
      throw Error(
          fmt::format("--set: expected packing.KEY=VALUE or masses.density=VALUE, met '{}'", setting));
  apply_settings(one, options.settings);
}

Case resolve(const Options& options) {
  std::optional<Case> generator = bare_generator(options.spec);
  if (!generator)
    return read_any_case(options.spec, {options.output}, [&](Case& one) { apply(options, one); });
  apply(options, *generator);
  return *std::move(generator);
}

PackingFormat output_format(const std::string& output) {
  if (output == "-") return PackingFormat::csv;
  const auto format = packing_format(output);
  if (!format)
    throw Error(fmt::format(
        "{}: expected a file name that ends in .csv, .h5 or .hdf5, or - for CSV on standard output", output));
  return *format;
}

int run(const Options& options, const Context& context) {
  const PackingFormat format = output_format(options.output);
  const Case one = resolve(options);
  OutputFile file(options.output, options.force);
  Packing packing;
  {
    Progress progress("generate");
    packing = packing_of(one, progress.monitor());
  }
  write_packing(file, format, packing, provenance(context, {one}));
  file.finish();
  return 0;
}

}  // namespace

std::function<int()> declare_generate(Command& command, const Context& context) {
  auto options = std::make_shared<Options>();
  command
      .add_option("SPEC", options->spec,
                  "generator with its defaults (see nscdd list), case file (.toml), or a known case")
      ->required();
  command
      .add_option("-o,--output", options->output,
                  "where the packing goes: .csv, .h5 or .hdf5; - for CSV on standard output")
      ->required();
  command.add_option("--set", options->settings,
                     "KEY=VALUE: a parameter of the generator, such as packing.grains=16, or masses.density");
  command.add_flag("--force", options->force, "replace an existing output");
  command.footer(
      "Columns x, y, radius (m) and, where the case has masses, mass (kg); the numbers read back bit for "
      "bit. A\n"
      "name that is both a generator and a case is the generator: give the path of the case file for the "
      "case.\n"
      "Examples:\n"
      "  nscdd generate deposit --set packing.grains=500 --set packing.seed=7 -o bed.csv\n"
      "  nscdd generate hexagonal --set packing.vacancies=0.1 -o -\n"
      "  nscdd generate disks12 -o disks12.h5");
  return [options, context] { return run(*options, context); };
}

}  // namespace nscdd::app
