// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/gauss_seidel.hpp"
#include "two_stage/granular_two_stage.hpp"
#include <nscdd/contact_solvers/verdict.hpp>
#include <nscdd/core/table.hpp>

namespace nscdd {

/// How the iterations of a step ended.
enum class SolverStatus {
  converged,        ///< the criterion fell to its tolerance
  stalled,          ///< the criterion did not fall over the last 10 000 iterations, nor over four fifths of all
  maximum_reached,  ///< as many iterations as allowed were made
  diverged,         ///< impulses grew to a million times their first size, or energy to ten times that available
  no_number,        ///< an impulse or velocity is not finite
  given_up,         ///< by IterationSink::goes_on: such a step is not taken
  impossible,       ///< the verdict proves that there is no solution
};
constexpr auto names_of(SolverStatus) {
  return std::to_array<std::string_view>(
      {"converged", "stalled", "maximum_reached", "diverged", "no_number", "given_up", "impossible"});
}

/// One iteration with all its indicators.
struct IterationRow {
  Index step = 0;  ///< from 1
  IterationRecord record;
  ContactResidual residual = {};
  Index status_changes = 0;  ///< contacts whose status (open, stick, slide) differs from the row before
  Index factorisations = 0, interface_iterations = 0;  ///< of contact solvers so far, as in StepReport
  double seconds = 0;                                  ///< of the iterations of the step so far, without the indicators
};
const ResultColumns<IterationRow>& iteration_columns();  ///< of `nscdd simulate --convergence`

/// Whether an iteration is the first one in its interval when every decade of log10(iteration) is cut into `per_decade`
/// equal intervals: all iterations at first, ever fewer later.
bool begins_interval(Index iteration, Index per_decade);

/// Observer of the iterations of a step, equal on all ranks. The indicators of one iteration cost several sweeps:
/// observing each multiplies the time of a run.
struct IterationSink {
  std::function<void(const IterationRow&)> row;  ///< called with the rows observed; may be empty
  Index every = 1;  ///< one iteration in so many is observed; 0: about ten per decade. The last always is
  /// Called after every iteration, or check of a contact solver; may be empty. False gives the step up.
  std::function<bool()> goes_on = {};

  bool observes(Index iteration) const;
};

/// A contact of a chain that jams, see Verdict::chain.
struct ChainContact {
  Index step = 0;  ///< from 1
  StepContact geometry = {};
  double stress = 0;  ///< of the self-stress, whose largest entry is 1
};

/// Results of a solved step: a row of the table of steps.
struct StepReport {
  Index step = 0;   ///< from 1
  double time = 0;  ///< at its end, s
  SolverStatus status = SolverStatus::converged;
  IterationRecord last = {};
  ContactResidual residual = {};
  Index contacts = 0;  ///< contacts considered
  Index interface_size = 0;
  Index most_copies = 1;  ///< q, of a body
  Interpenetration overlap = {};
  StepEnergy energy = {};
  double eta = not_a_number;       ///< of the enriched algorithm, 1/kg
  double scale = 0;                ///< W of the contacts considered, 1/kg
  Index factorisations = 0;        ///< by contact solvers; a matrix cut into subdomains counts once
  Index interface_systems = 0;     ///< solved by the two-stage Newton method; a refinement counts as one
  Index interface_iterations = 0;  ///< of Stage 2 in all of them
  double mean_speed = 0;           ///< sqrt(2 kinetic energy / mass of what is free), m/s
  double setup_seconds = 0, solve_seconds = 0;

  bool no_room = false;   ///< contacts keep closing although impulses grew, see no_room in solved_step.cpp
  bool doubtful = false;  ///< converged relative to impulses that are not credible, see FrictionSolution
  std::optional<VerdictKind> verdict = {};  ///< none: it was not asked for, see VerdictSteps
  double margin = not_a_number;             ///< of the verdict, m/s
  double closing_speed = not_a_number;      ///< at which driven bodies work against the chain, m/s; nan without one
  std::vector<ChainContact> chain = {};     ///< if there is no solution
  /// |natural map| over ImpulseScale::driving, which does not fall as impulses grow.
  double driven_residual() const;

  bool broke_down() const { return status == SolverStatus::diverged || status == SolverStatus::no_number; }
};
const ResultColumns<StepReport>& step_columns();  ///< of the group `summary` of a trajectory

/// Decides when the iterations of a step end.
class IterationWatch {
 public:
  explicit IterationWatch(const StepSolver& solver);
  /// Whether it judges this iteration, from 1: every criterion_interval-th, and the last one allowed.
  bool judges(Index iteration) const {
    return iteration % solver_.criterion_interval == 0 || iteration >= solver_.maximum_iterations;
  }
  bool needs_residual() const;  ///< of the contact law, for its criterion
  bool needs_normal_change() const { return solver_.criterion == Criterion::normal_change; }  ///< of the record
  /// How the iterations ended, or nothing if they go on. `residual` is used only if needed.
  std::optional<SolverStatus> judge(const IterationRecord& record, const ContactResidual& residual);

 private:
  StepSolver solver_;
  ProgressWatch<SolverStatus> watch_;
  double first_impulses_ = 0;  // squared, the largest of the first ten judged
  Index judged_ = 0;
};

/// Counts the contacts whose status differs from that in `statuses` (unknown ones: open), which become `now`.
Index changes_of(std::vector<ContactStatus>& statuses, std::vector<ContactStatus> now);

}  // namespace nscdd
