// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/path.hpp"

#include <optional>

namespace nscdd {

/// Safety factor of proposed time steps: overlaps and moves stay below this part of what is accepted, because speeds
/// differ a little in the next run.
inline constexpr double safe_part = 0.9;

/// What happened to two bodies on their way.
template <int D>
struct Passage {
  /// If they overlap too far at the end, or did so on the path; also if a boundary reversed on the path, so that what
  /// it hit before would not be found.
  std::optional<DeepOverlap> deep = {};
  /// From a to b where they met, if the line of centres has turned by more than largest_turn since.
  std::optional<Direction<D>> normal = {};

  /// Follows grain a and body b, which is another grain or the wall grains() + its number, to the end of the path,
  /// where their gap is `gap`, m. What a boundary drives is seen from there: a grain that rides on a boundary does not
  /// move.
  static Passage of(const GranularSystem& system, const Path<D>& path, Index a, Index b, double gap);
  /// The bodies that overlap too far at the end of the path, or did so on it, in no order.
  static std::vector<DeepOverlap> too_deep(const GranularSystem& system, const Path<D>& path);
};

}  // namespace nscdd
