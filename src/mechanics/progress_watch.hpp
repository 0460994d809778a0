// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace nscdd {

/// When an iteration ends.
struct ProgressLimits {
  double tolerance = 0;      ///< of the indicator
  double growth = infinity;  ///< of the size of the solution over its scale
  double fall = 1;           ///< an indicator makes progress if it is below this part of the smallest so far
  Index patience = 1;        ///< the iteration stalls after so many steps without progress ...
  Index longer = 0;          ///< ... and so many times as many as it took to get there
};

/// Watches an iteration by an indicator that is to fall to a tolerance and by the size of its solution.
/// Status: an enumeration that has at least converged, stalled and diverged.
template <class Status>
class ProgressWatch {
 public:
  /// `not_finite`: the status of an indicator that is not a number or a size that is not finite.
  ProgressWatch(const ProgressLimits& limits, Status not_finite) : limits_(limits), not_finite_(not_finite) {}

  /// How the iteration ended, or nothing if it goes on. `may_converge`: whether a small indicator is enough.
  std::optional<Status> judge(Index step, double indicator, double size, double scale, bool may_converge = true) {
    if (std::isnan(indicator) || !std::isfinite(size)) return not_finite_;
    if (size > limits_.growth * scale) return Status::diverged;
    if (indicator <= limits_.tolerance && may_converge) return Status::converged;
    if (indicator < limits_.fall * smallest_) {
      smallest_ = indicator;
      last_progress_ = step;
    }
    const Index waited = step - last_progress_;
    const bool stalled = waited >= std::max(limits_.patience, limits_.longer * last_progress_);
    return stalled && indicator < infinity ? std::optional(Status::stalled) : std::nullopt;
  }

 private:
  ProgressLimits limits_;
  Status not_finite_;
  double smallest_ = infinity;
  Index last_progress_ = 0;
};

}  // namespace nscdd
