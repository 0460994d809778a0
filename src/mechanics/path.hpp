// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/time_stepping.hpp"

namespace nscdd {

/// Places and motions of all bodies at one time.
struct Configuration {
  std::vector<double> x, y, z;         ///< of every grain, m
  std::vector<Wall> walls;             ///< moved
  std::vector<Pose> poses;             ///< of boundaries
  std::vector<RigidVelocity> motions;  ///< of boundaries, as contacts of this step see them

  Place centre(std::size_t i) const { return {x[i], y[i], z.empty() ? 0 : z[i]}; }
  Place velocity(const Wall& wall, const Place& point) const {
    return velocity_of_point(motions[at(wall.boundary)], poses[at(wall.boundary)], point);
  }
};

/// The configuration where contacts are found.
Configuration where_contacts_are(const StepStart& start);

/// The point of a wall nearest to the centre of a grain, and its distance, > 0 on the grains' side.
struct WallPoint {
  Place foot, normal;  ///< the normal points to the grain
  double height;       ///< m
};
WallPoint nearest_point(const Wall& wall, const Place& centre);
/// The same in a periodic cell: of a plank or cylinder the image counts that is nearest to the grain.
WallPoint nearest_point(const GranularSystem& system, const Wall& wall, const Place& centre);
/// The steps of periods from a wall to that image; 0 of a plane, which has none.
Place image_step(const GranularSystem& system, const Wall& wall, const Place& centre);
/// The nearest point of the segment or rectangle of a plank.
Place nearest_in_plank(const Wall& plank, const Place& p);

/// Largest turn of the line of centres of two grains from their meeting until contacts are found, rad: the error of
/// their normal. A pair that touches and leaves in between approaches at most at 5 % of its relative speed.
inline constexpr double largest_turn = 0.1;

/// Overlap that ends a run, since bodies would pass each other, and one that is reported, times the smaller radius.
inline constexpr double largest_overlap = 0.5, notable_overlap = 0.1;

/// Safety factor of proposed time steps, on the overlaps and moves accepted: speeds differ a little in the next run.
inline constexpr double safe_part = 0.9;

/// Positions of all bodies from one check of the geometry to the next. Grains move straight between places.
struct Path {
  const GranularSystem& system;
  std::vector<double> times = {};          ///< s, ascending, relative to the state
  std::vector<Configuration> places = {};  ///< at these times
  bool begins_run = false;                 ///< contacts were not sought at its beginning
  std::size_t bend = 0;                    ///< place where boundaries change their velocity; 0 if none does
  double reach = 0;                        ///< m: bound of the motion of a grain relative to another or to a wall

  /// Whether pairs must be followed. If not, nothing moves far enough to matter, and the path has one place.
  bool followed() const { return places.size() > 1; }

  /// From q_m of the step before, or q^- in the first step of a run, to q_m of the next step.
  static Path to_contacts(const StepStart& start);
  /// The same followed in any case and, if `onwards`, continued for another step as if nothing were met.
  static Path whole(const StepStart& start, bool onwards);
  static Path to_end(const StepStart& after);  ///< From q_m to the end of a step. `after`: with the state there.
};

/// Whether, at these velocities, nothing moves far enough from q_m to the end of a step to overlap too far.
bool end_is_near(const StepStart& start, const std::vector<GrainMotion>& velocities);

}  // namespace nscdd
