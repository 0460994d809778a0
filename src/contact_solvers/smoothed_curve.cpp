// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/smoothed_curve.hpp"

namespace nscdd {

constexpr double least_rest = 1e-14;

SmoothedLaw<2> smoothed_law(LocalVector<2> z, double friction, double t) {
  const auto length = [&](double x) { return std::sqrt(x * x + 4 * t); };
  const double h = length(z.n);
  SmoothedLaw<2> law;
  law.impulse.n = z.n > 0 ? (z.n + h) / 2 : 2 * t / (h - z.n);
  const double edge = friction * law.impulse.n, n = law.impulse.n / h;
  const double forward = length(z.t + edge), backward = length(z.t - edge);
  law.impulse.t = 2 * z.t * edge / (forward + backward);
  const double f = (z.t + edge) / forward, b = (z.t - edge) / backward;
  law.by_z << n, 0, friction * n * (f + b) / 2, (f - b) / 2;
  law.by_t << 1 / h, 1 / forward - 1 / backward + friction * (f + b) / (2 * h);
  law.rest = Eigen::Matrix2d::Identity() - law.by_z;
  law.rest.diagonal() = law.rest.diagonal().cwiseMax(least_rest);
  return law;
}

// As in the plane along d = z_t / |z_t|; across it the derivative is |r_t| / |z_t|.
SmoothedLaw<3> smoothed_law(LocalVector<3> z, double friction, double t) {
  const double size = norm(z.t);
  const SmoothedLaw<2> along = smoothed_law(LocalVector<2>{z.n, size}, friction, t);
  const auto length = [&](double x) { return std::sqrt(x * x + 4 * t); };
  const double edge = friction * along.impulse.n;
  const double across = 2 * edge / (length(size + edge) + length(size - edge));
  const Eigen::Vector2d d = size > 0 ? Eigen::Vector2d(z.t.first / size, z.t.second / size) : Eigen::Vector2d(1, 0);
  const auto turned = [&](double in_direction, double beside) -> Eigen::Matrix2d {
    return beside * Eigen::Matrix2d::Identity() + (in_direction - beside) * d * d.transpose();
  };
  SmoothedLaw<3> law;
  law.impulse = {along.impulse.n, across * z.t};
  law.by_z << along.by_z(0, 0), 0, 0, along.by_z(1, 0) * d, turned(along.by_z(1, 1), across);
  law.by_t << along.by_t[0], along.by_t[1] * d;
  law.rest << along.rest(0, 0), 0, 0, along.rest(1, 0) * d, turned(along.rest(1, 1), std::max(1 - across, least_rest));
  return law;
}

}  // namespace nscdd
