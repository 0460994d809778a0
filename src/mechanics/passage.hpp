// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/path.hpp"

namespace nscdd {

/// Under a law that pulls, bodies touch if their gap at q_m is at most this part of the smaller radius: far more than
/// gaps by rounding, unfinished iterations or rolling, and far less than the alert distance, which must have no effect.
inline constexpr double touching_gap = 1e-3;

/// Two bodies with an overlap > largest_overlap x the smaller radius, now or since contacts were last found.
struct DeepOverlap {
  Index a = 0, b = 0;         ///< grains a < b, or wall b = disks + w
  double overlap = 0;         ///< the largest, m
  double before = 0;          ///< when contacts were last found, m; negative: a gap
  double path = 0, time = 0;  ///< of one body seen from the other since then, m and s
  double reached = infinity;  ///< s, from then until the overlap was nearly the largest accepted one
};

/// What happened to two bodies on their path.
struct Passage {
  /// If they overlap too far at the end of the path or on it, or a boundary turned back on it and hid what it hit.
  std::optional<DeepOverlap> deep = {};
  /// From a to b where they met, if the line of centres has turned by more than largest_turn since.
  std::optional<Place> normal = {};

  /// Follows grain a and body b, which is another grain or the wall grains() + its number, to the end of the path,
  /// where their gap is `gap`, m. If a boundary drives one of them, motion is relative to the boundary.
  static Passage of(const Path& path, Index a, Index b, double gap);
  /// The bodies that overlap too far at the end of the path, or did so on it, in no order.
  static std::vector<DeepOverlap> too_deep(const Path& path);
};

/// The smallest s with |from + s move| = end, for |from| > end; empty if there is none up to `most`.
std::optional<double> part_until(const Place& from, const Place& move, double end, double most = 1);

}  // namespace nscdd
