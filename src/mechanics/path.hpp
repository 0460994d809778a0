// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/configuration.hpp"

namespace nscdd {

/// Positions of all bodies from one check of the geometry to the next. Grains move straight from each place to the next
/// one. The last place is the one that is checked.
template <int D>
struct Path {
  std::vector<double> times;             ///< s, ascending, relative to the state
  std::vector<Configuration<D>> places;  ///< at these times
  bool begins_run = false;               ///< no contact was sought at its beginning
  std::size_t bend = 0;                  ///< place where boundaries take another velocity; 0 where none does
  double reach = 0;                      ///< m: no grain moves by more relative to another or to a wall

  /// Whether pairs must be followed. If not, nothing moves far enough to matter, and the path has one place.
  bool followed() const { return places.size() > 1; }

  /// To q_m, where the contacts of the next step are found: from q_m of the step before, in the first step of a run
  /// from q^-. It has one place unless something moves far enough to matter.
  static Path to_contacts(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme);
  /// The same followed in any case, and on for another step as if nothing were met, if `onwards`.
  static Path whole(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme, bool onwards);
  /// From q_m to the end of a step. `after`: the state there.
  static Path to_end(const GranularSystem& system, const GranularState& after, const TimeStepping& scheme);
  /// Whether, with the velocities of all grains at the end of a step, nothing moves far enough from q_m to the end to
  /// make separate bodies overlap too far.
  static bool is_short(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme,
                       const std::vector<GrainUnknowns<D>>& velocities);
};

/// The line of centres of two grains that met may turn by this angle, rad, before contacts are found: then their normal
/// there is right to 0.1 rad. A pair that touches and leaves in between approaches at most at the speed
/// v sin(largest_turn / 2), 5 % of its relative speed v, which is an error of the same size.
inline constexpr double largest_turn = 0.1;

}  // namespace nscdd
