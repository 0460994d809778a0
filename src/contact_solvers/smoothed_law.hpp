// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_law.hpp"

#include <Eigen/Core>

namespace nscdd {

/// P_t(z) of a contact, the smoothed law of continuation.hpp, and its derivatives by z, and by t.
template <int D>
struct SmoothedLaw {
  using Block = Eigen::Matrix<double, D, D>;
  LocalVector<D> impulse;
  Block by_z, rest;  ///< rest: 1 - P', regular in spite of rounding
  Eigen::Matrix<double, D, 1> by_t;
};

SmoothedLaw<2> smoothed_law(LocalVector<2> z, double friction, double t);
SmoothedLaw<3> smoothed_law(LocalVector<3> z, double friction, double t);

}  // namespace nscdd
