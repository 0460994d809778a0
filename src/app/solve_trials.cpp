// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/solve_trials.hpp"

#include "contact_solvers/stored_contacts.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "formats/lmgc90/record.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"

namespace nscdd::app {
namespace {

struct NamedTrial {
  std::string problem;
  SolverTrial trial;
  std::optional<Verdict> verdict = {};
};

const ResultColumns<NamedTrial>& columns() {
  static const auto all = joined<NamedTrial>(
      {{{"problem", "", "name of the file", &NamedTrial::problem}},
       columns_of(&NamedTrial::trial, trial_columns()),
       {{"driven_residual", "1", "the natural map of `residual` relative to what drives the contacts, max(|r^1|, p)",
         [](const NamedTrial& one) { return one.trial.driven_residual; }},
        {"verdict", "", "whether the problem has a solution: exists, impossible or undecided; none if not asked for",
         [](const NamedTrial& one) { return one.verdict ? to_string(one.verdict->kind) : std::string_view("none"); }},
        {"margin", "m/s", "largest s found with u_n - mu |u_t| >= s at every contact; nan without a verdict",
         [](const NamedTrial& one) { return one.verdict ? one.verdict->margin : not_a_number; }}}});
  return all;
}

// The files of contact problems, sorted by name.
std::vector<fs::path> problem_files(const std::string& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored) || holds_datbox(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(path))
    if (const fs::path ending = entry.path().extension();
        !entry.is_directory(ignored) && (ending == ".hdf5" || ending == ".h5" || ending == ".dat"))
      files.push_back(entry.path());
  if (files.empty()) fail("{}: expected a folder with contact problems, .hdf5, .h5 or .dat, met none", path);
  std::ranges::sort(files);
  return files;
}

// Of the text of a file, or of all numbers of a problem in several files. Unreadable files are refused at their turn.
std::string fingerprint_of(const fs::path& file) try {
  const std::string path = file.string();
  if (!holds_datbox(path) && !record_at(path) && !has_vloc_rloc_name(path)) return fingerprint(read_text(path));
  const LocalFrictionProblem problem = local_problem(read_contact_problem(path), path);
  std::string all = fingerprint(std::span<const double>(problem.w.valuePtr(), at(problem.w.nonZeros())));
  for (const Vector* numbers : {&problem.q, &problem.friction})
    all += fingerprint(std::span<const double>(numbers->data(), at(numbers->size())));
  return fingerprint(all);
} catch (const Error&) {
  return "unreadable";
}

TableWork trial_work(const std::vector<fs::path>& files, const std::vector<FrictionAlgorithm>& solvers,
                     const SolveOptions& options) {
  std::string cases, names;
  for (const fs::path& file : files)
    cases += fmt::format("{} (content {})\n", file.filename().string(), fingerprint_of(file));
  for (const FrictionAlgorithm solver : solvers) names += fmt::format("solver {}\n", to_string(solver));
  const Index each = count(solvers);
  return {{code_identity(), cases, names,
           field_lines(options.solver) +
               fmt::format("time_limit = {}\nverdict = {}\n", options.time_limit.value_or(infinity), options.verdict)},
          headings(columns()),
          count(files) * each,
          [files, each, solvers](Index row) {
            return KnownCells{{"problem", files[at(row / each)].filename().string()},
                              {"solver", std::string(to_string(solvers[at(row % each)]))}};
          }};
}

// The problem of a file, or nothing, with a note, if the file cannot be read.
std::optional<LocalFrictionProblem> problem_of(const fs::path& path) {
  try {
    LocalFrictionProblem problem = local_problem(read_contact_problem(path.string()), path.string());
    require_moderate(problem, path.string());
    return problem;
  } catch (const Error& error) {
    note("refused: {}", error.what());
    return std::nullopt;
  }
}

// How many problems each solver brought to each residual, and its time.
void print_summary(const Table& table, const std::vector<FrictionAlgorithm>& solvers) {
  const auto met = [&](const Row& row, const std::string& column) {
    return !std::isnan(std::get<double>(row[table.column(column)]));
  };
  fmt::print("{:<18}", "solver");
  for (const double residual : compared_residuals) fmt::print("{:>8.0e}", residual);
  fmt::print("{:>11}\n", "seconds");
  for (const FrictionAlgorithm solver : solvers) {
    std::array<Index, compared_residuals.size()> reached{};
    double duration = 0;
    for (const Row& row : table.rows) {
      if (std::get<std::string>(row[table.column("solver")]) != to_string(solver) || !met(row, "seconds")) continue;
      duration += std::get<double>(row[table.column("seconds")]) + std::get<double>(row[table.column("check_seconds")]);
      for (std::size_t k = 0; k < reached.size(); ++k)
        reached[k] += met(row, fmt::format("seconds_{:.0e}", compared_residuals[k]));
    }
    fmt::print("{:<18}{:>8}{:>11.3g}\n", to_string(solver), fmt::join(reached, ""), duration);
  }
}

// The rows from `first` on.
void run_trials(const std::vector<fs::path>& files, const std::vector<FrictionAlgorithm>& solvers,
                const SolveOptions& options, Interruption& interruption, Index first, const RowSink& sink) {
  const Index each = count(solvers), total = count(files) * each;
  const Monitor monitor = interruption.watch("solve", first, "run");
  std::optional<LocalFrictionProblem> problem;
  std::optional<Verdict> verdict;  // on the problem, once a solver failed or it is asked for
  for (Index number = first; number < total; ++number) {
    const fs::path& file = files[at(number / each)];
    if (number == first || number % each == 0) {
      problem = problem_of(file);
      verdict = {};
    }
    FrictionSolverOptions solver = options.solver;
    solver.algorithm = solvers[at(number % each)];
    NamedTrial one{file.filename().string(), {.solver = solver.algorithm}};
    if (problem)
      one.trial = try_solver(*problem, solver, options.time_limit.value_or(infinity),
                             [&] { return report(monitor, number, total); });
    const bool converged = one.trial.status == to_string(FrictionStatus::converged);
    if (problem && !interruption.stopped() && (options.verdict || !converged)) {
      if (!verdict) verdict = verdict_of(*problem, [&](Index, Index) { return report(monitor, number, total); });
      one.verdict = verdict;
      if (proves_impossible(*verdict, converged, one.trial.driven_residual)) one.trial.status = "impossible";
    }
    if (interruption.stopped()) return;
    sink(row(columns(), one));
    if (!report(monitor, number + 1, total)) return;
  }
}

}  // namespace

