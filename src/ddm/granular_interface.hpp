// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/granular_decomposition.hpp"

namespace nscdd {

/// Jumps sum_E A_E V_E of the copies of shared grains, n_Gamma.
Vector interface_jumps(const GranularDecomposition& parts);

/// Sum over the copies of shared grains of |V|^2, rim speed included.
double glued_speed_squared(const GranularDecomposition& parts);

/// X_inf^-1 g, see Interface::solve_generic; the rims have their own inertia.
Vector generic_interface_solve(const GranularDecomposition& parts, const Vector& jumps);

/// V_E <- V_E - M_E^-1 A_E^T change, for a change of F_Gamma.
void apply_interface_impulses(GranularDecomposition& parts, const Vector& change);

}  // namespace nscdd
