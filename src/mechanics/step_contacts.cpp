// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_contacts.hpp"

#include "core/fail.hpp"
#include "packing/grain_grid.hpp"

namespace nscdd {

template <int D>
void for_each_contact(const GranularSystem& system, const Path<D>& path,
                      const std::function<Direction<D>(Index)>& velocity, const TimeStepping& scheme,
                      double least_alert, const std::function<void(const StepContact&)>& visit,
                      const std::function<void(const DeepOverlap&)>& deep) {
  const Configuration<D>& where = path.places.back();
  double fastest = 0;
  for (Index i = 0; i < system.disks(); ++i) fastest = std::max(fastest, length<D>(velocity(i)));
  const double smallest = *std::min_element(system.radius.begin(), system.radius.end());
  const double alert = std::max(scheme.alert * smallest, least_alert);
  const double foreseen = std::max(alert, 2 * fastest * scheme.step);  // the fastest pair may close so much
  const double range = path.followed() ? std::max(foreseen, path.reach) : foreseen;  // or has come apart by so much
  const auto visit_if_near = [&](Index a, Index b, const Direction<D>& normal, const Direction<D>& point, double gap,
                                 bool within, const std::function<Direction<D>()>& velocity_of_b) {
    const auto [overlap, met] = check_passage<D>(system, path, a, b, gap);
    if (overlap) deep(*overlap);
    if (met) return visit({a, b, widened<D>(*met), widened<D>(point), std::min(gap, 0.0)});
    const auto closing = [&] { return dot<D>(normal, moved_along<D>(velocity_of_b(), -1, velocity(a))); };
    const bool far = gap > alert && gap + scheme.step * closing() > alert;
    if (!far && within) visit({a, b, widened<D>(normal), widened<D>(point), gap});
  };
  const GrainGrid grid({where.x, where.y, where.z}, system.radius, 1, range);
  grid.for_each_pair([&](Index a, Index b) {
    const Direction<D> from = where.centre(at(a)), to = where.centre(at(b));
    Direction<D> apart = moved_along<D>(to, -1, from);
    const double touch = system.radius[at(a)] + system.radius[at(b)];
    const double near = touch + range, in_reach = touch + foreseen;
    const double square = dot<D>(apart, apart);
    if (square > near * near || (!system.free(a) && !system.free(b))) return;
    const double distance = std::sqrt(square);
    if (!(distance > 0) && path.followed()) {
      if (const auto overlap = check_passage<D>(system, path, a, b, -touch).deep; overlap && overlap->before < touch)
        return deep(*overlap);
    }
    if (!(distance > 0))
      fail("{} and {}: expected distinct centres, met one", body_name(system, a), body_name(system, b));
    Direction<D> half{};
    for (std::size_t k = 0; k < D; ++k) {
      apart[k] /= distance;
      half[k] = (from[k] + to[k]) / 2;
    }
    visit_if_near(a, b, apart, half, distance - touch, square <= in_reach * in_reach, [&] { return velocity(b); });
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
      visit_if_near(i, system.disks() + w, down, foot, height - system.radius[at(i)], true, v);
    }
  }
}

template void for_each_contact<2>(const GranularSystem&, const Path<2>&, const std::function<Direction<2>(Index)>&,
                                  const TimeStepping&, double, const std::function<void(const StepContact&)>&,
                                  const std::function<void(const DeepOverlap&)>&);
template void for_each_contact<3>(const GranularSystem&, const Path<3>&, const std::function<Direction<3>(Index)>&,
                                  const TimeStepping&, double, const std::function<void(const StepContact&)>&,
                                  const std::function<void(const DeepOverlap&)>&);

}  // namespace nscdd
