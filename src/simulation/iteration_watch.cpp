// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/iteration_watch.hpp"

namespace nscdd {
namespace {

// Rounding or cycling may keep a criterion from falling any further. That is taken for certain after so many
// iterations without progress, and after four times as many as it took to get there: impulses may drift
// within what the network carries for thousands of iterations until a contact opens.
constexpr Index patience = 10000;
constexpr double explosion = 1e6;

// If F did not change (there is no interface, or Stage 2 leaves it alone) or nothing jumps, these two cannot
// tell that the iterations ended, and zeta stands in for them.
double criterion_value(Criterion criterion, const IterationRecord& record, const ContactResidual& residual) {
  const std::array values{record.zeta,
                          record.interface_change == 0 ? record.zeta : record.interface_change,
                          record.gluing == 0 ? record.zeta : record.gluing,
                          residual.relative_natural_map(),
                          residual.quad_dv(),
                          std::abs(residual.mean_dv_over_r()),
                          infinity};  // as many iterations as allowed
  return values[static_cast<std::size_t>(criterion)];
}

}  // namespace

Index changes_of(std::vector<ContactStatus>& statuses, std::vector<ContactStatus> now) {
  statuses.resize(now.size(), ContactStatus::open);
  Index changes = 0;
  for (std::size_t k = 0; k < now.size(); ++k) changes += statuses[k] != now[k];
  statuses = std::move(now);
  return changes;
}

bool needs_residual(Criterion criterion) {
  return criterion == Criterion::natural_map || criterion == Criterion::quad_dv ||
         criterion == Criterion::mean_dv_over_r;
}

IterationWatch::IterationWatch(const StepSolver& solver)
    : solver_(solver),
      watch_({.tolerance = solver.tolerance,
              .growth = explosion * explosion,  // of squares
              .patience = patience,
              .longer = 4},
             SolverStatus::no_number) {}

std::optional<SolverStatus> IterationWatch::judge(const IterationRecord& record, const ContactResidual& residual) {
  const double value = criterion_value(solver_.criterion, record, residual);
  if (++looks_ <= 10) first_impulses_ = std::max(first_impulses_, record.impulses);
  // Contacts may have settled within subdomains while their copies of shared grains still differ.
  const bool glued = record.gluing <= solver_.gluing_tolerance || semi_implicit(solver_);
  const auto status = watch_.judge(record.iteration, std::isfinite(record.gluing) ? value : not_a_number,
                                   record.impulses, first_impulses_, glued);
  const bool goes_on = !status || *status == SolverStatus::stalled;
  return goes_on && record.iteration >= solver_.maximum_iterations ? SolverStatus::maximum_reached : status;
}

bool IterationWatch::looks_at(Index iteration) const {
  return iteration % solver_.criterion_interval == 0 || iteration >= solver_.maximum_iterations;
}

}  // namespace nscdd
