// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>

namespace nscdd {

/// The file with the impulses that a solver found and the velocities of the bodies that belong to them. Impulses that
/// converged become its solution. Others become the last of its guesses, to restart from, and the file has no solution.
/// Impulses that are not finite are left out.
FclibFile with_result(FclibFile file, const FrictionSolution& found);

}  // namespace nscdd
