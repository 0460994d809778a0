// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_contacts.hpp"

#include "core/fail.hpp"
#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

template <int D>
double dot(const Direction<D>& a, const Direction<D>& b) {
  double sum = a[0] * b[0] + a[1] * b[1];
  if constexpr (D == 3) sum += a[2] * b[2];
  return sum;
}

template <int D>
double length(const Direction<D>& a) {
  if constexpr (D == 2)
    return std::hypot(a[0], a[1]);
  else
    return std::hypot(a[0], a[1], a[2]);
}

// a + factor b
template <int D>
Direction<D> moved_along(Direction<D> a, double factor, const Direction<D>& b) {
  for (std::size_t k = 0; k < D; ++k) a[k] += factor * b[k];
  return a;
}

// Where a grain meets a wall: the nearest point of the wall, and how far from it the centre is on the side of grains.
template <int D>
struct WallPoint {
  Direction<D> foot, normal;  // the normal points to the grain
  double height;
};

template <int D>
WallPoint<D> nearest_point(const Wall& wall, const Direction<D>& centre) {
  const Direction<D> point = narrowed<D>(wall.point), normal = narrowed<D>(wall.normal);
  const double along = dot<D>(moved_along<D>(centre, -1, point), normal);
  const Direction<D> below = moved_along<D>(centre, -along, normal);
  if (wall.radius == 0) return {below, normal, along};
  // A cylinder: from here `normal` is its axis and `outwards` the direction away from it.
  const Direction<D> axis_point = moved_along<D>(point, along, normal);
  Direction<D> outwards = moved_along<D>(centre, -1, axis_point);
  const double distance = std::sqrt(dot<D>(outwards, outwards));
  if (distance > 0) {
    for (double& one : outwards) one /= distance;
  } else {  // all points are as near as this one
    if constexpr (D == 3) outwards = tangents_of(normal).first;
  }
  const double radius = std::abs(wall.radius), inwards = wall.radius > 0 ? -1 : 1;
  const Direction<D> foot = moved_along<D>(axis_point, radius, outwards);
  for (double& one : outwards) one *= inwards;
  return {foot, outwards, inwards * (distance - radius)};
}

}  // namespace

template <int D>
Configuration<D> middle(const GranularSystem& system, const GranularState& state,
                        const std::vector<RigidVelocity>& motions, double time) {
  Configuration<D> where{state.x, state.y, state.z, system.walls, state.poses, motions};
  for (std::size_t k = 0; k < where.poses.size(); ++k) where.poses[k] = advanced<D>(where.poses[k], motions[k], time);
  for (std::size_t i = 0; i < where.x.size(); ++i) {
    Direction<D> centre = where.centre(i);
    if (system.driven_by[i] < 0) {
      const GrainUnknowns<D> v = unknowns_of<D>(state, i, system.radius[i]);
      for (std::size_t k = 0; k < D; ++k) centre[k] += time * v[k];
    } else {
      const auto k = at(system.driven_by[i]);
      centre = carried(centre, state.poses[k], where.poses[k]);
    }
    where.x[i] = centre[0];
    where.y[i] = centre[1];
    if constexpr (D == 3) where.z[i] = centre[2];
  }
  for (Wall& wall : where.walls)
    wall = moved<D>(wall, system.boundaries[at(wall.boundary)].motion, where.poses[at(wall.boundary)]);
  return where;
}

template <int D>
void for_each_contact(const GranularSystem& system, const Configuration<D>& where,
                      const std::function<Direction<D>(Index)>& velocity, const TimeStepping& scheme,
                      double least_alert, const std::function<void(const StepContact&)>& visit) {
  double fastest = 0;
  for (Index i = 0; i < system.disks(); ++i) fastest = std::max(fastest, length<D>(velocity(i)));
  const double smallest = *std::min_element(system.radius.begin(), system.radius.end());
  const double alert = std::max(scheme.alert * smallest, least_alert);
  const double range = std::max(alert, 2 * fastest * scheme.step);  // the fastest pair may close so much
  const auto visit_if_near = [&](Index a, Index b, const Direction<D>& normal, const Direction<D>& point, double gap,
                                 const std::function<Direction<D>()>& velocity_of_b) {
    const auto closing = [&] { return dot<D>(normal, moved_along<D>(velocity_of_b(), -1, velocity(a))); };
    const bool far = gap > alert && gap + scheme.step * closing() > alert;
    if (!far) visit({a, b, widened<D>(normal), widened<D>(point), gap});
  };
  const GrainGrid grid({where.x, where.y, where.z}, system.radius, 1, range);
  grid.for_each_pair([&](Index a, Index b) {
    const Direction<D> from = where.centre(at(a)), to = where.centre(at(b));
    Direction<D> apart = moved_along<D>(to, -1, from);
    const double touch = system.radius[at(a)] + system.radius[at(b)];
    const double near = touch + range;
    const double square = dot<D>(apart, apart);
    if (square > near * near || (!system.free(a) && !system.free(b))) return;
    const double distance = std::sqrt(square);
    if (!(distance > 0))
      fail("{} and {}: expected distinct centres, met one", body_name(system, a), body_name(system, b));
    Direction<D> half{};
    for (std::size_t k = 0; k < D; ++k) {
      apart[k] /= distance;
      half[k] = (from[k] + to[k]) / 2;
    }
    visit_if_near(a, b, apart, half, distance - touch, [&] { return velocity(b); });
  });
  for (Index w = 0; w < count(where.walls); ++w) {
    const Wall& wall = where.walls[at(w)];
    for (Index i = 0; i < system.disks(); ++i) {
      if (!system.free(i)) continue;
      const auto [foot, normal, height] = nearest_point<D>(wall, where.centre(at(i)));
      const auto v = [&, at_foot = foot] {
        return velocity_of_point(where.motions[at(wall.boundary)], where.poses[at(wall.boundary)], at_foot);
      };
      Direction<D> down = normal;
      for (double& one : down) one = -one;
      visit_if_near(i, system.disks() + w, down, foot, height - system.radius[at(i)], v);
    }
  }
}

template Configuration<2> middle(const GranularSystem&, const GranularState&, const std::vector<RigidVelocity>&,
                                 double);
template Configuration<3> middle(const GranularSystem&, const GranularState&, const std::vector<RigidVelocity>&,
                                 double);
template void for_each_contact<2>(const GranularSystem&, const Configuration<2>&,
                                  const std::function<Direction<2>(Index)>&, const TimeStepping&, double,
                                  const std::function<void(const StepContact&)>&);
template void for_each_contact<3>(const GranularSystem&, const Configuration<3>&,
                                  const std::function<Direction<3>(Index)>&, const TimeStepping&, double,
                                  const std::function<void(const StepContact&)>&);

}  // namespace nscdd