LocalFrictionProblem local_problem(const FclibFile& file, const std::string& name) {
  if (const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem)) return reduce(*global, name);
  return std::get<LocalFrictionProblem>(file.problem);
}

int solve_trials(const SolveOptions& options, const Machine& machine) {
  std::vector<FrictionAlgorithm> solvers{options.solver.algorithm};
  if (!options.algorithms.empty()) solvers = contact_solvers_named(options.algorithms, "--solver");
  const std::vector<fs::path> files = problem_files(options.file);
  require_no_input({options.csv}, files);
  const TableWork work = trial_work(files, solvers, options);
  if (nothing_to_resume(options.csv, "", work, options.how, machine)) return 0;
  Interruption interruption;
  ResumableTable csv(options.csv, work, options.how);
  Table table{headings(columns()), {}};
  csv.replay([&](const Row& row) { table.rows.push_back(row); });
  run_trials(files, solvers, options, interruption, csv.kept(), [&](const Row& row) {
    csv.write(row);
    table.rows.push_back(row);
  });
  if (interruption.stopped()) return leave(csv, options.csv);
  csv.finish();
  remove_record(options.csv);
  const Index refused = std::ranges::count_if(table.rows, [status = table.column("status")](const Row& row) {
    return std::get<std::string>(row[status]) == "refused";
  });
  if (refused > 0)
    note("{} of {} problems were refused: see the column 'status'", refused / count(solvers), files.size());
  if (!is_stream(options.csv)) print_summary(table, solvers);
  return refused > 0 ? 1 : 0;
}

}  // namespace nscdd::app
