// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_law.hpp"

#include <cmath>

namespace nscdd {

ContactStatus contact_status(LocalVector impulse, double friction, double tolerance) {
  if (impulse.n <= 0) return ContactStatus::open;
  const double edge = friction * impulse.n;
  if (std::abs(impulse.t) < edge * (1 - tolerance)) return ContactStatus::stick;
  return impulse.t > 0 ? ContactStatus::slide_backward : ContactStatus::slide_forward;
}

LocalVector project_on_cone(LocalVector impulse, double friction) {
  const double size = std::abs(impulse.t);
  if (friction * size <= -impulse.n) return {};      // inside the polar cone; first, for friction 0
  if (size <= friction * impulse.n) return impulse;  // inside
  const double n = (impulse.n + friction * size) / (1 + friction * friction);  // on the edge (1, friction)
  return {n, std::copysign(friction * n, impulse.t)};
}

LocalVector natural_map(LocalVector impulse, LocalVector velocity, double friction, double rho) {
  const LocalVector moved{impulse.n - rho * (velocity.n + friction * std::abs(velocity.t)),
                          impulse.t - rho * velocity.t};
  return impulse - project_on_cone(moved, friction);
}

}  // namespace nscdd
