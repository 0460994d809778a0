// SPDX-License-Identifier: GPL-3.0-or-later
#include "data_files.hpp"
#include "progress.hpp"
#include "provenance.hpp"
#include "verbs.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/io/config.hpp>
#include <nscdd/io/csv.hpp>
#include <nscdd/io/output_file.hpp>
#include <nscdd/study/study.hpp>

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <set>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string study, output = "results";
  bool force = false, check = false;
  Context context;
};

constexpr double check_tolerance = 1e-8;

std::string baseline_name(const Study& study, std::size_t table) {
  return table == 0 ? "baseline.csv" : "baseline-" + study.tables[table].name + ".csv";
}

Study read_study(const std::string& folder) {
  const std::string file = (fs::path(folder) / "study.toml").string();
  return parse_study(read_text(file), file, [&](const std::string& name) {
    const fs::path beside = fs::path(folder) / name;  // a case file of the study's own
    return read_case(fs::exists(beside) ? beside.string() : find_case(name));
  });
}

// Every case of a study once.
std::vector<Case> cases_of(const Study& study) {
  std::vector<Case> cases;
  std::set<std::string> seen;
  for (const StudyTable& table : study.tables)
    for (const Case& one : table.cases)
      if (seen.insert(one.name).second) cases.push_back(one);
  return cases;
}

Table run_one(const StudyTable& table, const fs::path& csv_path, bool force) {
  Table result{study_columns(table), {}};
  CsvWriter csv(csv_path.string(), force, result.columns);
  Progress progress(table.name);
  const Index failed = run_table(
      table,
      [&](const Row& row) {
        csv.write(row);
        result.rows.push_back(row);
      },
      progress.monitor());
  csv.finish();
  if (failed > 0)
    note(fmt::format("{}: {} row(s) did not converge: see the column 'converged'", table.name, failed));
  return result;
}

// Before hours of work rather than after them.
void require_baselines(const Study& study, const std::string& folder) {
  for (std::size_t i = 0; i < study.tables.size(); ++i) {
    const std::string baseline = (fs::path(folder) / baseline_name(study, i)).string();
    parse_csv(read_text(baseline), baseline);
  }
}

int check_baselines(const Study& study, const std::string& folder, const std::vector<NamedTable>& tables) {
  int exit_code = 0;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string baseline = (fs::path(folder) / baseline_name(study, i)).string();
    const std::string found =
        compare(tables[i].table, parse_csv(read_text(baseline), baseline), check_tolerance);
    if (found.empty()) continue;
    note(fmt::format("{}/{} differs from {}: {}", study.name, tables[i].name, baseline, found));
    exit_code = 1;
  }
  if (exit_code == 0) note(fmt::format("{}: agrees with its baseline", study.name));
  return exit_code;
}

int run(const Options& options) {
  const std::string folder = find_study(options.study);
  const Study study = read_study(folder);
  if (options.check) require_baselines(study, folder);
  const fs::path output = fs::path(options.output) / study.name;
  std::error_code status;
  fs::create_directories(output, status);
  if (status) throw Error(fmt::format("{}: cannot be made: {}", output.string(), status.message()));
  const fs::path hdf5 = output / (study.name + ".h5");
  for (const StudyTable& table : study.tables)
    require_writable(output / (table.name + ".csv"), options.force);
  OutputFile hdf5_file(hdf5.string(), options.force);

  std::vector<NamedTable> tables;
  std::string seeds;
  for (const StudyTable& table : study.tables) {
    tables.push_back({table.name, run_one(table, output / (table.name + ".csv"), options.force)});
    if (table.observable == Observable::observed_rate)
      seeds += fmt::format("{} {}\n", table.name, table.seed);
  }
  Provenance origin = provenance(options.context, cases_of(study));
  origin.emplace_back("study", read_text((fs::path(folder) / "study.toml").string()));
  origin.emplace_back("seeds", seeds);
  hdf5_file.bytes(to_hdf5(origin, tables));
  hdf5_file.finish();
  for (const NamedTable& table : tables) fmt::print("{}\n", (output / (table.name + ".csv")).string());
  fmt::print("{}\n", hdf5.string());
  return options.check ? check_baselines(study, folder, tables) : 0;
}

}  // namespace

std::function<int()> declare_run(CLI::App& command, const Context& context) {
  auto options = std::make_shared<Options>();
  options->context = context;
  command.add_option("STUDY", options->study, "study folder, or the name of a known study")->required();
  command.add_option("--output", options->output, "folder that receives STUDY/TABLE.csv and STUDY/STUDY.h5")
      ->capture_default_str();
  command.add_flag("--force", options->force, "replace existing results");
  command.add_flag("--check", options->check,
                   "compare with the study's baseline; exit code 1 where it differs");
  command.footer(
      "Prints the names of the files written.\n"
      "Examples:\n"
      "  nscdd run figure-5                              into results/figure-5\n"
      "  nscdd run studies/figure-7 --output elsewhere --check\n"
      "  nscdd run my-study --force                      a folder of your own with a study.toml");
  return [options] { return run(*options); };
}

}  // namespace nscdd::app
