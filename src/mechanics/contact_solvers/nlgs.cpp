// SPDX-License-Identifier: GPL-3.0-or-later
// Nonlinear Gauss-Seidel (Jean and Moreau) on W.
#include "linalg/threads.hpp"
#include "mechanics/contact_solvers/sweep_rows.hpp"
#include "mechanics/gauss_seidel.hpp"

namespace nscdd {
namespace {

constexpr double progress_wanted = 0.99;  // of the smallest residual, within `patience` checks
constexpr double growth_allowed = 1e12;
constexpr double straight = 0.25;         // part of the length of a way that its ends are apart ...
constexpr double above_rounding = 1e-12;  // ... and over the impulses themselves, where it leads somewhere

// The way of the impulses since the residual made progress. Where a soft mode drifts the residual may stand still for
// long, but the way is straight. Where statuses cycle or nothing but rounding is left it comes back.
class Way {
 public:
  void begin(const Vector& impulses) {
    first_ = last_ = impulses;
    length_ = 0;
  }
  void go(const Vector& impulses) {
    length_ += (impulses - last_).norm();
    last_ = impulses;
  }
  bool leads_on() const {
    const double gone = (last_ - first_).norm();
    return gone > straight * length_ && gone > above_rounding * last_.norm();
  }

 private:
  Vector first_, last_;
  double length_ = 0;
};

}  // namespace

bool sweep(SolverRun& run, Index most) {
  const FrictionSolverOptions& options = run.options;
  const SweepRows rows = sweep_rows(run.problem, options.order, options.seed);
  const OneBlasThread serial_blas;  // for all sweeps: that of each is then cheap
  Vector impulses = rows.in_order(run.now.impulses);
  const double scale = std::max(run.judged.alone, impulses.norm());
  const Index end = run.now.sweeps + most;
  ProgressWatch<FrictionStatus> watch({.tolerance = -1,  // `judge` says what has converged
                                       .growth = growth_allowed,
                                       .fall = progress_wanted,
                                       .patience = options.patience,
                                       .longer = 1},
                                      FrictionStatus::not_finite);
  Way way;
  way.begin(impulses);
  for (Index check = 0;; ++check) {
    if (run.judge(rows.by_contact(impulses))) return true;
    way.go(impulses);
    const auto over = watch.judge(check, run.now.state.residual, impulses.norm(), scale);
    if (over == FrictionStatus::stalled && way.leads_on()) {
      watch.take_for_progress(check);
    } else if (over) {
      run.now.status = *over;
      return true;
    }
    if (watch.last_progress() == check) way.begin(impulses);
    if (run.now.sweeps >= end) return false;
    const Index many = std::min(options.check_every, end - run.now.sweeps);
    for (Index k = 0; k < many; ++k) sweep_once(rows, options.order, options.relaxation, run.now.sweeps + k, impulses);
    run.now.sweeps += many;
    run.now.operations += static_cast<double>(many) * run.product_operations();
  }
}

void nlgs(SolverRun& run) { sweep(run, run.options.maximum_sweeps); }

}  // namespace nscdd
