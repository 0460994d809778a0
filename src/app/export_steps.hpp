// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace nscdd::app {

/// What of a trajectory is exported step by step: one of the three names is given.
struct StepsOptions {
  std::string vtk, vtkhdf, lmgc90;
  std::string range;  ///< "A", "A:B" or "A:B:K"; all steps where it is empty
};

int export_steps(const StepsOptions& options, const std::string& trajectory, bool force);

}  // namespace nscdd::app
