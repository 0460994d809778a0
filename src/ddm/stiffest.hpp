// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/decomposition.hpp>

namespace nscdd {

/// An upper bound of the eigenvalues of all M_E^-1 K_E, 1/kg: with A = M_E^-1/2 H_E,
/// ||A^T A||_2 <= || |A|^T |A| ||_infinity. 0 without contacts.
double stiffest(const Decomposition& parts);

}  // namespace nscdd
