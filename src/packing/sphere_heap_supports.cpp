// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/sphere_heap.hpp"

#include <numbers>

namespace nscdd {
namespace {

constexpr double balance_rounding = 1e-14;  // tolerance of the equilibrium conditions, for the rounding of unit vectors
constexpr double most_missed = 1e-9;        // tolerance for nearly dependent normals, if no better set exists

// Velocity for a set of supports, and how far others violate it. False if one does not push, or normals are dependent.
bool try_supports(std::span<const SpacePoint> normals, Carried& carried, double& missed) {
  const auto n = [&](std::size_t i) -> const SpacePoint& { return normals[carried.by[i]]; };
  std::array<double, 3> lambda{};
  SpacePoint v = -SpacePoint::UnitZ();
  if (carried.supports == 1) {
    lambda[0] = n(0).z();
  } else if (carried.supports == 2) {
    const double c = n(0).dot(n(1)), det = n(0).cross(n(1)).squaredNorm();
    if (det < 1e-20) return false;
    lambda[0] = (n(0).z() - c * n(1).z()) / det;
    lambda[1] = (n(1).z() - c * n(0).z()) / det;
  } else if (carried.supports == 3) {
    const double det = n(0).dot(n(1).cross(n(2)));
    if (std::abs(det) < 1e-12) return false;
    for (std::size_t i = 0; i < 3; ++i) lambda[i] = n((i + 1) % 3).cross(n((i + 2) % 3)).z() / det;
  }
  missed = 0;
  for (std::size_t i = 0; i < carried.supports; ++i) {
    if (!(lambda[i] > 0)) return false;
    v += lambda[i] * n(i);
  }
  if (carried.supports == 3) v.setZero();
  for (std::size_t k = 0; k < normals.size(); ++k)
    if (!carried.has(k)) missed = std::max(missed, -normals[k].dot(v));
  carried.velocity = v;
  return true;
}

}  // namespace

Carried carried_by(std::span<const SpacePoint> normals, std::span<const Carried> but) {
  Carried best;
  double least = most_missed;
  const auto attempt = [&](std::initializer_list<std::size_t> set) {
    Carried carried;
    for (const std::size_t k : set) carried.by[carried.supports++] = k;
    const auto same = [&](const Carried& other) {
      return other.supports == carried.supports && other.by == carried.by;
    };
    if (std::ranges::any_of(but, same)) return false;
    double missed = 0;
    if (!try_supports(normals, carried, missed) || missed >= least) return false;
    best = carried;
    least = missed;
    return least <= balance_rounding;
  };
  if (attempt({})) return best;
  const std::size_t n = normals.size();
  for (std::size_t i = 0; i < n; ++i)
    if (attempt({i})) return best;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      if (attempt({i, j})) return best;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j)
      for (std::size_t k = j + 1; k < n; ++k)
        if (attempt({i, j, k})) return best;
  return best;
}

double first_crossing(double q_u, double q_w, double excess) {
  if (!(excess > 0)) return infinity;
  const double a = std::sqrt(q_u * q_u + q_w * q_w);
  const double nearest = std::atan2(q_w, q_u);
  const double before = std::atan2(std::sqrt(std::max(0.0, excess * (2 * a - excess))), a - excess);
  const double entry = nearest - before;
  return nearest > 0 ? std::max(entry, 0.0) : entry + 2 * std::numbers::pi;
}

void touch_exactly(SpacePoint& centre, std::span<const Obstacle> obstacles, double radius) {
  for (int pass = 0; pass < 2; ++pass) {
    SpacePoint step = SpacePoint::Zero();
    std::array<SpacePoint, 3> basis;
    std::size_t found = 0;
    for (const Obstacle& one : obstacles.first(std::min<std::size_t>(3, obstacles.size()))) {
      const SpacePoint n = one.normal(centre);
      SpacePoint e = n;
      for (std::size_t i = 0; i < found; ++i) e -= e.dot(basis[i]) * basis[i];
      if (e.norm() < crest) continue;
      e.normalize();
      step += e * ((-one.gap(centre) - n.dot(step)) / n.dot(e));
      basis[found++] = e;
    }
    if (!(step.norm() < 1e-6 * radius)) return;
    centre += step;
  }
}

}  // namespace nscdd
