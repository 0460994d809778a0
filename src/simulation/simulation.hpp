// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/gauss_seidel.hpp"
#include "simulation/step_share.hpp"
#include "two_stage/granular_two_stage.hpp"
#include <nscdd/core/table.hpp>

namespace nscdd {

/// How the iterations of a step ended.
enum class SolverStatus {
  converged,        ///< the criterion fell to its tolerance
  stalled,          ///< the criterion did not fall over the last 10 000 iterations, nor over four fifths of all
  maximum_reached,  ///< as many iterations as allowed were made
  diverged,         ///< impulses grew to a million times their first size, or energy far beyond what there was
  no_number,        ///< an impulse or velocity is not finite
  given_up,         ///< IterationSink::goes_on said so: such a step is not taken
};
constexpr auto names_of(SolverStatus) {
  return std::to_array<std::string_view>(
      {"converged", "stalled", "maximum_reached", "diverged", "no_number", "given_up"});
}

/// Whether a criterion of StepSolver needs the residual of the contact law at every iteration.
bool needs_residual(Criterion criterion);

/// Decides when the iterations of a step end.
class IterationWatch {
 public:
  explicit IterationWatch(const StepSolver& solver);
  /// Whether it is to judge this iteration, from 1: every criterion_interval-th, and the last one allowed.
  bool looks_at(Index iteration) const;
  /// How the iterations ended, or nothing if they go on. `residual` counts only if the criterion needs it.
  std::optional<SolverStatus> judge(const IterationRecord& record, const ContactResidual& residual);

 private:
  StepSolver solver_;
  ProgressWatch<SolverStatus> watch_;
  double first_impulses_ = 0;  // squared, the largest of the first ten looks
  Index looks_ = 0;
};

/// How many contacts have another status than in `statuses`, which become `now`. Unknown ones count as open.
Index changes_of(std::vector<ContactStatus>& statuses, std::vector<ContactStatus> now);

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

/// Whether an iteration is the first one in its interval when every decade is cut into `per_decade` intervals
/// of equal length on the axis log10(iteration): all iterations at first, ever fewer later.
bool begins_interval(Index iteration, Index per_decade);

/// Who looks at the iterations of a step; of several processes all ask for the same rows and go on together. The
/// indicators of one cost several sweeps, which multiplies the time of a run.
struct IterationSink {
  std::function<void(const IterationRow&)> row;  ///< may be empty: nobody looks
  Index every = 1;  ///< looks at one iteration in so many; 0: about ten per decade. The last is always looked at
  /// Asked after every iteration, or check of a contact solver; may be empty. Where it returns false the step is given
  /// up.
  std::function<bool()> goes_on = {};

  bool looks_at(Index iteration) const;
};

/// What is known of a step once it is solved: a row of the table of steps.
struct StepReport {
  Index step = 0;   ///< from 1
  double time = 0;  ///< at its end, s
  SolverStatus status = SolverStatus::converged;
  IterationRecord last = {};
  ContactResidual residual = {};
  Index contacts = 0;  ///< contacts considered
  Index interface_size = 0;
  Interpenetration overlap = {};
  StepEnergy energy = {};
  double eta = not_a_number;       ///< of the enriched algorithm, 1/kg
  double scale = 0;                ///< W of the contacts considered, 1/kg
  Index factorisations = 0;        ///< of matrices of contact solvers; one that is cut counts once
  Index interface_systems = 0;     ///< solved by the two-stage Newton method; a refinement counts as one
  Index interface_iterations = 0;  ///< of Stage 2 in all of them
  double setup_seconds = 0, solve_seconds = 0;

  bool no_room = false;   ///< impulses grew and contacts close nevertheless, see `no_room`
  bool doubtful = false;  ///< converged relative to impulses that are not credible, see FrictionSolution
  /// |natural map| over ImpulseScale::driving, which does not fall as impulses grow.
  double driven_residual() const;

