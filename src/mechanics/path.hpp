// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/time_stepping.hpp"

namespace nscdd {

/// Where everything is at one time.
struct Configuration {
  std::vector<double> x, y, z;         ///< of every grain, m
  std::vector<Wall> walls;             ///< moved
  std::vector<Pose> poses;             ///< of boundaries
  std::vector<RigidVelocity> motions;  ///< of boundaries in this step

  Place centre(std::size_t i) const { return {x[i], y[i], z.empty() ? 0 : z[i]}; }
  /// Of a wall at a point of it, m/s.
  Place velocity(const Wall& wall, const Place& point) const {
    return velocity_of_point(motions[at(wall.boundary)], poses[at(wall.boundary)], point);
  }
};

/// Where everything is `time` after the state, at the velocities of the state and those of the boundaries; and at q_m,
/// where the contacts of a step are found.
Configuration configuration(const StepStart& start, const std::vector<RigidVelocity>& motions, double time);
Configuration where_contacts_are(const StepStart& start);

/// Where a grain meets a wall: the nearest point of the wall, and the distance of the centre, > 0 on the grains' side.
struct WallPoint {
  Place foot, normal;  ///< the normal points to the grain
  double height;       ///< m
};
WallPoint nearest_point(const Wall& wall, const Place& centre);

/// Positions of all bodies from one check of the geometry to the next. Grains move straight from each place to the next
/// one. The last place is the one that is checked.
struct Path {
  const GranularSystem& system;
  std::vector<double> times = {};          ///< s, ascending, relative to the state
  std::vector<Configuration> places = {};  ///< at these times
  bool begins_run = false;                 ///< no contact was sought at its beginning
  std::size_t bend = 0;                    ///< place where boundaries take another velocity; 0 where none does
  double reach = 0;                        ///< m: no grain moves by more relative to another or to a wall

  /// Whether pairs must be followed. If not, nothing moves far enough to matter, and the path has one place.
  bool followed() const { return places.size() > 1; }

  /// To q_m, where the contacts of the next step are found: from q_m of the step before, in the first step of a run
  /// from q^-. It has one place unless something moves far enough to matter.
  static Path to_contacts(const StepStart& start);
  /// The same followed in any case, and on for another step as if nothing were met, if `onwards`.
  static Path whole(const StepStart& start, bool onwards);
  /// From q_m to the end of a step. `after`: with the state there.
  static Path to_end(const StepStart& after);
};

/// Whether, with the velocities of all grains at the end of a step, nothing moves far enough from q_m to the end to
/// make separate bodies overlap too far.
bool end_is_near(const StepStart& start, const std::vector<GrainMotion>& velocities);

/// The line of centres of two grains that met may turn by this angle, rad, before contacts are found: then their normal
/// there is right to 0.1 rad. A pair that touches and leaves in between approaches at most at the speed
/// v sin(largest_turn / 2), 5 % of its relative speed v, which is an error of the same size.
inline constexpr double largest_turn = 0.1;

/// Overlap that ends a run, as bodies would pass each other, and one that deserves attention, times the smaller radius.
inline constexpr double largest_overlap = 0.5, notable_overlap = 0.1;

}  // namespace nscdd
