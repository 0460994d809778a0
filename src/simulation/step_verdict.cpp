// SPDX-License-Identifier: GPL-3.0-or-later
// Decides whether a step that was solved has a solution.
#include "core/memory.hpp"
#include "simulation/contact_solver_step.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

// Steps that end far from a solution by design, with a loose criterion, show no sign that there is no room.
bool is_credible(const StepReport& report) { return report.status == SolverStatus::converged && !report.doubtful; }
bool asks_for_verdict(const StepReport& report, VerdictSteps steps) {
  if (report.status == SolverStatus::given_up || steps == VerdictSteps::never) return false;
  return steps == VerdictSteps::every || report.broke_down() || (report.no_room && !is_credible(report));
}

// The grains and walls of a chain: along it from its end with the smaller number if it is a row, else ascending.
std::vector<Index> bodies_along(const std::vector<ChainContact>& chain) {
  std::map<Index, std::vector<Index>> neighbours;
  for (const ChainContact& one : chain) {
    neighbours[one.geometry.a].push_back(one.geometry.b);
    neighbours[one.geometry.b].push_back(one.geometry.a);
  }
  std::vector<Index> ascending, row;
  for (const auto& one : neighbours) {
    ascending.push_back(one.first);
    if (row.empty() && one.second.size() == 1) row = {one.first, one.second.front()};
  }
  while (!row.empty() && neighbours[row.back()].size() == 2 && row.size() <= ascending.size()) {
    const std::vector<Index>& both = neighbours[row.back()];
    row.push_back(both[0] == row[row.size() - 2] ? both[1] : both[0]);
  }
  return row.size() == ascending.size() ? row : ascending;
}

std::string words(const GranularSystem& system, const StepReport& report, const Verdict& verdict) {
  constexpr std::size_t most = 12;
  std::vector<std::string> names;
  const std::vector<Index> bodies = bodies_along(report.chain);
  for (const Index body : bodies)
    if (names.size() < most) names.push_back(body_name(system, body));
  std::string text =
      fmt::format("no solution: {}{}: closing at {:.6g} m/s", fmt::join(names, ", "),
                  bodies.size() > most ? fmt::format(" and {} more", bodies.size() - most) : "", report.closing_speed);
  // Overlaps that are pushed apart, and gaps that may close.
  if (std::abs(verdict.closing_speed - report.closing_speed) > 1e-6 * verdict.closing_speed)
    text += fmt::format(", {:.6g} m/s with overlaps and gaps", verdict.closing_speed);
  return text + (std::isinf(verdict.proven_speed)
                     ? " (proved)"
                     : fmt::format(" (proved for changes of velocity below {:.2g} m/s)", verdict.proven_speed));
}

}  // namespace

template <int D>
std::string judge(GranularStep<D>& step, const Simulation& before, const std::function<bool()>& goes_on) {
  StepReport& report = step.report;
  if (!asks_for_verdict(report, before.dynamics.solver.verdict) || !opens(step.problem.law)) return "";
  StepProblem<D> whole = whole_step<D>(before);
  Verdict verdict;
  bool stopped = false;
  try {
    verdict = verdict_of(contact_problem(whole, before.system),
                         [&](Index, Index) { return !(stopped = stopped || (goes_on && !goes_on())); });
  } catch (const OutOfMemory&) {
    throw;
  } catch (const Error&) {  // numbers too large, as where a step breaks down
    report.verdict = VerdictKind::undecided;
    return "";
  }
  if (stopped) {  // the run goes on with this step, and its verdict, later
    report.status = SolverStatus::given_up;
    return "";
  }
  report.verdict = verdict.kind;
  report.margin = verdict.margin;
  if (!proves_impossible(verdict, is_credible(report), report.driven_residual())) return "";
  if (!report.broke_down()) report.status = SolverStatus::impossible;
  std::vector<GrainContact<D>> driven;  // of the chain, without overlaps and gaps
  for (std::size_t i = 0; i < verdict.chain.size(); ++i) {
    const std::size_t c = at(verdict.chain[i]);
    report.chain.push_back({report.step, whole.geometry[c], verdict.stress[static_cast<Index>(i)]});
    driven.push_back(whole.contacts[c]);
    driven.back().bias = {};
  }
  const Vector added = global_problem(whole, driven, before.system).w;
  report.closing_speed = 0;
  for (Index i = 0; i < verdict.stress.size(); ++i) report.closing_speed -= verdict.stress[i] * added[D * i];
  return words(before.system, report, verdict);
}

template std::string judge(GranularStep<2>&, const Simulation&, const std::function<bool()>&);
template std::string judge(GranularStep<3>&, const Simulation&, const std::function<bool()>&);

}  // namespace nscdd
