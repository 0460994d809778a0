// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/path.hpp"

#include <optional>

namespace nscdd {

/// Safety factor of proposed time steps: overlaps and moves stay below this part of what is accepted, because speeds
/// differ a little in the next run.
inline constexpr double safe_part = 0.9;

/// Under a law that pulls, bodies touch if their gap at q_m is at most this part of the smaller radius: far more than
/// the gaps of rounding, unfinished iterations or a rolling contact, and far less than the alert distance, which must
/// have no effect.
inline constexpr double touching_gap = 1e-3;

/// Two bodies that overlap by more than largest_overlap times the smaller radius, or did so since contacts were found
/// last (in the first step of a run: since it began).
struct DeepOverlap {
  Index a = 0, b = 0;         ///< grains a < b, or wall b = disks + w
  double overlap = 0;         ///< the largest, m
  double before = 0;          ///< when contacts were found last, m; negative: a gap
  double path = 0, time = 0;  ///< of one body seen from the other since then, m and s
  double reached = infinity;  ///< s, from then until the overlap was nearly as large as is accepted
};

/// What happened to two bodies on their way.
struct Passage {
  /// If they overlap too far at the end, or did so on the path; also if a boundary reversed on the path, so that what
  /// it hit before would not be found.
  std::optional<DeepOverlap> deep = {};
  /// From a to b where they met, if the line of centres has turned by more than largest_turn since.
  std::optional<Place> normal = {};

  /// Follows grain a and body b, which is another grain or the wall grains() + its number, to the end of the path,
  /// where their gap is `gap`, m. What a boundary drives is seen from there: a grain that rides on a boundary does not
  /// move.
  static Passage of(const Path& path, Index a, Index b, double gap);
  /// The bodies that overlap too far at the end of the path, or did so on it, in no order.
  static std::vector<DeepOverlap> too_deep(const Path& path);
};

/// The part of `move` after which the vector `from`, longer than `end` at first, has the length `end`; none if that is
/// more than `most`.
std::optional<double> part_until(const Place& from, const Place& move, double end, double most = 1);

}  // namespace nscdd
