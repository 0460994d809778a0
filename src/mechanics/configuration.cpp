// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/configuration.hpp"

namespace nscdd {

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

double smaller_radius(const GranularSystem& system, Index a, Index b) {
  const double radius = system.radius[at(a)];
  return b < system.grains() ? std::min(radius, system.radius[at(b)]) : radius;
}

template WallPoint<2> nearest_point<2>(const Wall&, const Direction<2>&);
template WallPoint<3> nearest_point<3>(const Wall&, const Direction<3>&);
template Configuration<2> middle(const GranularSystem&, const GranularState&, const std::vector<RigidVelocity>&,
                                 double);
template Configuration<3> middle(const GranularSystem&, const GranularState&, const std::vector<RigidVelocity>&,
                                 double);

}  // namespace nscdd
