// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/simulate_output.hpp"

#include "core/fail.hpp"

#include <filesystem>
#include <sstream>

namespace nscdd::app {
namespace {

namespace fs = std::filesystem;

// Throws Error unless the steps in the table, which begins with any, end with the iterations that the steps
// of the run ended with. `last`: the last iteration of each step in the table, 0 of steps that it lacks.
void require_rows_of(const RunSoFar& run, const std::vector<Index>& last, const std::string& name) {
  const auto first = std::find_if(last.begin(), last.end(), [](Index n) { return n > 0; });
  for (auto step = first; step != last.end(); ++step) {
    const auto expected = static_cast<Index>(run.iterations[at(step - last.begin())]);
    if (*step != expected)
      fail(
          "{}: expected rows of step {} of the run in {} up to its last iteration, {}, met {}; a table of another name "
          "begins with the steps taken now",
          name, step - last.begin() + 1, run.path, expected, *step == 0 ? "none" : fmt::format("them up to {}", *step));
  }
}

// The number in a cell of a line of a table that begins at `begin`, and where the next cell begins.
std::pair<Index, std::size_t> cell_at(const std::string& text, std::size_t begin, const std::string& name) {
  const std::size_t comma = text.find(',', begin);
  return {parse_integer(text.substr(begin, comma - begin), name), comma + 1};
}

// Bytes of a table up to the last row of the steps done.
std::uintmax_t bytes_of_run(const std::string& text, const RunSoFar& run, const std::string& name) {
  const std::string header = csv_header(headings(iteration_columns())) + "\n";
  if (text.substr(0, header.size()) != header)
    fail("{}: expected the table of a run to go on with, met other columns", name);
  std::size_t kept = header.size();
  std::vector<Index> last(run.iterations.size(), 0);
  for (std::size_t end = text.find('\n', kept); end != std::string::npos; end = text.find('\n', kept)) {
    const auto [step, behind] = cell_at(text, kept, name + ": step");
    if (step > count(last)) break;
    if (step < 1) fail("{}: step: expected a number from 1, met {}", name, step);
    const Index iteration = cell_at(text, behind, name + ": iteration").first;
    Index& before = last[at(step - 1)];
    if (iteration <= before)
      fail("{}: step {}: expected ascending iterations, met {} after {}", name, step, iteration, before);
    before = iteration;
    kept = end + 1;
  }
  require_rows_of(run, last, name);
  return kept;
}

bool grows(const std::string& path) {
  std::error_code status;
  return fs::exists(partial_path(path), status);
}

// How many bytes are kept of the table of the earlier run, which goes on growing as a partial file.
std::uintmax_t reopened(const std::string& path, const RunSoFar& run) {
  std::error_code status;
  const fs::path growing = partial_path(path);
  if (is_stream(path)) return 0;
  if (!grows(path)) {
    if (!fs::exists(path, status)) return 0;
    fs::rename(path, growing, status);
    if (status) fail("{}: cannot be renamed: {}", path, status.message());
  }
  const std::string text = read_text(growing.string());
  return text.empty() ? 0 : bytes_of_run(text, run, growing.string());
}

// Throws Error if the run cannot go on with the table at `path`. Changes nothing.
void require_table_to_go_on(const std::string& path, const RunSoFar& run) {
  std::error_code status;
  if (path.empty() || is_stream(path)) return;
  if (grows(path)) {
    const std::string name = partial_path(path).string(), text = read_text(name);
    const bool own = !text.empty() && bytes_of_run(text, run, name) > 0;
    return require_writable(path, own, true);  // a table beside the run's own is one that it replaces
  }
  if (!fs::exists(path, status)) return require_writable(path, false);
  const std::string text = read_text(path);  // of a run that came to its end
  if (bytes_of_run(text, run, path) < text.size() && !run.broke_down)
    fail("{}: expected the table of a run of {} steps to go on with, met later steps in it", path,
         run.iterations.size());
}

// The lines of a case without those that say how many steps are asked for, and an end.
std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);)
    if (!line.starts_with("steps = ")) lines.push_back(line);
  lines.push_back("the end");
  return lines;
}

