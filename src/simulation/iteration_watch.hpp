// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/gauss_seidel.hpp"
#include "simulation/step_report.hpp"

namespace nscdd {

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

}  // namespace nscdd
