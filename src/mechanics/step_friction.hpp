// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/disk_contacts.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

#include <span>

namespace nscdd {

/// The contact problem of a step in the unknowns (v_x, v_y, spin) of its free bodies, three rows each in
/// their order, as other programs have it:
///     M = diag(m, m, m R^2 / 2),   f = M V_free,   M v = H r + f,   u = H^T v + w.
/// The law acts on u. So w holds its biases (gap / h, restitution) and the velocities of driven bodies, which
/// have no rows. In the rows of spin a tangential column has the lever arm, -R.
/// `bodies`: V_free and inverse masses. `radius`: of each body, m; it may end before the driven bodies at the
/// end (walls have no radius).
GlobalFrictionProblem friction_problem(std::span<const DiskVelocity> bodies, std::span<const DiskContact> contacts,
                                       std::span<const double> radius);

}  // namespace nscdd
