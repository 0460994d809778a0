// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"

#include <vector>

/// Steps solved as closely as rounding lets them be, and how well impulses and velocities obey Coulomb's law.
namespace nscdd::testing {

/// A step iterated until impulses obey the law and copies move together (both to 1e-10, 60 000 iterations at
/// the most). Iterations may rest for thousands of sweeps while impulses drift along a direction that the
/// network can carry, until a contact opens: no criterion on changes would do.
struct Close {
  StepProblem<2> problem;
  std::vector<GrainContact<2>> contacts;
  std::vector<GrainVelocity<2>> velocities;
  double gluing = 1, map = 1;  ///< IterationRecord::gluing and the relative natural map at the end
  Index interface_size = 0;
};
Close closely(const Simulation& simulation);

/// |natural map| / |r| of Coulomb's law, contact by contact.
double relative_natural_map(const std::vector<GrainContact<2>>& contacts, const std::vector<GrainVelocity<2>>& v);

}  // namespace nscdd::testing
