// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/passage.hpp"

#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

// The least distance of a straight path from a convex body. The distance is convex along the path.
double least_height(const Wall& wall, const Place& from, const Place& move) {
  double low = 0, high = 1;
  const auto height = [&](double part) { return nearest_point(wall, moved_along(from, part, move)).height; };
  for (int k = 0; k < 50; ++k) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    if (height(a) < height(b))
      high = b;
    else
      low = a;
  }
  return height((low + high) / 2);
}

// Grain a and body b at each place of a path. `steps`: periods from a to the image that is followed.
class Pair {
 public:
  Pair(const Path& path, Index a, Index b, const Place& steps)
      : path_(path),
        a_(at(a)),
        b_(at(b)),
        wall_(b - path.system.grains()),
        boundary_(wall_ >= 0 ? path.system.boundary_of(b)
                             : std::max(path.system.driven_by[a_], path.system.driven_by[b_])),
        radius_(path.system.radius[a_]),
        steps_(steps) {}

  // Round bodies have a line from centre to centre or axis. Other walls are flat or hollow, or have ends.
  bool driven() const { return boundary_ >= 0; }
  bool round() const {
    return wall_ < 0 || (wall(path_.places.back()).radius < 0 && !wall(path_.places.back()).has_ends());
  }
  double touch() const { return radius_ + (wall_ < 0 ? path_.system.radius[b_] : -wall(path_.places.back()).radius); }

  // From a to b, or to the axis of b, seen from the boundary.
  Place line(std::size_t place) const {
    const Configuration& where = path_.places[place];
    if (wall_ < 0) return seen(place, difference(where.centre(b_), centre(where)));
    const auto [foot, normal, height] = nearest_point(wall(where), centre(where));
    return seen(place, moved_along({}, wall(where).radius - height, normal));
  }
  // Of a flat or hollow body.
  double gap(std::size_t place) const {
    const Configuration& where = path_.places[place];
    return nearest_point(wall(where), centre(where)).height - radius_;
  }
  // Overlap, m, of a grain whose centre crosses the middle of a plank, or the largest with a cylinder with ends; else
  // -infinity. `from`, `to`: of place_at_wall.
  double overlap_inside(const Place& from, const Place& to) const {
    const Configuration& where = path_.places.back();
    Wall plank = wall(where);
    plank.point = difference(plank.point, where.poses[at(boundary_)].place());
    if (plank.has_ends()) return radius_ - least_height(plank, from, difference(to, from));
    if (!plank.plank()) return -infinity;
    const double before = dot(difference(from, plank.point), plank.normal),
                 after = dot(difference(to, plank.point), plank.normal);
    if (before * after >= 0) return -infinity;
    const Place crossing = moved_along(from, before / (before - after), difference(to, from));
    const Place beside = difference(crossing, nearest_in_plank(plank, crossing));
    return radius_ + plank.radius - path_.system.length(beside);
  }
  Place place_at_wall(std::size_t place) const {
    const Configuration& where = path_.places[place];
    return seen(place, difference(centre(where), where.poses[at(boundary_)].place()));
  }

 private:
  const Wall& wall(const Configuration& where) const { return where.walls[at(wall_)]; }
  Place centre(const Configuration& where) const { return moved_along(where.centre(a_), 1, steps_); }
  // A vector fixed to the boundary, turned to the end of the path.
  Place seen(std::size_t place, const Place& arm) const {
    if (boundary_ < 0) return arm;
    const auto turn = [&](const Configuration& where) {
      const Pose& pose = where.poses[at(boundary_)];
      return Pose{.angle = pose.angle, .turn = pose.turn};
    };
    return carried(arm, turn(path_.places[place]), turn(path_.places.back()));
  }

  const Path& path_;
  std::size_t a_, b_;
  Index wall_, boundary_;
  double radius_;
  Place steps_;
};

// The steps from a to its image that is nearest to b at a place of a path.
Place steps_to_image(const Path& path, std::size_t place, Index a, Index b) {
  const GranularSystem& system = path.system;
  if (!system.period.any()) return {};
  const Configuration& where = path.places[place];
  const Place centre = where.centre(at(a));
  if (b >= system.grains())
    return moved_along({}, -1, image_step(system, where.walls[at(b - system.grains())], centre));
  const Place other = where.centre(at(b));
  return difference(difference(other, centre), system.apart(centre, other));
}

struct Followed {
  double before = 0, deepest = 0, path = 0, reached = infinity;
  double at_bend = -infinity, at_end = 0;  // overlaps, m
};

// Whether the overlap was largest when a boundary turned back, and is smaller now: the hit is then over when contacts
// are found, and velocities do not show it. `small`: the smaller radius, m.
bool turned_back(const Followed& found, double small) {
  constexpr double notable = 0.02;      // of the radius, more than the error of chords
  const bool apart = found.before < 0;  // bodies that touched when contacts were last found are a contact since then
  return apart && found.at_bend > notable * small && found.at_bend >= found.deepest && found.at_bend > found.at_end;
}

