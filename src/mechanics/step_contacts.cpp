// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_contacts.hpp"

#include "packing/contact_order.hpp"
#include "packing/disk_grid.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

struct Alert {
  double distance = 0;  ///< m
  double reach = 0;     ///< m, what the fastest pair may close in the step
};

Alert alert_of(const GranularSystem& system, const std::vector<DiskVelocity>& free, const TimeStepping& scheme,
               double least) {
  double fastest = 0;
  for (Index i = 0; i < system.disks(); ++i) fastest = std::max(fastest, std::hypot(free[at(i)].x, free[at(i)].y));
  const double smallest = *std::min_element(system.radius.begin(), system.radius.end());
  return {std::max(scheme.alert * smallest, least), 2 * fastest * scheme.step};
}

}  // namespace

std::vector<StepContact> find_contacts(const GranularSystem& system, const Configuration& where,
                                       const std::vector<DiskVelocity>& free, const TimeStepping& scheme,
                                       double least_alert) {
  const Alert alert = alert_of(system, free, scheme, least_alert);
  const double range = std::max(alert.distance, alert.reach);
  std::vector<StepContact> found;
  found.reserve(at(3 * system.disks()));
  const DiskGrid grid(where.x, where.y, system.radius, 1, range);
  grid.for_each_pair([&](Index a, Index b) {
    const double dx = where.x[at(b)] - where.x[at(a)], dy = where.y[at(b)] - where.y[at(a)];
    const double touch = system.radius[at(a)] + system.radius[at(b)];
    const double near = touch + range;
    const double square = dx * dx + dy * dy;
    if (square > near * near || (!system.free(a) && !system.free(b))) return;
    const double distance = std::sqrt(square);
    if (!(distance > 0))
      throw Error(
          fmt::format("{} and {}: expected distinct centres, met one", body_name(system, a), body_name(system, b)));
    StepContact c{.a = a, .b = b, .normal = {dx / distance, dy / distance}, .gap = distance - touch};
    const double closing =
        c.normal[0] * (free[at(b)].x - free[at(a)].x) + c.normal[1] * (free[at(b)].y - free[at(a)].y);
    if (c.gap > alert.distance && c.gap + scheme.step * closing > alert.distance) return;
    c.point = {(where.x[at(a)] + where.x[at(b)]) / 2, (where.y[at(a)] + where.y[at(b)]) / 2};
    found.push_back(c);
  });
  for (Index w = 0; w < count(where.walls); ++w) {
    const Wall& wall = where.walls[at(w)];
    const RigidVelocity& motion = where.motions[at(wall.boundary)];
    const Pose& pose = where.poses[at(wall.boundary)];
    for (Index i = 0; i < system.disks(); ++i) {
      if (!system.free(i)) continue;
      const double height =
          (where.x[at(i)] - wall.point[0]) * wall.normal[0] + (where.y[at(i)] - wall.point[1]) * wall.normal[1];
      const double gap = height - system.radius[at(i)];
      const std::array<double, 2> foot{where.x[at(i)] - height * wall.normal[0],
                                       where.y[at(i)] - height * wall.normal[1]};
      const auto v = velocity_of_point(motion, pose, foot);
      const double closing = wall.normal[0] * (free[at(i)].x - v[0]) + wall.normal[1] * (free[at(i)].y - v[1]);
      if (gap > alert.distance && gap + scheme.step * closing > alert.distance) continue;
      found.push_back(
          {.a = i, .b = system.disks() + w, .normal = {-wall.normal[0], -wall.normal[1]}, .point = foot, .gap = gap});
    }
  }
  return sorted_by_bodies(found, system.disks());
}

}  // namespace nscdd
