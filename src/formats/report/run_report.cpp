// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/report/run_report.hpp"

#include "core/fail.hpp"
#include "core/text.hpp"
#include "files/csv.hpp"

#include <map>

namespace nscdd {
namespace {

// The columns on the page.
constexpr std::string_view shown_of_summary =
    "step time iterations zeta interface_change gluing normal_change natural_map driven_residual no_room margin "
    "closing_speed quad_dv quad_dvr mean_dv_over_r qm_16 active stick slide contacts overlap_maximum kinetic potential "
    "boundary_work dissipation numerical";
constexpr std::string_view shown_of_iterations =
    "step iteration zeta interface_change gluing normal_change natural_map quad_dv quad_dvr mean_dv_over_r qm_16";

template <class Result>
Column heading_of(std::string_view name, const ResultColumns<Result>& columns) {
  return std::ranges::find(columns, name, [](const auto& column) { return column.heading.name; })->heading;
}

DrawnStep drawn(const Simulation& run, const TrajectoryStep& step) {
  const GranularState& state = step.state;
  DrawnStep result{state.step, state.time, state.x, state.y, state.z, {}, {}};
  for (const Wall& wall : run.system.walls) {
    const auto b = at(wall.boundary);
    result.walls.push_back(moved(wall, run.system.boundaries[b].motion, state.poses[b]));
  }
  std::ranges::copy_if(step.contacts, std::back_inserter(result.contacts),
                       [](const TrajectoryContact& c) { return c.carries() || c.self_stress > 0; });
  return result;
}

// Bytes of a step on the page, in letters of six bits: four bytes for each coordinate of a grain and of the point of a
// carrying contact, which also has ends, subdomain, impulses, self-stress and status.
double bytes_of(const TrajectoryStep& step) {
  const auto carrying = std::ranges::count_if(step.contacts, [](const TrajectoryContact& c) { return c.carries(); });
  const double place = step.state.z.empty() ? 8 : 12;
  return 4.0 / 3 * (place * static_cast<double>(step.state.x.size()) + (place + 25) * static_cast<double>(carrying)) +
         200;
}

// Compares the last iteration of each step, which always has a row, with the summary. The indicator zeta tells runs
// apart that use up all allowed iterations.
void require_same_run(const std::vector<Series>& table, const std::string& path, const std::string& run) {
  const std::vector<double>&step = table[0].values, &iteration = table[1].values, &zeta = table[2].values;
  const std::vector<double> taken = read_summary(run, "iterations"), end = read_summary(run, "zeta");
  std::map<std::size_t, std::size_t> last;  // row of the last iteration of a step
  for (std::size_t row = 0; row < step.size(); ++row) {
    const auto [known, first] = last.try_emplace(static_cast<std::size_t>(step[row]), row);
    if (!first && iteration[row] > iteration[known->second]) known->second = row;
  }
  for (const auto& [number, row] : last) {
    const double expected = end[number - 1], met = zeta[row];
    if (iteration[row] != taken[number - 1] || std::abs(met - expected) > 1e-9 * std::abs(expected))
      fail("{}: expected the table of the run {}, whose step {} ended with iteration {} and zeta {}; met {} and {}",
           path, run, number, taken[number - 1], expected, iteration[row], met);
  }
}

}  // namespace

std::vector<Series> read_iterations(const std::string& path, const std::string& run) {
  const Index steps = count(read_statuses(run));
  const CsvText csv = parse_csv(read_text(path), path);
  std::vector<Series> all;
  for (const std::string_view name : split(shown_of_iterations, ' ')) {
    const auto found = std::ranges::find(csv.columns, name);
    if (found == csv.columns.end())
      fail("{}: expected a table of nscdd simulate --convergence with a column {}, met none", path, name);
    Series& series = all.emplace_back(Series{heading_of(name, iteration_columns()), {}});
    const auto column = static_cast<std::size_t>(found - csv.columns.begin());
    for (std::size_t row = 0; row < csv.rows.size(); ++row)
      series.values.push_back(
          parse_number(csv.rows[row][column], fmt::format("{}:{}: {}", path, csv.lines[row], name)));
  }
  for (std::size_t row = 0; row < csv.rows.size(); ++row)
    if (const double step = all.front().values[row]; !(step >= 1 && step <= static_cast<double>(steps)))
      fail("{}:{}: step: expected one of the {} steps of the run, met {}", path, csv.lines[row], steps, step);
  require_same_run(all, path, run);
  return all;
}

std::vector<Index> steps_to_draw(const std::string& path, const std::vector<Index>& steps, double bytes) {
  if (steps.size() < 2) return steps;
  const double largest = std::max(bytes_of(read_trajectory_step(path, steps[steps.size() / 2])),
                                  bytes_of(read_trajectory_step(path, steps.back())));
  const Index number = std::clamp<Index>(static_cast<Index>(bytes / largest), 2, count(steps));
  std::vector<Index> chosen;
  for (Index i = 0; i < number; ++i) chosen.push_back(steps[at(i * (count(steps) - 1) / (number - 1))]);
  return chosen;
}

std::optional<RunReport> report_run(const std::string& path, const std::vector<Index>& steps, const Monitor& monitor) {
  RunReport report;
  report.header = read_trajectory_header(path);
  report.ended = read_end(path);
  report.status = read_statuses(path);
  if (report.status.empty() && read_chains(path).empty())
    fail("{}: expected a run that has taken a step, met none", path);
  report.name = name_of_case(path, report.header);
  report.kept = count(trajectory_steps(path));
  for (const std::string_view word : split(shown_of_summary, ' '))
    if (const std::string name(word); report.status.empty() || has_summary(path, name))
      report.summary.push_back({heading_of(name, step_columns()), read_summary(path, name)});
  std::optional<Simulation> run;
  for (const Index number : steps) {
    TrajectoryStep step = read_trajectory_step(path, number);
    add_chain(path, step);
    if (!run) {
      run = rebuilt_simulation(path, report.header, step.state);
      report.header.system.boundaries = run->system.boundaries;  // a header has their names only
    }
    free_released_grains(report.header.system, step.state);
    report.solver = run->dynamics.solver;
    if (decomposes(report.solver.algorithm)) report.subdomains = subdomains(run->partitioner);
    report.steps.push_back(drawn(*run, step));
    if (!nscdd::report(monitor, count(report.steps), count(steps))) return std::nullopt;
  }
  return report;
}

}  // namespace nscdd