// Follows the line of centres of round bodies. `limit`: the overlap whose time is wanted.
Followed follow_line(const Path& path, const Pair& pair, double limit, std::optional<Place>& met) {
  const double touch = pair.touch();
  Place from = pair.line(0);
  double distance = path.system.length(from);
  Followed result{.before = touch - distance, .deepest = touch - distance};
  std::optional<Place> entered;  // none if they touched when contacts were last found: they are a contact since then
  if (path.begins_run) entered = from;
  for (std::size_t k = 1; k < path.places.size(); ++k) {
    const Place to = pair.line(k), move = difference(to, from);
    const double square = dot(move, move);
    result.path += std::sqrt(square);
    if (distance > touch)
      if (const auto part = part_until(from, move, touch)) entered = moved_along(from, *part, move);
    if (distance > touch - limit && std::isinf(result.reached))
      if (const auto part = part_until(from, move, touch - limit))
        result.reached = path.times[k - 1] + *part * (path.times[k] - path.times[k - 1]) - path.times.front();
    const double nearest = square > 0 ? std::clamp(-dot(from, move) / square, 0.0, 1.0) : 0;
    const double overlap = touch - path.system.length(moved_along(from, nearest, move));
    if (overlap > result.deepest) result.deepest = overlap, met = entered;
    from = to;
    distance = path.system.length(from);
    if (k == path.bend && pair.driven()) result.at_bend = touch - distance;
  }
  result.at_end = touch - distance;
  return result;
}

// Follows the gap at a flat or hollow body: on a straight path a grain is deepest at one of the ends.
Followed follow_gap(const Path& path, const Pair& pair, double limit) {
  double before = -pair.gap(0);
  Place from = pair.place_at_wall(0);
  Followed result{.before = before, .deepest = before};
  for (std::size_t k = 1; k < path.places.size(); ++k) {
    const double overlap = -pair.gap(k);
    const Place to = pair.place_at_wall(k);
    result.path += path.system.length(difference(to, from));
    if (before < limit && overlap >= limit && std::isinf(result.reached))
      result.reached = path.times[k - 1] + (limit - before) / (overlap - before) * (path.times[k] - path.times[k - 1]) -
                       path.times.front();
    result.deepest = std::max({result.deepest, overlap, pair.overlap_inside(from, to)});
    if (k == path.bend) result.at_bend = overlap;
    before = overlap;
    from = to;
  }
  result.at_end = before;
  return result;
}

// `steps`: to the image of grain a that is followed; `gap`: of that image at the end, m.
Passage of_image(const Path& path, Index a, Index b, double gap, const Place& steps) {
  const double small = path.system.smaller_radius(a, b), limit = largest_overlap * small;
  Passage passage;
  const Pair pair(path, a, b, steps);
  std::optional<Place> met;
  const Followed found =
      pair.round() ? follow_line(path, pair, safe_part * limit, met) : follow_gap(path, pair, safe_part * limit);
  if (gap < -limit || (found.deepest > limit && found.deepest > found.before) || turned_back(found, small))
    passage.deep = {.a = a,
                    .b = b,
                    .overlap = std::max(found.deepest, -gap),
                    .before = found.before,
                    .path = found.path,
                    .time = path.times.back() - path.times.front(),
                    .reached = found.reached};
  if (!met || !(found.deepest > touching_gap * small)) return passage;
  const Place line = pair.line(path.places.size() - 1);
  const double now = path.system.length(line), then = path.system.length(*met);
  if (!(dot(line, *met) < std::cos(largest_turn) * now * then)) return passage;
  passage.normal = divided(*met, then);
  return passage;
}

}  // namespace

std::optional<double> part_until(const Place& from, const Place& move, double end, double most) {
  const double a = dot(move, move), b = dot(from, move), c = dot(from, from) - end * end;
  const double root = b * b - a * c;
  if (!(b < 0) || !(root >= 0)) return std::nullopt;
  const double part = c / (-b + std::sqrt(root));
  return part <= most ? std::optional(part) : std::nullopt;
}

Passage Passage::of(const Path& path, Index a, Index b, double gap) {
  if (!path.followed()) {
    Passage passage;
    if (gap < -largest_overlap * path.system.smaller_radius(a, b))
      passage.deep = {.a = a, .b = b, .overlap = -gap, .before = -gap};
    return passage;
  }
  const Place last = steps_to_image(path, path.places.size() - 1, a, b), first = steps_to_image(path, 0, a, b);
  Passage passage = of_image(path, a, b, gap, last);
  const bool leaves = path.system.length(difference(last, first)) > path.system.smaller_radius(a, b);
  if (leaves && !passage.deep) passage.deep = of_image(path, a, b, infinity, first).deep;
  return passage;
}

std::vector<DeepOverlap> Passage::too_deep(const Path& path) {
  const GranularSystem& system = path.system;
  std::vector<DeepOverlap> deep;
  const Configuration& where = path.places.back();
  const auto check = [&](Index a, Index b, double gap) {
    if (const auto found = of(path, a, b, gap).deep) deep.push_back(*found);
  };
  const Places places{where.x, where.y, where.z};
  for_each_near_pair(places, system.radius, system.period, 1, path.reach, [&](Index a, Index b) {
    if (!system.may_touch(a, b)) return;
    const double distance = path.system.length(system.apart(where.centre(at(a)), where.centre(at(b))));
    const double gap = distance - system.radius[at(a)] - system.radius[at(b)];
    if (gap <= path.reach) check(a, b, gap);
  });
  for (Index w = 0; w < count(where.walls); ++w)
    for (Index i = 0; i < system.grains(); ++i)
      if (system.may_touch(i, system.grains() + w))
        check(i, system.grains() + w,
              nearest_point(system, where.walls[at(w)], where.centre(at(i))).height - system.radius[at(i)]);
  return deep;
}

}  // namespace nscdd
