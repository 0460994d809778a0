// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/simulate_output.hpp"

#include <fmt/format.h>

namespace nscdd::app {
namespace {

Index number_of(const std::map<std::string_view, Index>& counted, std::string_view word) {
  return counted.contains(word) ? counted.at(word) : 0;
}

// Advice for steps that did not converge. If no solution may exist, no setting of a solver helps.
std::string advice(const RunTotals& totals, const Dynamics& dynamics) {
  if (totals.no_room > 0) return "check first that the boundaries leave room";
  const bool bounded = !dynamics.boundaries.empty();
  const Index stalled = number_of(totals.statuses, to_string(SolverStatus::stalled));
  const std::string more = fmt::format("--iterations allows more than {}{}", dynamics.solver.maximum_iterations,
                                       bounded ? ", which helps unless the boundaries leave no room" : "");
  if (stalled == 0) return more;
  const std::string other =
      fmt::format("another --algorithm, a smaller dynamics.step or a larger --tolerance may help{}",
                  bounded ? ", unless the boundaries leave no room" : "");
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
  const Index open = totals.steps - totals.converged - number_of(totals.verdicts, to_string(VerdictKind::impossible));
  if (open > 0 && (solver.criterion != Criterion::none || is_contact_solver(solver.algorithm)))
    text +=
        fmt::format("attention: {} of {} steps ended before {} fell to {}{}; {}\n", open, totals.steps,
                    to_string(is_contact_solver(solver.algorithm) ? Choice(Criterion::natural_map) : solver.criterion),
                    solver.tolerance,
                    totals.interface && has_part(solver.algorithm, StepPart::exchanges)
                        ? fmt::format(" and jumps to {}", solver.gluing_tolerance)
                        : "",
                    advice(totals, dynamics));
  const double safe = 2 / static_cast<double>(totals.most_copies);
  if (has_part(solver.algorithm, StepPart::whole_copies) &&
      (solver.interface_relaxation > safe || (open > 0 && solver.interface_relaxation == safe)))
    text += fmt::format(
        "attention: up to {} subdomains share a body, and schwarz may diverge with an interface_relaxation of "
        "{:.3g} or more, met {}\n",
        totals.most_copies, safe, solver.interface_relaxation);
  if (totals.doubtful > 0)
    text += fmt::format(
        "attention: {} of {} steps converged relative to impulses that are large relative to what drives the step: see "
        "the column driven_residual of /summary\n",
        totals.doubtful, totals.steps);
  if (totals.gluing > solver.gluing_tolerance && open == 0 && solver.criterion != Criterion::none)
    text += fmt::format(
        "attention: grains were left with jumps of {:.3g} of the speeds at the interface, above {}: this scheme does "
        "not iterate on them\n",
        totals.gluing, solver.gluing_tolerance);
  // Every run pushes some overlaps apart. At rest energies are of the order of tolerance x r W r.
  constexpr double notable_gain = 0.01;
  const double energies =
      totals.last.energy.kinetic + std::abs(totals.boundary_work) + std::max(0.0, totals.dissipation);
  if (!(totals.gain > std::max(notable_gain * energies, solver.tolerance * totals.contact_energy))) return text;
  const bool pushes = totals.relative_overlap > 1e-9 && !dynamics.interaction.on_velocity() &&
                      dynamics.time.penetration_correction > 0 && dynamics.time.maximum_push_speed != 0;
  std::vector<std::string_view> reasons;
  if (pushes) reasons.push_back("overlaps pushed apart (dynamics.maximum_push_speed)");
  if (dynamics.interaction.cohesion > 0) reasons.push_back("cohesion, which draws grains together");
  if (open > 0) reasons.push_back("steps that had not converged");
  if (reasons.empty()) reasons.push_back("a step or tolerance too coarse");
  return text + fmt::format("attention: contacts added {:.3g} J in {} steps: {}\n", totals.gain, totals.gaining_steps,
                            fmt::join(reasons, ", or "));
}

}  // namespace

std::string lack_of_room(const RunTotals& totals) {
  if (totals.no_room == 0) return "";
  const bool proved = number_of(totals.verdicts, to_string(VerdictKind::impossible)) == totals.no_room;
  return fmt::format(
      "in {} of {} steps, at first in step {}, {} (work of the boundaries in the run: {:.3g} J)", totals.no_room,
      totals.steps, totals.first_no_room,
      proved ? "the boundaries leave no room: it is proved that no impulses are a solution"
             : "contacts close although their impulses have grown far beyond what drives the step: the boundaries may "
               "leave no room, and then no impulses are a solution and more iterations do not help; or these steps "
               "ended far from their solution, which a smaller --tolerance tells",
      totals.boundary_work);
}

std::string report_text(const RunTotals& totals, const Simulation& simulation, const RunOutcome& outcome) {
  const GranularSystem& system = simulation.system;
  const Index free = system.free_grains();
  Index in_bodies = 0, bodies = 0;
  for (Index i = 0; i < system.grains(); ++i) in_bodies += !system.free(i) && system.moves(i);
  for (const Index k : system.free_bodies) bodies += system.boundaries[at(k)].body->reach > 0;  // that have grains
  const std::string of_bodies =
      in_bodies == 0 ? "" : fmt::format(", {} in {} {}", in_bodies, bodies, bodies == 1 ? "body" : "bodies");
  const auto counted = [](const std::map<std::string_view, Index>& numbers) {
    std::vector<std::string> all;
    for (const auto& [word, number] : numbers) all.push_back(fmt::format("{} {}", number, word));
    return fmt::format("{}", fmt::join(all, ", "));
  };
  std::string text = fmt::format("{}: {} {} in this run, {} of {} in all, t = {:.6g} s\n", to_string(outcome.end),
                                 totals.steps, totals.steps == 1 ? "step" : "steps", simulation.state.step,
                                 simulation.dynamics.time.steps, simulation.state.time);
  const StepAlgorithm algorithm = simulation.dynamics.solver.algorithm;
  const bool undivided = is_contact_solver(algorithm) && !decomposes(algorithm);  // the partition is unused
  text += fmt::format("{}s: {} free{}, {} driven; {} contacts, {}\n", shape_of_grains(system.dimension), free,
                      of_bodies, system.grains() - free - in_bodies, totals.last.contacts,
                      undivided ? fmt::format("solved undivided by {}", to_string(algorithm))
                                : fmt::format("interface of {} unknowns", totals.last.interface_size));
  if (totals.steps == 0) return text;
  text += fmt::format("steps: {}\n", counted(totals.statuses));
  if (!totals.verdicts.empty())
    text += fmt::format("verdicts: {}; least margin {:.6g} m/s\n", counted(totals.verdicts), totals.margin);
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
  if (totals.visits > 0 && has_part(algorithm, StepPart::sweeps) && !has_part(algorithm, StepPart::enriched_stage_two))
    text += fmt::format("; {:.3g} ns per contact and sweep", 1e9 * totals.solve_seconds / totals.visits);
  return text + "\n" + warnings(totals, simulation.dynamics);
}

}  // namespace nscdd::app
