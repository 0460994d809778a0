// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/trajectory_step.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>

/// Steps of a trajectory as contact problems for other solvers, and results of solvers.
namespace nscdd {

/// The contact problem of the next step of a simulation, as a global problem of FCLIB (see friction_problem): bodies
/// are its free grains, ascending; contacts ascend by (a, b). `after`: the step with its solution, or null. Throws
/// Error for a law that is neither Coulomb's nor frictionless, and if `after` has other contacts.
FclibFile fclib_of_step(const Simulation& before, const TrajectoryStep* after);

/// The part of subdomain E of this problem: its contacts and their free grains, each ascending, masses split as in the
/// run. The interface impulses of the last iteration are loads:
///     f_E = M_E V_free - A_E^T F,
/// so that Stage 1 of [ADI12] is this problem. The velocities of the solution are those of the copies,
/// M_E^-1 (H_E r + f_E). Throws Error as fclib_of_step, and for a subdomain without contacts, naming those with some.
FclibFile fclib_of_subdomain(const Simulation& before, const TrajectoryStep& after, Index subdomain);

/// The problem in the unknowns of the contacts: W = H^T M^-1 H, q = H^T M^-1 f + w.
FclibFile local_form(FclibFile file);

/// The file with the impulses of a solver and the velocities of the bodies. Converged impulses become its solution.
/// Others become its last guess, for a restart, beside a solution that it has; those that are not finite are left out.
FclibFile with_result(FclibFile file, const FrictionSolution& found);

}  // namespace nscdd
