// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/simulate_output.hpp"

#include "core/fail.hpp"

namespace nscdd::app {
namespace {

// Throws Error unless the steps in the table, from its first one on, end with the last iterations of those of the run.
// `last`: the last iteration of each step in the table; 0: none.
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

// The number in the table cell at `begin`, and the beginning of the next cell.
std::pair<Index, std::size_t> cell_at(const std::string& text, std::size_t begin, const std::string& name) {
  const std::size_t comma = text.find(',', begin);
  return {parse_integer(text.substr(begin, comma - begin), name), comma + 1};
}

// Bytes of the table up to the last row of the completed steps.
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

// Bytes to keep of the table of the earlier run, which becomes a partial file again.
std::uintmax_t reopened(const std::string& path, const RunSoFar& run) {
  const fs::path growing = partial_path(path);
  if (is_stream(path)) return 0;
  if (!is_there(growing)) {
    if (!is_there(path)) return 0;
    std::error_code status;
    fs::rename(path, growing, status);
    if (status) fail("{}: cannot be renamed: {}", path, status.message());
  }
  const std::string text = read_text(growing.string());
  return text.empty() ? 0 : bytes_of_run(text, run, growing.string());
}

void require_table_to_go_on(const std::string& path, const RunSoFar& run) {
  if (path.empty() || is_stream(path)) return;
  if (const std::string name = partial_path(path).string(); is_there(name)) {
    const std::string text = read_text(name);
    const bool own = !text.empty() && bytes_of_run(text, run, name) > 0;
    return require_writable(path, own, true);  // the run's own partial table replaces one under its name
  }
  if (!is_there(path)) return require_writable(path, false);
  const std::string text = read_text(path);  // of a completed run
  if (bytes_of_run(text, run, path) < text.size() && !run.failed)
    fail("{}: expected the table of a run of {} steps to go on with, met later steps in it", path,
         run.iterations.size());
}

// The lines of a case without those that change no step, or only the first, and an end.
std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (TextLines each(text); each.next();)
    if (!each.line().empty() && std::ranges::none_of(std::array{"steps = ", "forces = ", "verdict = ", "impossible = "},
                                                     [&](const char* key) { return each.line().starts_with(key); }))
      lines.emplace_back(each.line());
  lines.push_back("the end");
  return lines;
}

void require_same_case(const std::string& path, const TrajectoryHeader& found, const std::string& case_text) {
  const std::vector<std::string> had = lines_of(found.case_text), has = lines_of(case_text);
  if (const auto [before, now] = std::ranges::mismatch(had, has); before != had.end() && now != has.end())
    fail("{}: expected the case and options of the run it holds ({}), met {}", path, *before, *now);
  if (const std::string build = build_fingerprint(); found.build != build)
    fail(
        "{}: expected a trajectory of this build of the program ({}), met one of another ({}): its steps would not be "
        "those of one run",
        path, build, found.build);
}

void require_same_grains(const std::string& path, const GranularSystem& old, const GranularSystem& system) {
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
  const std::string_view shape = shape_of_grains(asked.z.empty() ? 2 : 3);
  for (const auto values : numbers_of_grains(asked.z.empty() ? 2 : 3)) {
    const std::vector<double>&had = found.*values, &has = asked.*values;
    if (had.size() != has.size())
      fail("{}: expected {} {}s in its first step, met {}", path, has.size(), shape, had.size());
    const auto i = static_cast<std::size_t>(std::ranges::mismatch(had, has).in1 - had.begin());
    if (i < had.size())
      fail(
          "{}: expected the start of the run it holds, met {} {} elsewhere or at another velocity, at ({}, {}) m "
          "instead of ({}, {}) m",
          path, shape, i, asked.x.at(i), asked.y.at(i), found.x.at(i), found.y.at(i));
  }
}

}  // namespace

RunSoFar run_so_far(const std::string& path) {
  const std::string end = read_end(path);
  return {path, read_summary(path, "iterations"), read_summary(path, "mean_speed"),
          end.starts_with(to_string(RunEnd::broke_down)) || end.starts_with(to_string(RunEnd::impossible))};
}

void check_restart(const std::string& path, const std::string& table, const CaseSpec& spec) {
  require_same_case(path, read_trajectory_header(path), to_toml(spec));
  const Index done = read_last_step(path).state.step, steps = spec.dynamics->time.steps;
  if (done > steps) fail("{}: expected to go on to {} steps or more, those it holds, met {}", path, done, steps);
  require_table_to_go_on(table, run_so_far(path));
}

void take_up(Simulation& simulation, const std::string& path) {
  require_same_grains(path, read_trajectory_header(path).system, simulation.system);
  require_same_start(path, simulation.state);
  simulation.state = read_last_step(path).state;
  free_released_grains(simulation.system, simulation.state);
  require_fit(path, simulation);
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
    if (const std::string& table = files_.convergence; !table.empty()) {
      std::optional<std::uintmax_t> kept;  // the rows of completed steps
      if (found) kept = reopened(table, *found);
      table_.emplace(table, files_.force || kept.value_or(0) > 0, headings(iteration_columns()), kept);
    }
    if (found)
      trajectory_->go_on(header.case_text,
                         fmt::format("from step {}: nscdd {}: {}\n", simulation.state.step, version(), command_line),
                         read_chains(files_.output, simulation.state.step));
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
    } catch (const Error& error) {  // the other ranks are in the middle of a step: rethrown at its end
      failure_ = error;
    }
  };
  return {write, files_.convergence_every.value_or(0)};
}

// Rank 0 gathers the contacts of the newest step and appends it to the trajectory.
void RunOutput::hand_over(bool keep) {
  if (!newest_) return;
  if (std::vector<TrajectoryContact>& contacts = newest_->contacts; !processes_.alone()) {
    contacts = processes_.gather(contacts, false);
    std::ranges::sort(contacts, {}, [](const TrajectoryContact& c) { return std::pair(c.geometry.a, c.geometry.b); });
  }
  if (trajectory_) trajectory_->append(*std::move(newest_), rows_, keep);
  newest_.reset();
  rows_.clear();
}

void RunOutput::add(const Simulation& after, const AnySolvedStep& solved, const StepReport& report) {
  first([] {});  // throws `failure_`: a step without its rows in the table must not reach the trajectory
  const bool keep = report.step % files_.save_every == 0 || report.step == after.dynamics.time.steps;
  newest_.emplace();
  if (processes_.first()) newest_->state = after.state;
  newest_->contacts = std::visit([](const auto& step) { return trajectory_contacts(step); }, solved);
  rows_.push_back(row(step_columns(), report));
  if (trajectory_) trajectory_->append(report.chain);
  // Several ranks exchange contacts only when rank 0 is about to write them.
  const bool due = processes_.any(trajectory_ && trajectory_->due());
  if (keep || due || processes_.alone()) hand_over(keep);
  first([&] {
    if (!due) return;
    if (table_) table_->flush();  // first: a restart needs the rows of all steps in the trajectory
    trajectory_->commit();
  });
}

void RunOutput::end(const RunOutcome& outcome) {
  hand_over(false);
  first([&] {
    if (table_) table_->flush();
    trajectory_->append(outcome.chain);
    trajectory_->end(outcome.reason.empty() ? std::string(to_string(outcome.end))
                                            : fmt::format("{}: {}", to_string(outcome.end), outcome.reason));
    if (table_ && outcome.end == RunEnd::stopped) table_->leave();
    if (table_ && outcome.end != RunEnd::stopped) table_->finish();
  });
}

}  // namespace nscdd::app
