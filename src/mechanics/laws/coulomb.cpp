// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/laws/coulomb.hpp"

namespace nscdd {
namespace {

constexpr int most_steps = 200;  // bisection alone reaches neighbouring numbers earlier
constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();

}  // namespace

ConeContact::ConeContact(const FullDelassus<3>& w) : inverse_n_(1 / w.nn) {
  const TangentMatrix s = w.schur_complement();
  const double mean = (s.first + s.second) / 2, half = (s.first - s.second) / 2, radius = std::hypot(half, s.mixed);
  const double larger = mean + radius, determinant = s.first * s.second - s.mixed * s.mixed;
  // By rounding, the smaller one may be 0 or negative if the block is nearly singular.
  stiffness_ = {larger, std::max(determinant / larger, std::numeric_limits<double>::epsilon() * larger)};
  if (radius > 0) {
    const double angle = std::atan2(s.mixed, half) / 2;
    cos_ = std::cos(angle);
    sin_ = std::sin(angle);
  }
  coupling_ = rotated(inverse_n_ * w.nt);
}

LocalVector<3> ConeContact::impulse(LocalVector<3> free, double friction) const {
  if (free.n >= 0) return {};
  const LocalVector<3> own{inverse_n_ * free.n, rotated(free.t)};
  const TangentVector b = free.n * coupling_ - own.t;
  const TangentVector rest{b.first / stiffness_.first, b.second / stiffness_.second};
  const double n = -own.n - dot(coupling_, rest);
  const LocalVector<3> r = norm(rest) <= friction * n ? LocalVector<3>{n, rest} : sliding(own, b, friction);
  return {r.n, back(r.t)};
}

// In the principal axes; `free` has free_n / W_nn.
LocalVector<3> ConeContact::sliding(LocalVector<3> free, TangentVector b, double friction) const {
  if (friction == 0) return {-free.n, {}};
  double low = 0, high = infinity, lambda = 0;
  TangentVector t;
  for (int step = 0; step < most_steps; ++step) {
    const TangentVector sum{stiffness_.first + lambda, stiffness_.second + lambda};
    t = {b.first / sum.first, b.second / sum.second};
    const TangentVector slope{-t.first / sum.first, -t.second / sum.second};
    const double size = norm(t), n = -free.n - dot(coupling_, t);
    const double excess = friction * n / size - 1;  // below 0: not slow enough
    if (std::abs(excess) <= rounding || !(size > 0)) break;
    (excess < 0 ? low : high) = lambda;
    const double by_lambda = -friction * (dot(coupling_, slope) + n * dot(t, slope) / (size * size)) / size;
    double next = lambda - excess / by_lambda;
    if (!(next > low && next < high)) next = high == infinity ? 2 * low + stiffness_.first : low + (high - low) / 2;
    if (next == lambda || next <= low || next >= high) break;  // neighbours
    lambda = next;
  }
  // Exactly on the edge of the cone.
  const double size = norm(t), n = std::max(0.0, -free.n - dot(coupling_, t));
  return size > 0 ? LocalVector<3>{n, (friction * n / size) * t} : LocalVector<3>{n, t};
}

}  // namespace nscdd