// Throws Error naming the first line in which the case of a trajectory differs from the one asked for.
void require_same_case(const std::string& path, const TrajectoryHeader& found, const std::string& case_text) {
  const std::vector<std::string> had = lines_of(found.case_text), has = lines_of(case_text);
  if (const auto [before, now] = std::ranges::mismatch(had, has); before != had.end() && now != has.end())
    fail("{}: expected the case and options of the run it holds ({}), met {}", path, *before, *now);
  if (const std::string build = build_fingerprint(); found.build != build)
    fail(
        "{}: expected a trajectory of this build of the program ({}), met one of another ({}): its steps would not "
        "be those of one run",
        path, build, found.build);
}

void require_same_disks(const std::string& path, const GranularSystem& old, const GranularSystem& system) {
  const std::string_view shape = shape_of_grains(system.dimension);
  if (old.dimension != system.dimension) fail("{}: expected {}s, met {}s", path, shape, shape_of_grains(old.dimension));
  if (old.radius.size() != system.radius.size())
    fail("{}: expected {} {}s, met {}", path, system.radius.size(), shape, old.radius.size());
  for (std::size_t i = 0; i < system.radius.size(); ++i)
    if (old.radius[i] != system.radius[i] || old.mass[i] != system.mass[i] || old.driven_by[i] != system.driven_by[i])
      fail("{}: expected the {}s of this case, met another {} {}", path, shape, shape, i);
}

void require_same_start(const std::string& path, const GranularState& asked) {
  const std::optional<TrajectoryStep> first = find_trajectory_step(path, 0);
  if (!first) return;
  const GranularState& found = first->state;
  for (const auto values : numbers_of_grains(asked.z.empty() ? 2 : 3)) {
    const std::vector<double>&had = found.*values, &has = asked.*values;
    if (had.size() != has.size()) fail("{}: expected {} disks in its first step, met {}", path, has.size(), had.size());
    const auto differs = std::mismatch(had.begin(), had.end(), has.begin());
    if (differs.first == had.end()) continue;
    const auto i = static_cast<std::size_t>(differs.first - had.begin());
    fail(
        "{}: expected the start of the run it holds, met disk {} elsewhere or at another velocity, at ({}, {}) m "
        "instead of ({}, {}) m",
        path, i, asked.x.at(i), asked.y.at(i), found.x.at(i), found.y.at(i));
  }
}

Index steps_that(const RunTotals& totals, SolverStatus status) {
  const auto found = totals.statuses.find(to_string(status));
  return found == totals.statuses.end() ? 0 : found->second;
}

// What to do about steps that did not converge. Where there may be no solution, nothing that a solver is given helps.
std::string advice(const RunTotals& totals, const StepSolver& solver) {
  if (totals.no_room > 0) return "check first that the boundaries leave room";
  const Index stalled = steps_that(totals, SolverStatus::stalled);
  const std::string more = fmt::format("--iterations allows more than {}", solver.maximum_iterations);
  if (stalled == 0) return more;
  const std::string other = "another --algorithm, a smaller dynamics.step or a larger --tolerance may help";
  if (stalled == totals.steps - totals.converged)
    return fmt::format("they stalled, so more iterations do not help; {}", other);
  return fmt::format("{} of them stalled: {}; for the others {}", stalled, other, more);
}

