// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/map_radius.hpp"
#include "ddm/two_stage.hpp"
#include <nscdd/core/types.hpp>

namespace nscdd {

/// J_n, the map of one two-stage iteration with n Gauss-Seidel sweeps in Stage 1, on the state z = (r, F).
/// For the generic algorithm its nonzero spectrum is that of
///     T^n + (I - T^n) W_eps^-1 Ahat^T X^-1 Ahat,   T = -(D + L)^-1 L^T,   W_eps = D + L + L^T
/// and tends to that of B as n grows. J_n is not symmetric, and its eigenvalues may be complex.
struct InexactIteration {
  TwoStageIteration iteration;

  Index rows() const { return iteration.contacts() + iteration.interface_size(); }
  Index cols() const { return rows(); }
  Vector apply(const Vector& z) const;  ///< one iteration of the algorithm without loads
};

/// The radius of J_n; in the rigid limit unit eigenvalues are counted.
MapRadius inexact_radius(const InexactIteration& j, const SpectralOptions& options = {});

}  // namespace nscdd
