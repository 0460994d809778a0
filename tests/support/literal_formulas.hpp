// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dense.hpp"
#include <nscdd/core/types.hpp>
#include <nscdd/ddm/decomposition.hpp>

#include <vector>

namespace nscdd::testing {

/// The matrices of [ADI12] as printed (slips corrected), dense, with explicit inverses: nothing here is
/// shared with the operators under test but M_E, H_E and A_E.
struct LiteralFormulas {
  explicit LiteralFormulas(const Decomposition& parts);

  Dense x() const;                                                 ///< X = sum A M^-1 A^T, below (7)
  Dense y(double epsilon) const;                                   ///< Y_eps (11); pseudo-inverse of W for epsilon = 0
  Dense x_eta(double eta) const;                                   ///< X_eta (21), (23), (24)
  Dense y(double epsilon, double eta) const;                       ///< Y_eps,eta (22)
  Dense y_bar(const std::vector<char>& active) const;              ///< Y-bar (31)
  Dense y_bar(const std::vector<char>& active, double eta) const;  ///< Y-bar_eta (35), (36)

  Decomposition parts;
};

/// X^-1 Y, its eigenvalues by a nonsymmetric dense solver: real and imaginary parts.
Eigen::VectorXcd contraction_eigenvalues(const Dense& x, const Dense& y);

}  // namespace nscdd::testing
