// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/passage.hpp"

#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

// A vector of a boundary as it turned with it to the end of the path.
template <int D>
Direction<D> turned_on(const Direction<D>& arm, const Pose& before, const Pose& after) {
  const auto turn_of = [](const Pose& pose) {
    Pose turn;
    turn.angle = pose.angle;
    turn.turn = pose.turn;
    return turn;
  };
  return carried(arm, turn_of(before), turn_of(after));
}

// Grain a and body b at each place of a path.
template <int D>
class Pair {
 public:
  Pair(const GranularSystem& system, const Path<D>& path, Index a, Index b)
      : path_(path), a_(at(a)), b_(at(b)), wall_(b - system.grains()), radius_(system.radius[a_]) {
    if (wall_ >= 0)
      boundary_ = path.places.back().walls[at(wall_)].boundary;
    else
      boundary_ = std::max(system.driven_by[a_], system.driven_by[b_]);
    touch_ = wall_ < 0 ? radius_ + system.radius[b_] : radius_;
  }

  // Two round bodies have a line of centres, or of a centre and an axis. The others are flat or hollow.
  bool driven() const { return boundary_ >= 0; }
  bool round() const { return wall_ < 0 || wall(path_.places.back()).radius < 0; }
  double touch() const { return round() && wall_ >= 0 ? radius_ - wall(path_.places.back()).radius : touch_; }

  // From a to b, or to the axis of b, seen from the boundary.
  Direction<D> line(std::size_t place) const {
    const Configuration<D>& where = path_.places[place];
    if (wall_ < 0) return seen(place, moved_along<D>(where.centre(b_), -1, where.centre(a_)));
    const auto [foot, normal, height] = nearest_point<D>(wall(where), where.centre(a_));
    Direction<D> line{};
    return seen(place, moved_along<D>(line, wall(where).radius - height, normal));
  }
  // Of a flat or hollow body.
  double gap(std::size_t place) const {
    const Configuration<D>& where = path_.places[place];
    return nearest_point<D>(wall(where), where.centre(a_)).height - radius_;
  }
  Direction<D> place_at_wall(std::size_t place) const {
    const Configuration<D>& where = path_.places[place];
    const Pose& pose = where.poses[at(boundary_)];
    if constexpr (D == 2)
      return seen(place, moved_along<D>(where.centre(a_), -1, {pose.x, pose.y}));
    else
      return seen(place, moved_along<D>(where.centre(a_), -1, {pose.x, pose.y, pose.z}));
  }

 private:
  const Wall& wall(const Configuration<D>& where) const { return where.walls[at(wall_)]; }
  Direction<D> seen(std::size_t place, const Direction<D>& arm) const {
    if (boundary_ < 0) return arm;
    return turned_on<D>(arm, path_.places[place].poses[at(boundary_)], path_.places.back().poses[at(boundary_)]);
  }

  const Path<D>& path_;
  std::size_t a_, b_;
  Index wall_, boundary_ = -1;
  double radius_, touch_ = 0;
};

// The part of `move` after which the vector `from`, longer than `end` at first, has the length `end`; or none.
template <int D>
std::optional<double> part_until(const Direction<D>& from, const Direction<D>& move, double end) {
  const double a = dot<D>(move, move), b = dot<D>(from, move), c = dot<D>(from, from) - end * end;
  const double root = b * b - a * c;
  if (!(b < 0) || !(root >= 0)) return std::nullopt;
  const double part = c / (-b + std::sqrt(root));
  return part <= 1 ? std::optional(part) : std::nullopt;
}

struct Followed {
  double before = 0, deepest = 0, path = 0, reached = infinity;
  double at_bend = -infinity, at_end = 0;  // overlaps, m
};

// Whether the overlap was largest when a boundary turned back, and is smaller now. What the boundary did to the other
// body is then over when contacts are found, and velocities do not show it. `small`: the smaller radius, m.
bool turned_back(const Followed& found, double small) {
  constexpr double notable = 0.02;      // of the radius, more than chords of arcs are off by
  const bool apart = found.before < 0;  // bodies that touched when contacts were found last are a contact since then
  return apart && found.at_bend > notable * small && found.at_bend >= found.deepest && found.at_bend > found.at_end;
}

