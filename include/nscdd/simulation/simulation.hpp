// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/ddm/granular_two_stage.hpp>
#include <nscdd/simulation/dynamics.hpp>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd {

/// How the iterations of a step ended.
enum class SolverStatus {
  converged,        ///< the criterion fell to its tolerance
  stalled,          ///< no fall of the criterion for 10 000 iterations and four fifths of all
  maximum_reached,  ///< as many iterations as allowed
  diverged,   ///< impulses grew a million times beyond their first size, or energy beyond what there was
  no_number,  ///< an impulse or velocity is no number
};
constexpr auto names_of(SolverStatus) {
  return std::to_array<std::string_view>(
      {"converged", "stalled", "maximum_reached", "diverged", "no_number"});
}

/// One iteration with all its indicators: a row of `--convergence`.
struct IterationRow {
  Index step = 0;  ///< from 1
  IterationRecord record;
  ContactResidual residual;
  Index status_changes = 0;  ///< contacts whose status (open, stick, slide) differs from the iteration before
  double seconds = 0;        ///< of the iterations of the step so far, without the indicators
};
using IterationSink = std::function<void(const IterationRow&)>;

/// What a step left: a row of the table of steps.
struct StepReport {
  Index step = 0;   ///< from 1
  double time = 0;  ///< at its end, s
  SolverStatus status = SolverStatus::converged;
  IterationRecord last;
  ContactResidual residual;
  Index contacts = 0;  ///< contacts considered
  Index interface_size = 0;
  Interpenetration overlap;
  StepEnergy energy;
  double eta = not_a_number;  ///< of the enriched algorithm, 1/kg
  double setup_seconds = 0, solve_seconds = 0;
};

/// A step prepared, decomposed and solved, not yet taken.
struct SolvedStep {
  StepProblem problem;
  Partition partition;                ///< of its contacts
  std::vector<DiskContact> contacts;  ///< with their impulses
  std::vector<DiskVelocity> velocities;
  std::vector<RememberedGluing> gluing;
  Vector interface_impulses;
  StepReport report;
};

/// Whether a criterion of StepSolver looks at the residual of the contact law.
bool needs_residual(Criterion criterion);

/// Decides when the iterations of a step end.
class IterationWatch {
 public:
  explicit IterationWatch(const StepSolver& solver);
  /// Status at the end, none to go on. `residual` is looked at where the criterion needs it.
  std::optional<SolverStatus> judge(const IterationRecord& record, const ContactResidual& residual);

 private:
  StepSolver solver_;
  double best_ = infinity, first_impulses_ = 0;
  Index best_iteration_ = 0;
};

/// The next step of a simulation, ready to be iterated. Throws Error as prepare_step, and naming both bodies
/// where two overlap by more than `largest_overlap`.
struct PreparedStep {
  StepProblem problem;
  Partition partition;                        ///< of its contacts
  std::optional<InterfaceOperator> enriched;  ///< X_eta of the enriched algorithm
  double eta = not_a_number;                  ///< its flexibility, 1/kg
  GranularTwoStage iteration;
};
PreparedStep prepare_solution(const Simulation& simulation);

/// Prepares and solves the next step from the state without taking it. Each iteration goes to `sink` where
/// there is one (indicators cost about a sweep each).
SolvedStep solve_step(const Simulation& simulation, const IterationSink& sink = {});

/// Takes a solved step: moves the state on.
StepReport take_step(Simulation& simulation, SolvedStep step);

/// Where a solver broke down, by the names and places of bodies: the first contact, then the first disk, with
/// a value that is no number or, where all are, the contact of the largest impulse. `before`: the simulation
/// that the step was solved from.
std::string describe_breakdown(const Simulation& before, const SolvedStep& step);

}  // namespace nscdd
