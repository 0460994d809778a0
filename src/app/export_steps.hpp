// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd::app {

/// Ascending numbers as ranges: "0:100:10, 105".
std::string step_ranges_text(const std::vector<Index>& steps);

/// The steps that a trajectory keeps in the range "A", "A:B" or "A:B:K" of --steps; all of them for an empty text.
/// Throws Error for another text, and if the range has none of the steps.
std::vector<Index> chosen_steps(const std::string& trajectory, const std::string& range);

/// Exports of the steps of a trajectory; one of the three names is not empty.
struct StepsOptions {
  std::string vtk, vtkhdf, lmgc90;
  std::string range;  ///< of steps, see chosen_steps
};

int export_steps(const StepsOptions& options, const std::string& trajectory, bool force);

}  // namespace nscdd::app
