// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/path.hpp"

namespace nscdd {
namespace {

// Places on the way are so close that chords of circles are off by this part of the smallest radius at the most.
constexpr double chord_error = 0.01;
constexpr double most_chords = 32;  // of a boundary that turns by far too much

// How far the corners of a box of all grains are from a point, at the most.
template <int D>
double farthest(const GranularState& state, const Pose& pose) {
  const auto along = [](const std::vector<double>& x, double from) {
    const auto [low, high] = std::ranges::minmax(x);
    return std::max(std::abs(high - from), std::abs(low - from));
  };
  return std::hypot(along(state.x, pose.x), along(state.y, pose.y), D == 3 ? along(state.z, pose.z) : 0);
}

double spin_of(const RigidVelocity& v) { return std::hypot(v.spin_x, v.spin_y, v.spin); }

// No grain moves by more than this relative to another or to a wall in a second, m/s.
template <int D, class Velocity>
double fastest_of(const GranularSystem& system, const GranularState& state, const std::vector<RigidVelocity>& motions,
                  Velocity&& velocity) {
  Direction<D> low, high;
  low.fill(system.boundaries.empty() ? infinity : 0);
  high.fill(system.boundaries.empty() ? -infinity : 0);
  for (std::size_t i = 0; i < at(system.grains()); ++i) {
    if (system.driven_by[i] >= 0) continue;
    const GrainUnknowns<D> v = velocity(i);
    for (std::size_t k = 0; k < D; ++k) low[k] = std::min(low[k], v[k]), high[k] = std::max(high[k], v[k]);
  }
  double boundaries = 0;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const double arm = spin_of(motions[k]) > 0 ? farthest<D>(state, state.poses[k]) : 0;
    boundaries = std::max(boundaries, std::hypot(motions[k].x, motions[k].y, motions[k].z) + spin_of(motions[k]) * arm);
  }
  return length<D>(moved_along<D>(high, -1, low)) + boundaries;
}

// In how many chords the arcs of a time are cut.
template <int D>
double chords(const GranularSystem& system, const GranularState& state, const std::vector<RigidVelocity>& motions,
              double time) {
  double most = 1;
  const double smallest = std::ranges::min(system.radius);
  for (std::size_t k = 0; k < motions.size(); ++k) {
    const double angle = time * spin_of(motions[k]);
    if (angle == 0) continue;
    const double sagitta = farthest<D>(state, state.poses[k]) * angle * angle / 8;
    most = std::max(most, std::ceil(std::sqrt(sagitta / (chord_error * smallest))));
  }
  return std::min(most, most_chords);
}

// One part of a path: at constant velocities of the boundaries.
struct Leg {
  double from = 0, to = 0;  // s, relative to the state
  std::vector<RigidVelocity> motions;
};

template <int D>
Path<D> path_of(const GranularSystem& system, const GranularState& state, const std::vector<Leg>& legs, bool always) {
  Path<D> path;
  path.begins_run = state.step == 0;
  const auto velocity = [&](std::size_t i) { return unknowns_of<D>(state, i, 1); };
  for (const Leg& leg : legs) path.reach += (leg.to - leg.from) * fastest_of<D>(system, state, leg.motions, velocity);
  // Two grains that overlap by less than is refused have their centres 1.5 times the smaller radius apart.
  const bool followed = path.reach > 1.5 * largest_turn * std::ranges::min(system.radius);
  if (followed || always) {
    path.times.push_back(legs.front().from);
    path.places.push_back(middle<D>(system, state, legs.front().motions, path.times.back()));
    for (const Leg& leg : legs) {
      const double number = chords<D>(system, state, leg.motions, leg.to - leg.from);
      for (double k = 1; k < number; ++k) {
        path.times.push_back(leg.from + k / number * (leg.to - leg.from));
        path.places.push_back(middle<D>(system, state, leg.motions, path.times.back()));
      }
      if (&leg == &legs.back()) break;
      if (!system.boundaries.empty()) path.bend = path.places.size();
      path.times.push_back(leg.to);
      path.places.push_back(middle<D>(system, state, leg.motions, leg.to));
    }
  }
  path.times.push_back(legs.back().to);
  path.places.push_back(middle<D>(system, state, legs.back().motions, legs.back().to));
  return path;
}

std::vector<RigidVelocity> motions_before(const GranularSystem& system, const GranularState& state,
                                          const TimeStepping& scheme) {
  return boundary_velocities(system, state.time - scheme.step / 2);
}

std::vector<Leg> legs_to_contacts(const GranularSystem& system, const GranularState& state,
                                  const TimeStepping& scheme) {
  std::vector<Leg> legs;
  if (state.step > 0) legs.push_back({-scheme.theta * scheme.step, 0, motions_before(system, state, scheme)});
  legs.push_back({0, (1 - scheme.theta) * scheme.step, step_motions(system, state, scheme)});
  return legs;
}

}  // namespace

template <int D>
Path<D> Path<D>::to_contacts(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme) {
  return path_of<D>(system, state, legs_to_contacts(system, state, scheme), false);
}

template <int D>
Path<D> Path<D>::whole(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme,
                       bool onwards) {
  std::vector<Leg> legs = legs_to_contacts(system, state, scheme);
  if (onwards) legs.push_back({legs.back().to, legs.back().to + scheme.step, legs.back().motions});
  return path_of<D>(system, state, legs, true);
}

template <int D>
bool Path<D>::is_short(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme,
                       const std::vector<GrainUnknowns<D>>& velocities) {
  const auto velocity = [&](std::size_t i) { return velocities[i]; };
  const double fastest = fastest_of<D>(system, state, step_motions(system, state, scheme), velocity);
  return scheme.theta * scheme.step * fastest <= largest_overlap * std::ranges::min(system.radius);
}

template <int D>
Path<D> Path<D>::to_end(const GranularSystem& system, const GranularState& after, const TimeStepping& scheme) {
  return path_of<D>(system, after, {{-scheme.theta * scheme.step, 0, motions_before(system, after, scheme)}}, false);
}

template struct Path<2>;
template struct Path<3>;

}  // namespace nscdd