std::string warnings(const RunTotals& totals, const Dynamics& dynamics) {
  const StepSolver& solver = dynamics.solver;
  std::string text;
  if (const std::string words = lack_of_room(totals); !words.empty()) text += fmt::format("attention: {}\n", words);
  if (totals.relative_overlap > notable_overlap)
    text += fmt::format(
        "attention: bodies overlap by up to {:.3g} of the smaller radius: a packing that begins with overlaps, "
        "boundaries that leave no room, or a step or tolerance too coarse\n",
        totals.relative_overlap);
  const Index open = totals.steps - totals.converged;
  if (open > 0 && (solver.criterion != Criterion::none || is_contact_solver(solver.algorithm)))
    text +=
        fmt::format("attention: {} of {} steps ended before {} fell to {}{}; {}\n", open, totals.steps,
                    to_string(is_contact_solver(solver.algorithm) ? Choice(Criterion::natural_map) : solver.criterion),
                    solver.tolerance, totals.interface ? fmt::format(" and jumps to {}", solver.gluing_tolerance) : "",
                    advice(totals, solver));
  if (totals.doubtful > 0)
    text += fmt::format(
        "attention: {} of {} steps converged relative to impulses that are large beside what drives the step: see the "
        "column driven_residual of /summary\n",
        totals.doubtful, totals.steps);
  if (totals.gluing > solver.gluing_tolerance && open == 0 && solver.criterion != Criterion::none)
    text += fmt::format(
        "attention: grains were left with jumps of {:.3g} of the speeds at the interface, above {}: this scheme does "
        "not iterate on them\n",
        totals.gluing, solver.gluing_tolerance);
  // Every run pushes some overlaps apart; only a notable gain is worth a line, and none that is rounding.
  constexpr double notable_gain = 0.01, rounding = 1e-12;
  const double energies =
      totals.last.energy.kinetic + std::abs(totals.boundary_work) + std::max(0.0, totals.dissipation);
  if (!(totals.gain > std::max(notable_gain * energies, rounding * totals.contact_energy))) return text;
  const bool pushes = totals.relative_overlap > 0 && dynamics.interaction.restitution == 0 &&
                      dynamics.time.penetration_correction > 0 && dynamics.time.maximum_push_speed != 0;
  std::vector<std::string_view> reasons;
  if (pushes) reasons.push_back("overlaps pushed apart (dynamics.maximum_push_speed)");
  if (open > 0) reasons.push_back("steps that had not converged");
  if (reasons.empty()) reasons.push_back("a step or tolerance too coarse");
  return text + fmt::format("attention: contacts added {:.3g} J in {} steps: {}\n", totals.gain, totals.gaining_steps,
                            fmt::join(reasons, ", or "));
}

}  // namespace

RunSoFar run_so_far(const std::string& path) {
  return {path, read_summary(path, "iterations"), read_summary(path, "kinetic"),
          read_end(path).starts_with(to_string(RunEnd::broke_down))};
}

void check_restart(const std::string& path, const std::string& table, const CaseSpec& spec) {
  require_same_case(path, read_trajectory_header(path), to_toml(spec));
  const Index done = read_last_step(path).state.step, steps = spec.dynamics->time.steps;
  if (done > steps) fail("{}: expected to go on to {} steps or more, those it holds, met {}", path, done, steps);
  require_table_to_go_on(table, run_so_far(path));
}

void take_up(Simulation& simulation, const std::string& path) {
  require_same_disks(path, read_trajectory_header(path).system, simulation.system);
  require_same_start(path, simulation.state);
  simulation.state = read_last_step(path).state;
  require_fit(path, simulation);
}

std::unique_ptr<CsvWriter> convergence_table(const std::string& path, bool force, const std::optional<RunSoFar>& run) {
  if (path.empty()) return nullptr;
  std::optional<std::uintmax_t> kept;
  if (run) kept = reopened(path, *run);
  return std::make_unique<CsvWriter>(path, force || kept.value_or(0) > 0, headings(iteration_columns()), kept);
}

void RunOutput::first(const std::function<void()>& work) {
  processes_.together([&] {
    if (failure_) throw Error(*failure_);
    if (processes_.first()) work();
    return true;
  });
}

void RunOutput::open(const TrajectoryHeader& header, const Simulation& simulation, const std::optional<RunSoFar>& found,
                     const std::string& command_line) {
  first([&] {
    if (found) trajectory_.emplace(files_.output, headings(step_columns()));
    table_ = convergence_table(files_.convergence, files_.force, found);
    if (found)
      trajectory_->go_on(header.case_text,
                         fmt::format("from step {}: nscdd {}: {}\n", simulation.state.step, version(), command_line));
    else
      trajectory_.emplace(files_.output, header, TrajectoryStep{simulation.state, {}}, headings(step_columns()));
  });
}

IterationSink RunOutput::iterations() {
  if (files_.convergence.empty()) return {};
  const auto write = [this](const IterationRow& each) {
    if (!table_ || failure_) return;
    try {
      table_->write(row(iteration_columns(), each));
    } catch (const Error& error) {  // the others are in the middle of a step: they hear of it at its end
      failure_ = error;
    }
  };
  return {write, files_.convergence_every.value_or(0)};
}

// The first process gathers the contacts of the newest step, and passes it on to the trajectory.
void RunOutput::hand_over(bool keep) {
  if (!newest_) return;
  newest_->contacts = contacts_at_first(std::move(newest_->contacts), processes_);
  if (trajectory_) trajectory_->append(*std::move(newest_), rows_, keep);
  newest_.reset();
  rows_.clear();
}

