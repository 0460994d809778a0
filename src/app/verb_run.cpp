// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/data_files.hpp"
#include "app/interruption.hpp"
#include "app/memory_limit.hpp"
#include "app/progress.hpp"
#include "app/provenance.hpp"
#include "app/repair_table.hpp"
#include "app/resume.hpp"
#include "app/settled_cases.hpp"
#include "app/sweep_options.hpp"
#include "app/verbs.hpp"
#include "files/csv.hpp"
#include "files/output_file.hpp"
#include "formats/case_file.hpp"
#include "linalg/threads.hpp"
#include "study/study.hpp"
#include "study/work_identity.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string study, output = "results";
  bool force = false, check = false, resume = false, redo = false, large = false;
  Index threads = 0;
  MemoryLimit memory;
  Context context;
};

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

// Each case once, however many tables it is in.
void resolve_cases(Study& study) {
  std::map<std::string, Case> known;
  for (StudyTable& table : study.tables)
    for (Case& one : table.cases) {
      const auto found = known.find(one.spec.source);
      one = found != known.end() ? found->second
                                 : known.emplace(one.spec.source, resolve_settled(one.spec)).first->second;
    }
}

// Every case of a study once.
std::vector<Case> cases_of(const Study& study) {
  std::vector<Case> cases;
  std::set<std::string> seen;
  for (const StudyTable& table : study.tables)
    for (const Case& one : table.cases)
      if (seen.insert(one.spec.name).second) cases.push_back(one);
  return cases;
}

// Runs one table of the study; `result` also takes the rows found. Returns false if it was interrupted.
bool run_one(const StudyTable& work, ResumableTable& csv, Interruption& interruption, LeadIn& lead_in, Table& result) {
  const auto collect = [&](const Row& row) { result.rows.push_back(row); };
  csv.replay(collect);
  Index failed = 0;
  if (!csv.finished()) {
    Progress progress(work.name, csv.kept());
    failed = run_table(
        work,
        [&](const Row& row) {
          csv.write(row);
          collect(row);
        },
        interruption.watch(progress.monitor()), csv.kept(), &lead_in);
  }
  if (interruption.stopped()) return false;
  csv.finish();
  if (failed > 0) note(fmt::format("{}: {} row(s) did not converge: see the column 'converged'", work.name, failed));
  return true;
}

// Leaves out the tables that are run on demand only, which never come first.
void leave_out_large(Study& study) {
  std::string names;
  for (const StudyTable& table : study.tables)
    if (table.large) names += (names.empty() ? "" : ", ") + table.name;
  if (names.empty()) return;
  study.tables.erase(
      std::remove_if(study.tables.begin(), study.tables.end(), [](const StudyTable& table) { return table.large; }),
      study.tables.end());
  note(fmt::format("{}: without {}, which --large adds", study.name, names));
}

// Large tables may do without one.
bool has_baseline(const StudyTable& table, const std::string& baseline) {
  return table.baseline && (!table.large || fs::exists(baseline));
}

// Baselines are read before hours of work rather than after them.
void require_baselines(const Study& study, const std::string& folder) {
  for (std::size_t i = 0; i < study.tables.size(); ++i) {
    const std::string baseline = (fs::path(folder) / baseline_name(study, i)).string();
    if (!has_baseline(study.tables[i], baseline)) continue;
    parse_csv(read_text(baseline), baseline);
  }
}

int check_baselines(const Study& study, const std::string& folder, const std::vector<NamedTable>& tables) {
  int exit_code = 0, compared = 0;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string baseline = (fs::path(folder) / baseline_name(study, i)).string();
    const StudyTable& work = study.tables[i];
    if (!has_baseline(work, baseline)) continue;
    ++compared;
    const std::string found = compare(tables[i].table, parse_csv(read_text(baseline), baseline), work.check_tolerance,
                                      work.column_tolerance, work.check_relative);
    if (found.empty()) continue;
    note(fmt::format("{}/{} differs from {}: {}", study.name, tables[i].name, baseline, found));
    exit_code = 1;
  }
  if (compared == 0)
    note(fmt::format("{}: has no baseline to be compared with", study.name));
  else if (exit_code == 0)
    note(fmt::format("{}: agrees with its baseline", study.name));
  return exit_code;
}

struct Outputs {
  fs::path folder, hdf5;
  std::string table(const StudyTable& work) const { return (folder / (work.name + ".csv")).string(); }
};

// Whether every table of the study is there, and no record of a run that was interrupted.
bool is_complete(const Study& study, const Outputs& outputs) {
  bool all = nscdd::is_complete(outputs.hdf5.string());
  for (const StudyTable& work : study.tables) all = all && nscdd::is_complete(outputs.table(work));
  return all;
}

Outputs outputs_of(const Study& study, const Options& options) {
  const fs::path folder = fs::path(options.output) / study.name;
  return {folder, folder / (study.name + ".h5")};
}

Outputs prepare(const Study& study, const Options& options) {
  Outputs outputs = outputs_of(study, options);
  std::error_code status;
  fs::create_directories(outputs.folder, status);
  if (status) throw Error(fmt::format("{}: cannot be made: {}", outputs.folder.string(), status.message()));
  return outputs;
}

