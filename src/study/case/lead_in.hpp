// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"
#include "study/case/case.hpp"

namespace nscdd {

/// The solver of the steps before those of a table.
enum class LeadInSolver {
  plain,  ///< plain Gauss-Seidel, warm-started, to zeta <= 1e-6 or 2 000 sweeps
  own,    ///< the solver of the case
};
constexpr auto names_of(LeadInSolver) { return std::to_array<std::string_view>({"plain", "own"}); }

/// Sums and extrema over the steps of a run.
struct RunTotals {
  Index steps = 0, converged = 0;                            ///< all, and those that converged
  Index iterations = 0, most_iterations = 0;                 ///< of all steps, and of one
  double natural_map = 0;                                    ///< the largest of any step, of the velocities kept
  Index worst_step = 0;                                      ///< that step
  double gluing = 0;                                         ///< the largest of any step, at its last iteration
  double overlap = 0, relative_overlap = 0;                  ///< the largest, m, and times the smaller radius
  bool interface = false;                                    ///< in any step
  Index most_copies = 1;                                     ///< of a body, in any step
  double boundary_work = 0, dissipation = 0, numerical = 0;  ///< energies, J
  double gain = 0;                                           ///< energy that contacts added, J
  Index gaining_steps = 0;                                   ///< those in which contacts added energy
  double contact_energy = 0;                                 ///< the sum of r W r, J
  Index no_room = 0, first_no_room = 0;  ///< steps whose boundaries may leave no room; the first one
  Index doubtful = 0;                    ///< steps, see StepReport
  std::map<std::string_view, Index> verdicts;
  double margin = infinity;  ///< the least of any verdict, m/s
  double setup_seconds = 0, solve_seconds = 0;
  double visits = 0;  ///< contacts times sweeps
  std::map<std::string_view, Index> statuses;
  StepReport last;
  void add(const StepReport& report);
};

/// A case after some steps, with its own solver, and the totals of these steps.
struct Arrival {
  Simulation simulation;
  RunTotals totals;
};

/// States of cases after some steps. Each is kept: variants of the solver of a step, and several tables, start from it.
class LeadIn {
 public:
  /// Throws Error as check_dynamics and simulation_of, and if a step breaks down.
  Arrival at(const Case& one, Index steps, LeadInSolver solver = LeadInSolver::plain);

 private:
  std::map<std::string, std::map<Index, Arrival>> known_;  // by the case and the steps done
};

/// The next step after a state, solved by `solver`, but with the partition of the case. A case with plain Gauss-Seidel
/// is partitioned as for the generic algorithm. Throws Error for a system of another dimension than D.
template <int D>
GranularStep<D> next_step(Simulation simulation, LeadInSolver solver);

}  // namespace nscdd
