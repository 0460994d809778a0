// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/sphere_heap.hpp"

#include <numbers>

namespace nscdd {
namespace {

// A drop takes 4 motions on average for equal sizes, and at most 230 for 10^5 grains of sizes 1 : 100.
constexpr Index most_motions = 5000;
constexpr double standstill = 1e-6;  // angle within which an arc has not begun

// Unit tangent part of a direction; zero if it has none.
SpacePoint tangent(const SpacePoint& direction, const SpacePoint& normal) {
  const SpacePoint part = direction - direction.dot(normal) * normal;
  return part.norm() > crest * direction.norm() ? SpacePoint(part.normalized()) : SpacePoint(SpacePoint::Zero());
}

bool among(std::span<const Obstacle> obstacles, Index number) {
  return std::ranges::count(obstacles, number, &Obstacle::number) > 0;
}

}  // namespace

void SphereHeap::add(const Sphere& sphere) {
  cells_.add(sphere.centre, sphere.radius);
  spheres_.push_back(sphere);
}

// Rounding error of coordinates at that height, m.
double SphereHeap::rounding(double height) const {
  return std::numeric_limits<double>::epsilon() * std::max({width_, depth_, height});
}

Obstacle SphereHeap::obstacle(Index number, double radius) const {
  if (number >= 0) {
    const Sphere& sphere = spheres_[at(number)];
    return {.number = number, .plane = false, .at = sphere.centre, .reach = radius + sphere.radius};
  }
  const std::array<std::pair<SpacePoint, double>, 5> planes{{{SpacePoint::UnitZ(), radius},
                                                             {SpacePoint::UnitX(), radius},
                                                             {-SpacePoint::UnitX(), radius - width_},
                                                             {SpacePoint::UnitY(), radius},
                                                             {-SpacePoint::UnitY(), radius - depth_}}};
  const auto& [normal, offset] = planes[at(Obstacle::floor - number)];
  return {.number = number, .plane = true, .at = normal, .reach = offset};
}

void SphereHeap::fall(Traveller& one) {
  ++work_.motions;
  one.left.reset();
  const SpacePoint from = one.centre;
  Index met = Obstacle::floor;
  double height = one.radius;
  for (const BedCells::Level& level : cells_.levels()) {
    const double reach = one.radius + level.largest;
    const SpacePoint low = from.array() - reach, high = from.array() + reach;
    std::size_t top = level.highest(low, high);
    if (std::isfinite(from.z())) top = std::min(top, level.layer_of(from.z()) + 1);
    for (std::size_t layer = top; layer-- > 0;) {
      // A grain in this layer or below stops the sphere no higher than the one found.
      if (height >= static_cast<double>(layer + 1) * level.side + reach) break;
      cells_.visit(level, layer, layer + 1, low, high, [&](Index i) {
        ++work_.candidates;
        const Sphere& sphere = spheres_[at(i)];
        if (sphere.centre.z() >= from.z()) return;
        const double r = one.radius + sphere.radius;
        const double d = std::hypot(from.x() - sphere.centre.x(), from.y() - sphere.centre.y());
        if (r - d <= 8 * rounding(sphere.centre.z())) return;
        const double stop = sphere.centre.z() + std::sqrt((r - d) * (r + d));
        if (stop > height || (stop == height && i < met)) height = stop, met = i;
      });
    }
  }
  // By rounding, a grain touched from the start may seem to be met a little higher.
  one.centre.z() = std::min(height, from.z());
  const double touching = 32 * rounding(one.centre.z());
  std::erase_if(one.touched,
                [&](const Obstacle& old) { return old.number == met || std::abs(old.gap(one.centre)) > touching; });
  one.touched.push_back(obstacle(met, one.radius));
}

// Arc of a sphere on one or two supports; empty if others stop it on a crest.
std::optional<SphereHeap::Step> SphereHeap::next_step(const Traveller& one, const Carried& carried,
                                                      std::span<const SpacePoint> normals) const {
  Step step;
  step.count = carried.supports;
  for (std::size_t i = 0; i < carried.supports; ++i) step.pivots[i] = one.touched[carried.by[i]];
  if (step.pivots[0].plane) std::swap(step.pivots[0], step.pivots[1]);
  const Obstacle& pivot = step.pivots[0];
  Arc& arc = step.arc;
  arc.centre = pivot.at;
  std::vector<SpacePoint> ways;
  if (step.count == 2) {
    const Obstacle& other = step.pivots[1];
    const SpacePoint axis = other.plane ? other.at : SpacePoint((other.at - pivot.at).normalized());
    arc.centre += (one.centre - pivot.at).dot(axis) * axis;
    const SpacePoint along = axis.cross(one.centre - arc.centre).normalized();
    ways = {along, -along};
    if (along.z() > 0) std::swap(ways[0], ways[1]);
  } else {
    const SpacePoint& n = normals[carried.by[0]];
    const double slope = std::hypot(n.x(), n.y());
    if (slope > 0) ways.emplace_back(n.z() * n.x() / slope, n.z() * n.y() / slope, -slope);
    if (slope <= crest) {
      SpacePoint away = SpacePoint::Zero();
      for (const SpacePoint& other : normals) away += other;
      for (const SpacePoint& way :
           {away, SpacePoint(1, 0, 0), SpacePoint(-1, 0, 0), SpacePoint(0, 1, 0), SpacePoint(0, -1, 0)})
        if (const SpacePoint t = tangent(way, n); !t.isZero()) ways.push_back(t);
    }
  }
  arc.radius = (one.centre - arc.centre).norm();
  arc.outwards = (one.centre - arc.centre) / arc.radius;
  const bool steep = carried.velocity.norm() > crest;
  for (const SpacePoint& way : ways) {
    bool free = true;
    for (std::size_t k = 0; k < normals.size(); ++k)
      if (!carried.has(k) && normals[k].dot(way) < -crest) free = false;
    if (!free && !steep) continue;
    arc.ahead = way;
    return step;
  }
  return std::nullopt;
}

bool SphereHeap::roll(Traveller& one, const Step& step) {
  ++work_.motions;
  const Arc& arc = step.arc;
  const auto pivots = std::span(step.pivots).first(step.count);
  const double graze = 8 * rounding(one.centre.z());
  const SpacePoint axis = arc.outwards.cross(arc.ahead);

  // A support lets go where its multiplier, up to a positive factor n_z - c n'_z, falls to 0; c = n . n' is constant.
  double end = 2 * std::numbers::pi;
  std::optional<Index> released, met;
  for (std::size_t i = 0; i < pivots.size(); ++i) {
    const auto curvature = [](const Obstacle& o) { return o.plane ? 0 : 1 / o.reach; };
    double factor = curvature(pivots[i]), constant = factor * pivots[i].at.z();
    if (pivots.size() == 2) {
      const Obstacle& other = pivots[1 - i];
      const double c = pivots[i].normal(one.centre).dot(other.normal(one.centre));
      factor -= c * curvature(other);
      constant -= c * curvature(other) * other.at.z();
    }
    const double u = -factor * arc.outwards.z(), w = -factor * arc.ahead.z();
    const double angle = first_crossing(u, w, std::hypot(u, w) - (factor * arc.centre.z() - constant) / arc.radius);
    if (angle < end) end = angle, released = pivots[i].number;
  }
  const auto meet = [&](Index number, double angle) {
    // A support just lost is behind, but rounding may place it ahead.
    if (number == one.left && angle < standstill) return;
    // Of obstacles met at one point the lowest number counts, so that the bed does not depend on the order of search.
    if (angle < end || (angle == end && met && number < *met)) end = angle, met = number, released = std::nullopt;
  };
  for (Index number = Obstacle::floor; number >= Obstacle::floor - 4; --number) {
    if (among(pivots, number)) continue;
    const Obstacle plane = obstacle(number, one.radius);
    const double u = -plane.at.dot(arc.outwards), w = -plane.at.dot(arc.ahead);
    const double deepest = arc.radius * std::hypot(u, w) - plane.gap(arc.centre);
    if (deepest > graze) meet(number, first_crossing(u, w, deepest / arc.radius));
  }
  for (const BedCells::Level& level : cells_.levels()) {
    const double reach = (one.radius + level.largest) * (1 + size_margin);
    const double piece = reach / arc.radius;
    SpacePoint here = one.centre;
    for (double from = 0; from < end; from += piece) {
      const double to = std::min(end, from + piece);
      const SpacePoint there = arc.at(to);
      const double room = reach + arc.radius * (1 - std::cos(0.5 * (to - from)));
      const SpacePoint low = here.cwiseMin(there).array() - room, high = here.cwiseMax(there).array() + room;
      cells_.visit(level, level.layer_of(low.z()), level.layer_of(high.z()) + 1, low, high, [&](Index i) {
        ++work_.candidates;
        const Sphere& sphere = spheres_[at(i)];
        const SpacePoint q = sphere.centre - arc.centre;
        const double reach_i = one.radius + sphere.radius, u = q.dot(arc.outwards), w = q.dot(arc.ahead);
        const double h = q.dot(axis), in_plane = std::sqrt(u * u + w * w), d = in_plane - arc.radius;
        const double room_squared = reach_i * reach_i - h * h - d * d;
        // To first order, the arc comes no nearer than reach_i - graze.
        if (room_squared <= 2 * reach_i * graze || among(pivots, i)) return;
        meet(i, first_crossing(u, w, room_squared / (2 * arc.radius)));
      });
      here = there;
    }
  }

  if (met && end < standstill && among(one.touched, *met)) return false;

  one.centre = arc.at(end);
  std::vector<Obstacle> touched;
  for (const Obstacle& pivot : pivots)
    if (pivot.number != released) touched.push_back(pivot);
  if (met) touched.push_back(obstacle(*met, one.radius));
  touch_exactly(one.centre, touched, one.radius);
  const double touching = 32 * rounding(one.centre.z());
  for (const Obstacle& old : one.touched)
    if (old.number != released && old.number != met && !among(pivots, old.number) &&
        std::abs(old.gap(one.centre)) <= touching)
      touched.push_back(old);
  one.touched = std::move(touched);
  one.left = released;
  return true;
}

// The centre inside floor and walls: rounding may have put it outside.
SpacePoint SphereHeap::in_box(const Traveller& one) const {
  const double r = one.radius;
  return {std::clamp(one.centre.x(), r, width_ - r), std::clamp(one.centre.y(), r, depth_ - r),
          std::max(one.centre.z(), r)};
}

SphereHeap::Rest SphereHeap::at_rest(Traveller& one, const Carried& carried) const {
  Rest rest;
  std::vector<Obstacle> holding;
  for (std::size_t i = 0; i < carried.supports; ++i) holding.push_back(one.touched[carried.by[i]]);
  // On a crest, the obstacles that stop it hold it, too.
  for (std::size_t k = 0; k < one.touched.size() && holding.size() < 3; ++k)
    if (!carried.has(k)) holding.push_back(one.touched[k]);
  touch_exactly(one.centre, holding, one.radius);
  rest.centre = in_box(one);
  for (const Obstacle& obstacle : holding) rest.supports.push_back(obstacle.number);
  return rest;
}

std::optional<SphereHeap::Rest> SphereHeap::settle(double x, double y, double radius) {
  Traveller one{.centre = {x, y, infinity}, .radius = radius};
  std::vector<SpacePoint> normals;
  std::vector<Carried> in_vain;
  const Index last = work_.motions + most_motions;
  fall(one);
  while (work_.motions < last) {
    if (among(one.touched, Obstacle::floor)) {
      one.centre.z() = radius;
      return Rest{.centre = in_box(one), .supports = {Obstacle::floor}};
    }
    normals.clear();
    for (const Obstacle& obstacle : one.touched) normals.push_back(obstacle.normal(one.centre));
    const Carried carried = carried_by(normals, in_vain);
    if (carried.supports == 0) {
      fall(one);
      in_vain.clear();
      continue;
    }
    const auto step = carried.supports < 3 ? next_step(one, carried, normals) : std::nullopt;
    if (!step) return at_rest(one, carried);
    if (roll(one, *step))
      in_vain.clear();
    else
      in_vain.push_back(carried);
  }
  ++work_.abandoned;
  return std::nullopt;
}

}  // namespace nscdd