// Results must not take the place of what they come from.
void check_outputs(const Study& study, const std::string& folder, const Options& options) {
  const Outputs outputs = outputs_of(study, options);
  std::vector<fs::path> inputs{fs::path(folder) / "study.toml"};
  std::vector<std::string> names{outputs.hdf5.string()};
  for (std::size_t i = 0; i < study.tables.size(); ++i) {
    names.push_back(outputs.table(study.tables[i]));
    inputs.push_back(fs::path(folder) / baseline_name(study, i));
    for (const Case& one : study.tables[i].cases)
      for (const fs::path& input : files_behind(one.spec)) inputs.push_back(input);
  }
  require_no_input(names, inputs);
}

// The tables as they are on disk, for a comparison with baselines.
std::vector<NamedTable> tables_on_disk(const Study& study, const Outputs& outputs) {
  std::vector<NamedTable> tables;
  for (const StudyTable& work : study.tables) {
    const std::string path = outputs.table(work);
    tables.push_back({work.name, untyped_table(parse_csv(read_text(path), path))});
  }
  return tables;
}

// Where a study that is complete is to be resumed.
int nothing_to_do(const Study& study, const Outputs& outputs, const std::string& folder, bool check) {
  note(fmt::format("{}: already complete, nothing to resume", outputs.folder.string()));
  if (!check) return 0;
  return check_baselines(study, folder, tables_on_disk(study, outputs));
}

int redo(const Study& study, const Outputs& outputs, const std::string& folder, const Options& options) {
  const auto require_complete = [](const std::string& path) {
    if (!fs::exists(path) || fs::exists(record_path(path)))
      throw Error(fmt::format("--redo: {}: expected a complete result, met none; --resume completes it", path));
  };
  require_complete(outputs.hdf5.string());
  for (const StudyTable& work : study.tables) {
    require_complete(outputs.table(work));
    options.memory.require(largest_need(work, 0));
  }
  Interruption interruption;
  LeadIn lead_in;
  Repaired repaired;
  for (const StudyTable& work : study.tables)
    repaired += repair_table(work, outputs.table(work), interruption, lead_in);
  update_tables(outputs.hdf5.string(), options.context.command_line);
  if (const int exit_code = explain(repaired, outputs.folder.string()); exit_code != 0) return exit_code;
  return options.check ? check_baselines(study, folder, tables_on_disk(study, outputs)) : 0;
}

int run(const Options& options) {
  const ThreadLimit limit(options.threads);
  const Reopening how{options.resume, options.force};
  const std::string folder = find_study(options.study);
  if (options.redo && (options.resume || options.force))
    throw Error("--redo: expected finished results, to be repaired, without --resume and --force");
  Study study = read_study(folder);
  check_outputs(study, folder, options);
  if (!options.large) leave_out_large(study);
  if (options.check) require_baselines(study, folder);
  resolve_cases(study);
  if (options.redo) return redo(study, outputs_of(study, options), folder, options);
  const Outputs outputs = prepare(study, options);
  if (how.resume && !how.force && is_complete(study, outputs))
    return nothing_to_do(study, outputs, folder, options.check);
  // Refused before hours of work rather than after them.
  for (const StudyTable& work : study.tables)
    options.memory.require(largest_need(work, kept_rows(outputs.table(work), table_work(work), how).rows));
  Interruption interruption;
  OutputFile hdf5_file(outputs.hdf5.string(), options.force, leftover(options.resume));

  std::vector<NamedTable> tables;
  std::string seeds;
  LeadIn lead_in;
  for (const StudyTable& work : study.tables) {
    ResumableTable csv(outputs.table(work), table_work(work), how);
    tables.push_back({work.name, {study_columns(work), {}}});
    if (!run_one(work, csv, interruption, lead_in, tables.back().table)) return leave(csv, outputs.table(work));
    if (work.observable->uses("seed")) seeds += fmt::format("{} {}\n", work.name, work.seed);
  }
  Provenance origin = provenance(options.context, cases_of(study));
  origin.emplace_back("study", read_text((fs::path(folder) / "study.toml").string()));
  origin.emplace_back("seeds", seeds);
  hdf5_file.bytes(to_hdf5(origin, tables));
  hdf5_file.finish();
  for (const StudyTable& work : study.tables) remove_record(outputs.table(work));
  for (const NamedTable& table : tables) fmt::print("{}\n", (outputs.folder / (table.name + ".csv")).string());
  fmt::print("{}\n", outputs.hdf5.string());
  return options.check ? check_baselines(study, folder, tables) : 0;
}

}  // namespace

std::function<int()> declare_run(Command& command, const Context& context) {
  auto options = std::make_shared<Options>();
  options->context = context;
  command.add_option("STUDY", options->study, "study folder, or the name of a known study")->required();
  command.add_option("--output", options->output, "folder that receives STUDY/TABLE.csv and STUDY/STUDY.h5")
      ->shows_default();
  command.add_flag("--force", options->force, "replace existing results");
  command.add_flag("--large", options->large, "also the tables that the study marks as large");
  declare_resume(command, options->resume);
  declare_threads(command, options->threads);
  declare_redo(command, options->redo);
  options->memory.declare(command);
  command.add_flag("--check", options->check, "compare with the study's baseline; exit code 1 where it differs");
  command.footer(
      "Prints the names of the files written.\n"
      "Examples:\n"
      "  nscdd run figure-5                              into results/figure-5\n"
      "  nscdd run studies/figure-7 --output elsewhere --check\n"
      "  nscdd run my-study --force                      a folder of your own with a study.toml");
  return [options] { return run(*options); };
}

}  // namespace nscdd::app
