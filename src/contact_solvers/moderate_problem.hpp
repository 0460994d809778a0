// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// Throws Error unless squares of velocities and impulses neither overflow nor vanish: then no impulse at all has a
/// residual of 0.
void require_moderate(const LocalFrictionProblem& problem, const std::string& name);

}  // namespace nscdd
