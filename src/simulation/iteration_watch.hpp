// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/progress_watch.hpp"
#include "simulation/simulation.hpp"

#include <optional>

namespace nscdd {

/// Whether a criterion of StepSolver needs the residual of the contact law at every iteration.
bool needs_residual(Criterion criterion);

/// Decides when the iterations of a step end.
class IterationWatch {
 public:
  explicit IterationWatch(const StepSolver& solver);
  /// How the iterations ended, or nothing if they go on. `residual` counts only if the criterion needs it.
  std::optional<SolverStatus> judge(const IterationRecord& record, const ContactResidual& residual);

 private:
  StepSolver solver_;
  ProgressWatch<SolverStatus> watch_;
  double first_impulses_ = 0;  // squared, the largest of the first ten iterations
};

}  // namespace nscdd
