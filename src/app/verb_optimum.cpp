// SPDX-License-Identifier: GPL-3.0-or-later
#include "case_options.hpp"
#include "progress.hpp"
#include "sweep_options.hpp"
#include "verbs.hpp"
#include <nscdd/io/csv.hpp>
#include <nscdd/study/optimum.hpp>
#include <nscdd/study/values.hpp>

#include <fmt/format.h>

#include <memory>

namespace nscdd::app {
namespace {

struct Options {
  CaseOptions one;
  SpectralCommandOptions spectral;
  std::string epsilon = "0", csv;
  bool force = false;
};

// The row as text for a reader: one quantity per line.
void print_report(const std::vector<Column>& columns, const Row& row) {
  for (std::size_t j = 0; j < columns.size(); ++j) {
    const std::string unit = columns[j].unit == "1" ? "" : columns[j].unit;
    fmt::print("{:<26}{:<30}{}\n", columns[j].name, to_text(row[j]) + (unit.empty() ? "" : " " + unit),
               columns[j].description);
  }
}

int run(const Options& options) {
  const std::vector<double> epsilon = parse_epsilon(options.epsilon);
  const OptimumParameters base{0, options.spectral.contact_set(), options.spectral.spectral()};
  const Model model = build(options.one.resolve());
  const std::vector<Column> columns = optimum_columns();
  std::unique_ptr<CsvWriter> csv;
  if (!options.csv.empty()) csv = std::make_unique<CsvWriter>(options.csv, options.force, columns);
  bool first = true;
  for (const double value : epsilon) {
    OptimumParameters parameters = base;
    parameters.epsilon = value;
    const Row row = optimum_row(model, parameters, optimum(model, parameters));
    if (csv) {
      csv->write(row);
    } else {
      if (!first) fmt::print("\n");
      print_report(columns, row);
    }
    first = false;
  }
  if (csv) csv->finish();
  return 0;
}

}  // namespace

std::function<int()> declare_optimum(CLI::App& command, const Context&) {
  auto options = std::make_shared<Options>();
  options->one.declare(command);
  command
      .add_option("--epsilon", options->epsilon,
                  "SPEC of the flexibility of the law, 1/kg; 0 is the rigid limit")
      ->capture_default_str();
  options->spectral.declare(command, "active");
  command.add_option("--csv", options->csv, "write a table instead of the report, - for standard output");
  command.add_flag("--force", options->force, "replace existing outputs");
  command.footer(
      "The eta of the smallest radius of the enriched algorithm, from which eta on it converges, from which "
      "on it\n"
      "beats the generic algorithm, and the same with the best relaxation.\n"
      "Examples:\n"
      "  nscdd optimum disks8                        the nonsmooth case, active contacts\n"
      "  nscdd optimum disks8 --epsilon 0,1 --contacts all --csv -");
  return [options] { return run(*options); };
}

}  // namespace nscdd::app
