// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries and grains as bodies of LMGC90: their numbers, nodes and axes.
#include "core/fail.hpp"
#include "formats/lmgc90/datbox_writer.hpp"
#include "mechanics/contact_frame.hpp"

namespace nscdd {

void DatboxWriter::number_bodies() {
  const GranularSystem& system = first_.system;
  std::vector<Body> driven;  // one per boundary; in space one per driven sphere and wall
  std::vector<Index> of_boundary(system.boundaries.size(), -1);
  for (std::size_t b = 0; b < of_boundary.size(); ++b) {
    if (space_ && !system.boundaries[b].body) continue;
    of_boundary[b] = count(driven);
    driven.push_back({.boundary = static_cast<Index>(b), .grains = {}});
  }
  for (std::size_t i = 0; i < system.radius.size(); ++i) {
    const Index boundary = system.driven_by[i];
    if (boundary < 0)
      bodies_.push_back({.grains = {i}});
    else if (of_boundary[at(boundary)] < 0)
      driven.push_back({.boundary = boundary, .grains = {i}});
    else
      driven[at(of_boundary[at(boundary)])].grains.push_back(i);
  }
  for (Index w = 0; w < count(system.walls); ++w) {
    const Index boundary = system.walls[at(w)].boundary;
    if (of_boundary[at(boundary)] < 0)
      driven.push_back({.boundary = boundary, .wall = w, .grains = {}});
    else
      driven[at(of_boundary[at(boundary)])].wall = w;
  }
  bodies_.insert(bodies_.end(), driven.begin(), driven.end());
  constexpr Index most = 99'999;  // their numbers have five columns
  if (count(bodies_) > most) fail("LMGC90: expected at most {} bodies, met {}", most, bodies_.size());
  places_.resize(system.radius.size() + system.walls.size());
  Index number = 0;
  for (const Body& body : bodies_) {
    if (count(body.grains) > most)
      fail("LMGC90: expected at most {} contactors in a body, met {}", most, body.grains.size());
    Index contactor = 0;
    ++number;
    for (const std::size_t i : body.grains) places_[i] = {number, ++contactor};
    if (body.wall >= 0) places_[at(system.grains() + body.wall)] = {number, 1};
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
  if (body.wall >= 0) return plank_node(at(body.wall), state.poses[at(body.boundary)]);
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

}  // namespace nscdd