  bool broke_down() const { return status == SolverStatus::diverged || status == SolverStatus::no_number; }
};
const ResultColumns<StepReport>& step_columns();  ///< of the group `summary` of a trajectory

/// A step that is prepared, decomposed and solved, but not yet taken. Of several processes that share it each has its
/// share: problem, partition, contacts and velocities.
template <int D>
struct SolvedStep {
  StepProblem<D> problem;
  Partition partition;                       ///< of its contacts
  ShareOfStep share;                         ///< empty where this process has all of the step
  std::vector<GrainContact<D>> contacts;     ///< with their impulses
  std::vector<GrainVelocity<D>> velocities;  ///< of the bodies of the problem
  std::vector<GrainUnknowns<D>> all_grains;  ///< velocities of all grains
  ContactWork work;                          ///< of all contacts
  std::vector<Index> shared_grains;          ///< those that several subdomains hold, ascending
  std::vector<RememberedGluing> gluing;
  std::vector<RememberedModel> models;
  Vector interface_impulses;
  bool energy_exploded = false;  ///< it ends with far more energy than loads, boundaries and pushes can bring
  StepReport report;
};

/// The next step of a simulation, or the share that this process has of it, cut into subdomains. Throws Error as
/// prepare_step does, naming both bodies if two overlap by more than `largest_overlap`, and for a system of another
/// dimension than D.
template <int D>
struct DividedStep {
  StepProblem<D> problem;
  Partition partition;  ///< of its contacts
  ShareOfStep share;    ///< empty where this process has all of the step
  StepReport report;    ///< what is known by now
  GranularDecomposition<D> parts;
};
template <int D>
DividedStep<D> divide_step(const Simulation& simulation);

/// The same ready to be iterated by Algorithm 1.
template <int D>
struct PreparedStep {
  StepProblem<D> problem;
  Partition partition;                        ///< of its contacts
  ShareOfStep share;                          ///< empty where this process has all of the step
  std::optional<InterfaceOperator> enriched;  ///< X_eta of the enriched algorithm
  StepReport report;                          ///< what is known by now
  GranularTwoStage<D> iteration;
};
template <int D = 2>
PreparedStep<D> prepare_solution(const Simulation& simulation);

/// Throws Error as prepare_solution does, at less cost: for the first step of a run, before anything is written.
void check_next_step(const Simulation& simulation);

/// Prepares and solves the next step without taking it. The iterations that `sink` looks at go to it. Throws Error for
/// a system of another dimension than D.
template <int D = 2>
SolvedStep<D> solve_step(const Simulation& simulation, const IterationSink& sink = {});

/// How the next step of a simulation of either dimension is solved, without taking it.
StepReport solved_report(const Simulation& simulation, const IterationSink& sink = {});

/// Takes a solved step, which moves the state on. Throws Error, and takes nothing, if bodies would pass each other
/// between the contacts and the end of the step, see check_end_of_step.
template <int D>
StepReport take_step(Simulation& simulation, const SolvedStep<D>& step);

/// A solved step of a simulation whose dimension is known when it runs.
using AnySolvedStep = std::variant<SolvedStep<2>, SolvedStep<3>>;

/// Where a solver broke down, by names and places: the first contact whose impulse is not finite, otherwise the first
/// disk with such a velocity, otherwise the contact with the largest impulse. `before`: what the step was solved from.
template <int D>
std::string describe_breakdown(const Simulation& before, const SolvedStep<D>& step);

/// Why a run of a simulation ended.
enum class RunEnd {
  completed,   ///< TimeStepping::steps are done
  at_rest,     ///< mean_speed was below TimeStepping::rest_speed for `rest_steps` steps, without always rising
  stopped,     ///< the monitor asked for it, or a step was given up (IterationSink::goes_on)
  broke_down,  ///< a step could not be prepared (see prepare_solution), diverged, or gave values not finite
};
constexpr auto names_of(RunEnd) {
  return std::to_array<std::string_view>({"completed", "at rest", "stopped", "broke down"});
}

/// So many steps in a row grains must be slow to count as at rest: a turning point of their motion is not rest.
inline constexpr Index rest_steps = 10;

struct RunOutcome {
  RunEnd end = RunEnd::completed;
  std::string reason = {};  ///< of a breakdown: the step, and the grain or contact
};

/// What may follow a run; each may be empty.
struct RunSinks {
  IterationSink iteration;
  /// After each step taken, with the simulation behind it and the step as it was solved.
  std::function<void(const Simulation& after, const AnySolvedStep& solved, const StepReport& report)> step;
  Monitor monitor;  ///< after each step, of steps done and asked for
};

/// Takes steps until TimeStepping::steps are done, the grains rest, the monitor asks to stop or a step breaks down. In
/// the end the simulation is as the last good step left it. `speeds`: mean_speed after each step of the run that this
/// one goes on with. Throws Error if the very first step cannot be prepared, because that is bad input.
RunOutcome run_simulation(Simulation& simulation, const RunSinks& sinks, std::vector<double> speeds = {});

/// Root mean square velocity of the free grains, m/s: sqrt(2 E / m), their kinetic energy E with spin, their mass m.
double mean_speed(const GranularSystem& system, double kinetic_energy);

}  // namespace nscdd
