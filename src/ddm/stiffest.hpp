// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

/// An upper bound of the eigenvalues of all M_E^-1 K_E, 1/kg: with A = M_E^-1/2 H_E,
/// ||A^T A||_2 <= || |A|^T |A| ||_infinity. 0 without contacts.
double stiffest(const Decomposition& parts);

/// An upper bound of g^T X_eta^-1 g, eta > 0, without a solve with X_eta: with L = stiffest, M_E + K_E / eta is at most
/// 1 + L / eta times M_E, and so is X_eta^-1 of X_inf^-1.
double inverse_at_most(const InterfaceOperator& x, const Vector& g);

}  // namespace nscdd