// Bodies with a line of centres: follows it from place to place. `limit`: the overlap whose time is wanted.
template <int D>
Followed follow_line(const Path<D>& path, const Pair<D>& pair, double limit, std::optional<Direction<D>>& met) {
  const double touch = pair.touch();
  Direction<D> from = pair.line(0);
  double distance = length<D>(from);
  Followed result{.before = touch - distance, .deepest = touch - distance};
  // Bodies that touched when contacts were found last are a contact since then.
  std::optional<Direction<D>> entered;
  if (path.begins_run) entered = from;
  for (std::size_t k = 1; k < path.places.size(); ++k) {
    const Direction<D> to = pair.line(k), move = moved_along<D>(to, -1, from);
    const double square = dot<D>(move, move);
    result.path += std::sqrt(square);
    if (distance > touch)
      if (const auto part = part_until<D>(from, move, touch)) entered = moved_along<D>(from, *part, move);
    if (distance > touch - limit && std::isinf(result.reached))
      if (const auto part = part_until<D>(from, move, touch - limit))
        result.reached = path.times[k - 1] + *part * (path.times[k] - path.times[k - 1]) - path.times.front();
    const double nearest = square > 0 ? std::clamp(-dot<D>(from, move) / square, 0.0, 1.0) : 0;
    const double overlap = touch - length<D>(moved_along<D>(from, nearest, move));
    if (overlap > result.deepest) result.deepest = overlap, met = entered;
    from = to;
    distance = length<D>(from);
    if (k == path.bend && pair.driven()) result.at_bend = touch - distance;
  }
  result.at_end = touch - distance;
  return result;
}

// Flat and hollow bodies: nowhere on a straight path is a grain deeper than at one of its ends.
template <int D>
Followed follow_gap(const Path<D>& path, const Pair<D>& pair, double limit) {
  double before = -pair.gap(0);
  Direction<D> from = pair.place_at_wall(0);
  Followed result{.before = before, .deepest = before};
  for (std::size_t k = 1; k < path.places.size(); ++k) {
    const double overlap = -pair.gap(k);
    const Direction<D> to = pair.place_at_wall(k);
    result.path += length<D>(moved_along<D>(to, -1, from));
    if (before < limit && overlap >= limit && std::isinf(result.reached))
      result.reached = path.times[k - 1] + (limit - before) / (overlap - before) * (path.times[k] - path.times[k - 1]) -
                       path.times.front();
    result.deepest = std::max(result.deepest, overlap);
    if (k == path.bend) result.at_bend = overlap;
    before = overlap;
    from = to;
  }
  result.at_end = before;
  return result;
}

}  // namespace

template <int D>
Passage<D> Passage<D>::of(const GranularSystem& system, const Path<D>& path, Index a, Index b, double gap) {
  const double small = smaller_radius(system, a, b), limit = largest_overlap * small;
  Passage<D> passage;
  if (!path.followed()) {
    if (gap < -limit) passage.deep = {.a = a, .b = b, .overlap = -gap, .before = -gap};
    return passage;
  }
  const Pair<D> pair(system, path, a, b);
  std::optional<Direction<D>> met;
  const Followed found =
      pair.round() ? follow_line<D>(path, pair, safe_part * limit, met) : follow_gap<D>(path, pair, safe_part * limit);
  if (gap < -limit || (found.deepest > limit && found.deepest > found.before) || turned_back(found, small))
    passage.deep = {.a = a,
                    .b = b,
                    .overlap = std::max(found.deepest, -gap),
                    .before = found.before,
                    .path = found.path,
                    .time = path.times.back() - path.times.front(),
                    .reached = found.reached};
  if (!met || !(found.deepest > touching_gap * small)) return passage;
  const Direction<D> line = pair.line(path.places.size() - 1);
  const double now = length<D>(line), then = length<D>(*met);
  if (!(dot<D>(line, *met) < std::cos(largest_turn) * now * then)) return passage;
  passage.normal.emplace();
  for (std::size_t k = 0; k < D; ++k) (*passage.normal)[k] = (*met)[k] / then;
  return passage;
}

template <int D>
std::vector<DeepOverlap> Passage<D>::too_deep(const GranularSystem& system, const Path<D>& path) {
  std::vector<DeepOverlap> deep;
  const Configuration<D>& where = path.places.back();
  const auto check = [&](Index a, Index b, double gap) {
    if (const auto found = of(system, path, a, b, gap).deep) deep.push_back(*found);
  };
  const GrainGrid grid({where.x, where.y, where.z}, system.radius, 1, path.reach);
  grid.for_each_pair([&](Index a, Index b) {
    if (!system.free(a) && !system.free(b)) return;
    const double distance = length<D>(moved_along<D>(where.centre(at(b)), -1, where.centre(at(a))));
    const double gap = distance - system.radius[at(a)] - system.radius[at(b)];
    if (gap <= path.reach) check(a, b, gap);
  });
  for (Index w = 0; w < count(where.walls); ++w)
    for (Index i = 0; i < system.grains(); ++i)
      if (system.free(i))
        check(i, system.grains() + w,
              nearest_point<D>(where.walls[at(w)], where.centre(at(i))).height - system.radius[at(i)]);
  return deep;
}

template struct Passage<2>;
template struct Passage<3>;

}  // namespace nscdd
