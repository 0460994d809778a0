// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd::app {

/// Steps first, first + stride, ... up to last; last = -1: no end.
struct StepRange {
  Index first = 0, last = -1, stride = 1;
  bool holds(Index step) const { return step >= first && (last < 0 || step <= last) && (step - first) % stride == 0; }
};

/// "A", "A:B" or "A:B:K" of --steps; all steps for an empty text. Throws Error for another text.
StepRange parse_step_range(const std::string& text);

/// Ascending numbers as ranges: "0:100:10, 105".
std::string step_ranges_text(const std::vector<Index>& steps);

/// The steps in a range that a trajectory keeps. If there is none, throws Error with those it keeps.
std::vector<Index> chosen_steps(const std::string& trajectory, const StepRange& range);

/// Exports of the steps of a trajectory; one of the three names is not empty.
struct StepsOptions {
  std::string vtk, vtkhdf, lmgc90;
  std::string range;  ///< of steps, see parse_step_range
};

int export_steps(const StepsOptions& options, const std::string& trajectory, bool force);

}  // namespace nscdd::app
