// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/case_options.hpp"
#include "app/shared_work.hpp"
#include "files/hdf5.hpp"
#include "formats/case/case_file.hpp"

namespace nscdd::app {
namespace {

struct RunOptions {
  std::string study, output = "results";
  Reopening how;
  bool check = false, large = false;
  Limits limits;
};

// A study with its own folder and that of its results.
struct Work {
  Study study;
  fs::path source, output;

  std::string study_file() const { return (source / "study.toml").string(); }
  std::string hdf5() const { return (output / (study.name + ".h5")).string(); }
  std::string csv(const StudyTable& table) const { return (output / (table.name + ".csv")).string(); }
  std::string baseline(const StudyTable& table) const {
    const bool first = &table == &study.tables.front();
    return (source / (first ? "baseline.csv" : "baseline-" + table.name + ".csv")).string();
  }
};

Work read_work(const RunOptions& options) {
  Work work;
  work.source = find_study(options.study);
  work.study = parse_study(read_text(work.study_file()), work.study_file(), [&](const std::string& name) {
    const fs::path beside = work.source / name;  // a case file of the study's own
    return read_case(fs::exists(beside) ? beside.string() : find_case(name));
  });
  work.output = fs::path(options.output) / work.study.name;
  return work;
}

// Resolves the cases of all tables; returns each case once.
std::vector<Case> resolve_cases(Study& study) {
  std::vector<Case> all;
  for (StudyTable& table : study.tables)
    for (Case& one : table.cases) {
      auto found = std::ranges::find(all, one.spec.source, [](const Case& known) { return known.spec.source; });
      if (found == all.end()) found = all.insert(found, resolve_case(one.spec));
      one = *found;
    }
  return all;
}

// Runs a table; `result` takes its rows, old and new. Returns false if interrupted.
bool run_one(const StudyTable& table, ResumableTable& csv, Interruption& interruption, LeadIn& lead_in, Table& result) {
  const auto collect = [&](const Row& row) { result.rows.push_back(row); };
  csv.replay(collect);
  const auto write = [&](const Row& row) {
    csv.write(row);
    collect(row);
  };
  const Index failed =
      csv.finished() ? 0 : run_table(table, write, interruption.watch(table.name, csv.kept()), csv.kept(), &lead_in);
  if (interruption.stopped()) return false;
  csv.finish();
  if (failed > 0) note("{}: {} row(s) did not converge: see the column 'converged'", table.name, failed);
  return true;
}

// Removes the tables that only --large runs; the first table is never one.
void leave_out_large(Study& study) {
  std::vector<std::string> names;
  for (const StudyTable& table : study.tables)
    if (table.large) names.push_back(table.name);
  std::erase_if(study.tables, [](const StudyTable& table) { return table.large; });
  if (!names.empty()) note("{}: without {}, which --large adds", study.name, fmt::join(names, ", "));
}

// The baseline of a table; optional for large ones.
std::optional<CsvText> baseline_of(const Work& work, const StudyTable& table) {
  const std::string path = work.baseline(table);
  if (!table.baseline || (table.large && !fs::exists(path))) return std::nullopt;
  return parse_csv(read_text(path), path);
}

// Compares the tables on disk with their baselines.
int check_baselines(const Work& work) {
  int exit_code = 0, compared = 0;
  for (const StudyTable& table : work.study.tables) {
    const std::optional<CsvText> baseline = baseline_of(work, table);
    if (!baseline) continue;
    ++compared;
    const std::string path = work.csv(table);
    const std::string found = compare(untyped_table(parse_csv(read_text(path), path)), *baseline, table.check_tolerance,
                                      table.column_tolerance, table.check_relative);
    if (found.empty()) continue;
    note("{}/{} differs from {}: {}", work.study.name, table.name, work.baseline(table), found);
    exit_code = 1;
  }
  if (compared == 0)
    note("{}: has no baseline to be compared with", work.study.name);
  else if (exit_code == 0)
    note("{}: agrees with its baseline", work.study.name);
  return exit_code;
}

// Throws Error if a result would replace an input.
void check_outputs(const Work& work) {
  std::vector<fs::path> inputs{work.study_file()};
  std::vector<std::string> names{work.hdf5()};
  for (const StudyTable& table : work.study.tables) {
    names.push_back(work.csv(table));
    inputs.push_back(work.baseline(table));
    for (const Case& one : table.cases)
      for (const fs::path& input : files_behind(one.spec)) inputs.push_back(input);
  }
  require_no_input(names, inputs);
}

int compute(const Work& work, const std::vector<Case>& cases, const RunOptions& options, const Context& context) {
  // Throws Error before hours of work, not after them.
  for (const StudyTable& table : work.study.tables) kept_rows(work.csv(table), table_work(table), options.how);
  Interruption interruption;
  OutputFile hdf5(work.hdf5(), options.how.force, kept_of_whole(options.how));
  std::vector<NamedTable> tables;
  std::string seeds;
  LeadIn lead_in;
  for (const StudyTable& table : work.study.tables) {
    ResumableTable csv(work.csv(table), table_work(table), options.how);
    tables.push_back({table.name, {study_columns(table), {}}});
    if (!run_one(table, csv, interruption, lead_in, tables.back().table)) return leave(csv, work.csv(table));
    if (table.observable->uses("seed")) seeds += fmt::format("{} {}\n", table.name, table.seed);
  }
  Provenance origin = provenance(context, cases);
  origin.emplace_back("study", read_text(work.study_file()));
  origin.emplace_back("seeds", seeds);
  hdf5.bytes(to_hdf5(origin, tables));
  hdf5.finish();
  for (const StudyTable& table : work.study.tables) {
    remove_record(work.csv(table));
    fmt::print("{}\n", work.csv(table));
  }
  fmt::print("{}\n", work.hdf5());
  return options.check ? check_baselines(work) : 0;
}

int run_study(const RunOptions& options, const Context& context) {
  const ThreadLimit limit = options.limits.apply(context.machine);
  Work work = read_work(options);
  check_outputs(work);
  if (!options.large) leave_out_large(work.study);
  if (options.check)  // throws Error for a missing baseline before hours of work
    for (const StudyTable& table : work.study.tables) baseline_of(work, table);
  const std::vector<Case> cases = resolve_cases(work.study);
  make_folder(work.output.string(), true);
  const auto complete = [&](const StudyTable& table) { return is_complete(work.csv(table)); };
  if (!options.how.resume || options.how.force || !is_complete(work.hdf5()) ||
      !std::ranges::all_of(work.study.tables, complete))
    return compute(work, cases, options, context);
  for (const StudyTable& table : work.study.tables) require_rows_of(table_work(table), work.csv(table));
  note("{}: already complete, nothing to resume", work.output.string());
  return options.check ? check_baselines(work) : 0;
}

}  // namespace

Action declare_run(Command& command) {
  auto options = std::make_shared<RunOptions>();
  command.required("STUDY", options->study, "study folder, or the name of a known study");
  command.preset("--output FOLDER", options->output, "folder that receives STUDY/TABLE.csv and STUDY/STUDY.h5");
  command.add("--large", options->large, "also the tables that the study marks as large");
  declare_reopening(command, options->how);
  options->limits.declare(command);
  command.add("--check", options->check, "compare with the study's baseline; exit code 1 where it differs");
  command.footer = R"(Prints the names of the files written.
Examples:
  nscdd run figure-5                              into results/figure-5
  nscdd run studies/figure-7 --output elsewhere --check
  nscdd run my-study --force                      a folder of your own with a study.toml)";
  return [options](const Context& context) { return run_study(*options, context); };
}

}  // namespace nscdd::app