void RunOutput::add(const Simulation& after, const AnySolvedStep& solved, const StepReport& report) {
  first([] {});  // a step whose rows the table could not take must not reach the trajectory
  const bool keep = report.step % files_.save_every == 0 || report.step == after.dynamics.time.steps;
  newest_.emplace();
  if (processes_.first()) newest_->state = after.state;
  newest_->contacts = std::visit([](const auto& step) { return trajectory_contacts(step); }, solved);
  rows_.push_back(row(step_columns(), report));
  // Of several processes the first one asks the others for contacts only when it is about to write them.
  const bool due = processes_.any(trajectory_ && trajectory_->due());
  if (keep || due || processes_.alone()) hand_over(keep);
  first([&] {
    if (!due) return;
    if (table_) table_->flush();  // first: a restart needs the rows of all the steps that the trajectory has
    trajectory_->commit();
  });
}

void RunOutput::end(const RunOutcome& outcome) {
  hand_over(false);
  first([&] {
    if (table_) table_->flush();
    trajectory_->end(outcome.reason.empty() ? std::string(to_string(outcome.end))
                                            : fmt::format("{}: {}", to_string(outcome.end), outcome.reason));
    if (table_ && outcome.end == RunEnd::stopped) table_->leave();
    if (table_ && outcome.end != RunEnd::stopped) table_->finish();
  });
}

std::string lack_of_room(const RunTotals& totals) {
  if (totals.no_room == 0) return "";
  return fmt::format(
      "in {} of {} steps, at first in step {}, contacts close although their impulses have grown far beyond what "
      "drives "
      "the step: the boundaries may leave no room, and then no impulses are a solution and more iterations do not help "
      "(work of the boundaries in the run: {:.3g} J)",
      totals.no_room, totals.steps, totals.first_no_room, totals.boundary_work);
}

std::string report_text(const RunTotals& totals, const Simulation& simulation, const RunOutcome& outcome) {
  const Index free = simulation.system.free_disks();
  std::vector<std::string> statuses;
  for (const auto& [status, number] : totals.statuses) statuses.push_back(fmt::format("{} {}", number, status));
  std::string text =
      fmt::format("{}: {} steps in this run, {} of {} in all, t = {:.6g} s\n", to_string(outcome.end), totals.steps,
                  simulation.state.step, simulation.dynamics.time.steps, simulation.state.time);
  const StepAlgorithm algorithm = simulation.dynamics.solver.algorithm;
  const bool undivided = is_contact_solver(algorithm) && !decomposes(algorithm);  // whatever the partition
  text += fmt::format("{}s: {} free, {} driven; {} contacts, {}\n", shape_of_grains(simulation.system.dimension), free,
                      simulation.system.disks() - free, totals.last.contacts,
                      undivided ? fmt::format("solved undivided by {}", to_string(algorithm))
                                : fmt::format("interface of {} unknowns", totals.last.interface_size));
  if (totals.steps == 0) return text;
  text += fmt::format("steps: {}\n", fmt::join(statuses, ", "));
  text +=
      fmt::format("iterations: {} in all, {:.4g} per step, {} at most\n", totals.iterations,
                  static_cast<double>(totals.iterations) / static_cast<double>(totals.steps), totals.most_iterations);
  text += fmt::format("worst residual of the contact law: {:.3g} in step {}; largest overlap {:.3g} m\n",
                      totals.natural_map, totals.worst_step, totals.overlap);
  if (totals.last.interface_size > 0)
    text += fmt::format("largest jump at the interface: {:.3g} of the speeds there\n", totals.gluing);
  text += fmt::format(
      "energy: kinetic {:.6g} J at the end; boundary work {:.6g} J, dissipation {:.6g} J, numerical {:.3g} J\n",
      totals.last.energy.kinetic, totals.boundary_work, totals.dissipation, totals.numerical);
  text +=
      fmt::format("time: {:.4g} s of iterations, {:.4g} s of setting up", totals.solve_seconds, totals.setup_seconds);
  if (totals.visits > 0 && (algorithm == StepAlgorithm::nlgs || algorithm == StepAlgorithm::generic))
    text += fmt::format("; {:.3g} ns per contact and sweep", 1e9 * totals.solve_seconds / totals.visits);
  return text + "\n" + warnings(totals, simulation.dynamics);
}

}  // namespace nscdd::app
