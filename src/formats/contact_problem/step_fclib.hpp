// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/trajectory_step.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>

/// Steps of a trajectory as contact problems for other solvers, and what solvers found.
namespace nscdd {

/// The contact problem that a simulation solves next, as a global problem of FCLIB (see friction_problem):
/// bodies are its free grains, ascending; contacts as in a trajectory, ascending by (a, b). With the step that
/// was taken from there, its impulses and velocities are the solution. Throws Error for a law that is neither
/// Coulomb's nor frictionless, and for a step `after` with other contacts.
FclibFile fclib_of_step(const Simulation& before, const TrajectoryStep* after);

/// The part of subdomain E of the same: its contacts and their free disks, each ascending, masses split as
/// in the run. The interface impulses of the last iteration are loads:
///     f_E = M_E V_free - A_E^T F,
/// so that Stage 1 of [ADI12] is this problem. The velocities of the solution are those of the copies,
/// M_E^-1 (H_E r + f_E). Throws Error likewise, and for a subdomain without contacts, naming those that have.
FclibFile fclib_of_subdomain(const Simulation& before, const TrajectoryStep& after, Index subdomain);

/// The same problem in the unknowns of the contacts alone: W = H^T M^-1 H, q = H^T M^-1 f + w.
FclibFile local_form(FclibFile file);

/// The file with the impulses that a solver found and the velocities of the bodies that belong to them. Impulses that
/// converged become its solution. Others become the last of its guesses, to restart from, and the file has no solution.
/// Impulses that are not finite are left out.
FclibFile with_result(FclibFile file, const FrictionSolution& found);

}  // namespace nscdd
