// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_contacts.hpp"

#include "core/fail.hpp"
#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

// Two grains that move by more than this relative to each other in a step, times the smaller radius, do not meet with
// the normal that they have when contacts are found. Below it that normal is off by half of this, rad, at the most.
constexpr double far_in_a_step = 0.5;

// The line of centres of two grains, over its length, where they touch within a step at constant velocities; none if
// they do not. `line`: from one centre to the other; `move`: its change in a second.
template <int D>
std::optional<Direction<D>> normal_where_they_meet(const Direction<D>& line, const Direction<D>& move, double touch,
                                                   double step) {
  const double a = dot<D>(move, move), b = dot<D>(line, move), c = dot<D>(line, line) - touch * touch;
  const double root = b * b - a * c;
  if (!(b < 0) || !(root >= 0)) return std::nullopt;
  const double time = c / (-b + std::sqrt(root));
  if (!(time <= step)) return std::nullopt;
  Direction<D> normal = moved_along<D>(line, time, move);
  for (double& one : normal) one /= touch;
  return normal;
}

}  // namespace

template <int D>
void for_each_contact(const GranularSystem& system, const Path<D>& path,
                      const std::function<Direction<D>(Index)>& velocity, const TimeStepping& scheme,
                      double least_alert, bool foresees, const std::function<void(const StepContact&)>& visit,
                      const std::function<void(const DeepOverlap&)>& deep) {
  const Configuration<D>& where = path.places.back();
  double fastest = 0;
  for (Index i = 0; i < system.grains(); ++i) fastest = std::max(fastest, length<D>(velocity(i)));
  const double smallest = *std::min_element(system.radius.begin(), system.radius.end());
  const double alert = std::max(scheme.alert * smallest, least_alert);
  const double foreseen = std::max(alert, 2 * fastest * scheme.step);  // the fastest pair may close so much
  const double range = path.followed() ? std::max(foreseen, path.reach) : foreseen;  // or has come apart by so much
  const auto visit_if_near = [&](Index a, Index b, const Direction<D>& normal, const Direction<D>& point, double gap,
                                 bool within, const std::function<Direction<D>()>& velocity_of_b) {
    const auto [overlap, met] = Passage<D>::of(system, path, a, b, gap);
    if (overlap) deep(*overlap);
    if (met) return visit({a, b, widened<D>(*met), widened<D>(point), std::min(gap, 0.0)});
    const auto closing = [&] { return dot<D>(normal, moved_along<D>(velocity_of_b(), -1, velocity(a))); };
    const bool far = gap > alert && gap + scheme.step * closing() > alert;
    if (far || !within) return;
    StepContact contact{a, b, widened<D>(normal), widened<D>(point), gap};
    if (foresees && gap > alert && b < system.grains() &&
        scheme.step * length<D>(moved_along<D>(velocity_of_b(), -1, velocity(a))) >
            far_in_a_step * smaller_radius(system, a, b)) {
      // Of grains that move far until they meet the line of centres turns. Those that miss each other are no contact.
      const Direction<D> line = moved_along<D>(where.centre(at(b)), -1, where.centre(at(a)));
      const Direction<D> move = moved_along<D>(velocity_of_b(), -1, velocity(a));
      const auto meeting = normal_where_they_meet<D>(line, move, length<D>(line) - gap, scheme.step);
      if (!meeting) return;
      if (dot<D>(normal, *meeting) < std::cos(largest_turn)) {
        contact.normal = widened<D>(*meeting);
        contact.gap = 0;
      }
    }
    visit(contact);
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
      if (const auto overlap = Passage<D>::of(system, path, a, b, -touch).deep; overlap && overlap->before < touch)
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
    for (Index i = 0; i < system.grains(); ++i) {
      if (!system.free(i)) continue;
      const auto [foot, normal, height] = nearest_point<D>(wall, where.centre(at(i)));
      const auto v = [&, at_foot = foot] {
        return velocity_of_point(where.motions[at(wall.boundary)], where.poses[at(wall.boundary)], at_foot);
      };
      Direction<D> down = normal;
      for (double& one : down) one = -one;
      visit_if_near(i, system.grains() + w, down, foot, height - system.radius[at(i)], true, v);
    }
  }
}

template void for_each_contact<2>(const GranularSystem&, const Path<2>&, const std::function<Direction<2>(Index)>&,
                                  const TimeStepping&, double, bool, const std::function<void(const StepContact&)>&,
                                  const std::function<void(const DeepOverlap&)>&);
template void for_each_contact<3>(const GranularSystem&, const Path<3>&, const std::function<Direction<3>(Index)>&,
                                  const TimeStepping&, double, bool, const std::function<void(const StepContact&)>&,
                                  const std::function<void(const DeepOverlap&)>&);

}  // namespace nscdd
