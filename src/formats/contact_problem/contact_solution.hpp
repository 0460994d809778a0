// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>

namespace nscdd {

/// The file with what a solver found, and with the velocities of the bodies that belong to it. Impulses that converged
/// are its solution. Others take the place of none: they become the last of its guesses, to go on from, and `file` has
/// no solution then. Impulses that are not finite are left out.
FclibFile with_result(FclibFile file, const FrictionSolution& found);

}  // namespace nscdd
