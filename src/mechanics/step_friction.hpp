// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/disk_contacts.hpp>
#include <nscdd/mechanics/friction_problem.hpp>

#include <span>

namespace nscdd {

/// The contact problem of a step in the unknowns (v_x, v_y, spin) of its free bodies, three rows each in
/// their order, as other programs have it:
///     M = diag(m, m, m R^2 / 2),   f = M V_free,   M v = H r + f,   u = H^T v + w.
/// u is what the law sees, biases (gap / h, restitution) included: they are in w, with the velocities of
/// driven bodies, which have no rows. The rows of spin have the lever arm, -R in the tangential column.
/// `bodies`: V_free and inverse masses; `radius`: of each, m, those of driven bodies at the end may be
/// missing (walls have none).
GlobalFrictionProblem friction_problem(std::span<const DiskVelocity> bodies,
                                       std::span<const DiskContact> contacts, std::span<const double> radius);

}  // namespace nscdd
