// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries, grains and walls as bodies of LMGC90: their numbers, nodes and axes.
#include "core/fail.hpp"
#include "formats/lmgc90/datbox_writer.hpp"
#include "mechanics/contact_frame.hpp"

namespace nscdd {

void DatboxWriter::number_bodies() {
  const GranularSystem& system = first_.system;
  std::vector<Body> driven;  // one per boundary; in space one per driven sphere, and one per wall if it has more shapes
  std::vector<Index> of_boundary(system.boundaries.size(), -1);
  for (std::size_t b = 0; b < of_boundary.size(); ++b) {
    if (space_ && !system.boundaries[b].body) continue;
    of_boundary[b] = count(driven);
    driven.push_back({.boundary = static_cast<Index>(b)});
  }
  const auto body_of = [&](Index boundary) -> Body& {
    const Index body = of_boundary[at(boundary)];
    return body < 0 ? driven.emplace_back(Body{.boundary = boundary}) : driven[at(body)];
  };
  for (std::size_t i = 0; i < system.radius.size(); ++i)
    if (const Index boundary = system.driven_by[i]; boundary < 0)
      bodies_.push_back({.grains = {i}});
    else
      body_of(boundary).grains.push_back(i);
  for (Index w = 0; w < count(system.walls); ++w) {
    const Index boundary = system.walls[at(w)].boundary;
    Body* body = &body_of(boundary);
    const auto plank = [&](std::size_t one) { return system.walls[one].plank(); };
    if (const bool first = body->walls.empty() && body->grains.empty(); !first && free_body(*body) == nullptr)
      body = &driven.emplace_back(Body{.boundary = boundary});
    else if (!first && !(space_ && plank(at(w)) && std::ranges::all_of(body->walls, plank)))
      fail("LMGC90: boundary '{}': expected a free body of one wall, plank or cylinder, or of grains{}, met several",
           system.boundaries[at(boundary)].name, space_ ? " and planks" : "");
    body->walls.push_back(at(w));
  }
  bodies_.insert(bodies_.end(), driven.begin(), driven.end());
  constexpr Index most = 99'999;  // their numbers have five columns
  if (count(bodies_) > most) fail("LMGC90: expected at most {} bodies, met {}", most, bodies_.size());
  places_.resize(system.radius.size() + system.walls.size());
  Index number = 0;
  for (const Body& body : bodies_) {
    if (const Index many = count(body.grains) + count(body.walls); many > most)
      fail("LMGC90: expected at most {} contactors in a body, met {}", most, many);
    Index contactor = 0;
    ++number;
    for (const std::size_t i : body.grains) places_[i] = {number, ++contactor};
    for (const std::size_t w : body.walls) places_[at(system.grains()) + w] = {number, ++contactor};
  }
}

const FreeBody* DatboxWriter::free_body(const Body& body) const {
  if (body.boundary < 0) return nullptr;
  const std::optional<FreeBody>& free = first_.system.boundaries[at(body.boundary)].body;
  return free ? &*free : nullptr;
}

Eigen::Matrix3d DatboxWriter::inertia_in(const FreeBody& free, const Body& body, const Eigen::Matrix3d& frame) const {
  const Eigen::Matrix3d axes = frame.transpose() * principal_axes(free, first_.state.poses[at(body.boundary)]);
  return axes * datbox_vector(free.inertia).asDiagonal() * axes.transpose();
}

// A node of several disks at 0 would make LMGC90 compute another node: its angle is not exactly 0.
DatboxWriter::Node DatboxWriter::node_of(const Body& body, const GranularState& state) const {
  if (body.wall() >= 0) return plank_node(at(body.wall()), state.poses[at(body.boundary)]);
  if (const FreeBody* free = free_body(body); space_ && free != nullptr) {
    const Pose& pose = state.poses[at(body.boundary)];
    return {{pose.x, pose.y, pose.z}, principal_axes(*free, pose)};
  }
  if (space_) {
    const std::size_t i = body.grains[0];
    const Eigen::Quaterniond turn(state.turn_w[i], state.turn_x[i], state.turn_y[i], state.turn_z[i]);
    return {centre(state, i), turn.toRotationMatrix()};
  }
  if (body.boundary < 0) return {centre(state, body.grains[0]), Eigen::Matrix3d::Identity()};
  constexpr double almost_none = 1e-30;
  const Pose& pose = state.poses[at(body.boundary)];
  return {{pose.x, pose.y, 0},
          Eigen::Matrix3d::Identity(),
          pose.x == 0 && pose.y == 0 && pose.angle == 0 ? almost_none : pose.angle};
}

DatboxWriter::WallKind DatboxWriter::wall_kind(std::size_t wall) const {
  const Wall& one = first_.system.walls[wall];
  if (!one.round()) return space_ ? WallKind{"PLANx", "SPPLx"} : WallKind{"JONCx", "DKJCx"};
  if (!space_) return {"xKSID", "DKKDx"};
  return one.radius > 0 ? WallKind{"DNLYC", "SPDCx"} : WallKind{"CYLND", "SPCDx"};
}

std::vector<DatboxWriter::WallKind> DatboxWriter::wall_kinds() const {
  std::vector<WallKind> kinds;
  for (std::size_t w = 0; w < planks_.size(); ++w)
    if (const WallKind one = wall_kind(w); std::ranges::find(kinds, one.contact, &WallKind::contact) == kinds.end())
      kinds.push_back(one);
  return kinds;
}

// Walls have no ends: a plank extends beyond all grains of the first step by the size of the packing. The middle of a
// plank that does not turn faces that of the grains.
void DatboxWriter::lay_plank(std::size_t wall, double beyond) {
  const Wall& one = first_.system.walls[wall];
  const Motion& motion = first_.system.boundaries[at(one.boundary)].motion;
  const Vector3 normal = datbox_vector(one.normal);
  Plank& plank = planks_[wall];
  if (one.plank()) {
    plank.thickness = one.radius;
    plank.length = one.half_length;
    plank.width = one.half_width;
    plank.frame << datbox_vector(one.axis), normal.cross(datbox_vector(one.axis)), normal;
    return;
  }
  if (space_) {
    const Vector3 along = datbox_vector(tangents_of(one.normal).first).normalized();
    plank.frame << along, normal.cross(along), normal;
  }
  plank.thickness = margin_;
  if (one.round())
    plank.shift_along = one.has_ends() ? 0 : (datbox_vector(motion.centre) - datbox_vector(one.point)).dot(normal);
  else if (turns(motion)) {
    // A wall that turns about a point on it is a plank whose thickness is lost in seven digits.
    const double thin = 1e-7 * margin_, depth = (datbox_vector(one.point) - datbox_vector(motion.centre)).dot(normal);
    plank.thickness = depth > -thin ? std::max(depth, thin) : 0;
  }
  const Node node = plank_node(wall, first_.state.poses[at(one.boundary)]);
  Vector3 from = Vector3::Constant(infinity), to = -from;
  for (std::size_t i = 0; i < first_.system.radius.size(); ++i) {
    const Vector3 place = node.frame.transpose() * (centre(first_.state, i) - node.place);
    from = from.cwiseMin(place);
    to = to.cwiseMax(place);
  }
  if (one.round()) {
    plank.length = one.has_ends() ? one.half_length : std::max(-from[2], to[2]) + beyond;
    return;
  }
  if (!turns(motion)) {
    plank.shift_along = (from[0] + to[0]) / 2;
    plank.shift_across = (from[1] + to[1]) / 2;
  }
  plank.length = std::max(std::abs(from[0] - plank.shift_along), std::abs(to[0] - plank.shift_along)) + beyond;
  plank.width = std::max(std::abs(from[1] - plank.shift_across), std::abs(to[1] - plank.shift_across)) + beyond;
}

// The wall is the front face of the plank. A plank that turns has its middle, and its node, at the point that it turns
// about. The others are shifted along the wall, see lay_plank.
DatboxWriter::Node DatboxWriter::plank_node(std::size_t wall, const Pose& pose) const {
  const Plank& plank = planks_[wall];
  const Motion& motion = first_.system.boundaries[at(first_.system.walls[wall].boundary)].motion;
  const Wall& still = first_.system.walls[wall];
  const Wall now = moved(still, motion, pose);
  Node node{{pose.x, pose.y, pose.z}, pose.turn.toRotationMatrix() * plank.frame};
  if (!space_) {
    node.angle = std::atan2(-now.normal[0], now.normal[1]);
    node.frame << Vector3(std::cos(node.angle), std::sin(node.angle), 0), Vector3::UnitZ(), datbox_vector(now.normal);
  }
  if (!space_ && still.round()) node.angle = pose.angle;
  if (still.radius != 0)
    node.place = datbox_vector(now.point) + (still.plank() ? 0 : plank.shift_along) * datbox_vector(now.normal);
  else if (!turns(motion))
    node.place = datbox_vector(now.point) - plank.thickness * node.frame.col(2) +
                 plank.shift_along * node.frame.col(0) + plank.shift_across * node.frame.col(1);
  return node;
}

}  // namespace nscdd
