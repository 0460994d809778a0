// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "mechanics/gauss_seidel.hpp"

namespace nscdd {

/// Decides whether iterations still make progress, from their impulses. If a soft mode drifts, the residual may
/// stagnate for long, but the path of the impulses since its last progress is straight. If statuses cycle, or only
/// rounding is left, the path returns.
template <int D>
class StallWatch {
 public:
  explicit StallWatch(const SolverRun<D>& run)
      : sums_(run.data.sums),
        scale_(std::max(run.data.alone, sums_.norm(run.now.impulses))),
        watch_({.tolerance = -1,  // `judge` says what has converged
                .growth = growth_allowed,
                .fall = progress_wanted,
                .patience = run.options.patience,
                .longer = 1},
               FrictionStatus::not_finite),
        first_(run.now.impulses),
        last_(first_) {}

  /// To be called after every judgement that ends nothing. Returns whether the run is over and why it is, as its
  /// status.
  bool ends(SolverRun<D>& run) {
    const Vector& impulses = run.now.impulses;
    length_ += sums_.norm(impulses - last_);
    last_ = impulses;
    const auto over = watch_.judge(check_, run.now.state.residual, sums_.norm(impulses), scale_);
    if (over == FrictionStatus::stalled && leads_on()) {
      watch_.take_for_progress(check_);
    } else if (over) {
      run.now.status = *over;
      return true;
    }
    if (watch_.last_progress() == check_++) {
      first_ = impulses;
      length_ = 0;
    }
    return false;
  }

 private:
  static constexpr double progress_wanted = 0.99;  // of the smallest residual, within `patience` checks
  static constexpr double growth_allowed = 1e12;
  static constexpr double straight = 0.25;         // part of the length of a way that its ends are apart ...
  static constexpr double above_rounding = 1e-12;  // ... and over the impulses themselves, where it leads somewhere

  bool leads_on() const {
    const double gone = sums_.norm(last_ - first_);
    return gone > straight * length_ && gone > above_rounding * sums_.norm(last_);
  }

  const ContactSums& sums_;
  double scale_;
  ProgressWatch<FrictionStatus> watch_;
  Index check_ = 0;
  Vector first_, last_;  // impulses at the last progress and now
  double length_ = 0;    // of the way between
};

}  // namespace nscdd
