// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/time_stepping.hpp"

namespace nscdd {

/// Places and motions of all bodies at one time.
struct Configuration {
  std::vector<double> x, y, z;         ///< of every grain, m
  std::vector<Wall> walls;             ///< moved
  std::vector<Pose> poses;             ///< of boundaries
  std::vector<RigidVelocity> motions;  ///< of boundaries in this step

  Place centre(std::size_t i) const { return {x[i], y[i], z.empty() ? 0 : z[i]}; }
  Place velocity(const Wall& wall, const Place& point) const {
    return velocity_of_point(motions[at(wall.boundary)], poses[at(wall.boundary)], point);
  }
};

/// The configuration `time` after the state, at its velocities and those of boundaries; and where contacts are found.
Configuration configuration(const StepStart& start, const std::vector<RigidVelocity>& motions, double time);
Configuration where_contacts_are(const StepStart& start);

/// The point of a wall nearest to the centre of a grain, and its distance, > 0 on the grains' side.
struct WallPoint {
  Place foot, normal;  ///< the normal points to the grain
  double height;       ///< m
};
WallPoint nearest_point(const Wall& wall, const Place& centre);

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

/// Largest turn of the line of centres of two grains from their meeting until contacts are found, rad: the error of
/// their normal. A pair that touches and leaves in between approaches at most at 5 % of its relative speed.
inline constexpr double largest_turn = 0.1;

/// Overlap that ends a run, since bodies would pass each other, and one that is reported, times the smaller radius.
inline constexpr double largest_overlap = 0.5, notable_overlap = 0.1;

/// Safety factor of proposed time steps, on the overlaps and moves accepted: speeds differ a little in the next run.
inline constexpr double safe_part = 0.9;

/// Under a law that pulls, bodies touch if their gap at q_m is at most this part of the smaller radius: far more than
/// gaps by rounding, unfinished iterations or rolling, and far less than the alert distance, which must have no effect.
inline constexpr double touching_gap = 1e-3;

/// Two bodies with an overlap > largest_overlap x the smaller radius, now or since contacts were found or the run
/// began.
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

struct StepContact {
  Index a = 0, b = 0;              ///< grains a < b, or wall b = disks + w
  std::array<double, 3> normal{};  ///< from a to b; in the plane the third number is 0
  std::array<double, 3> point{};   ///< middle of the centres of two grains; the foot on a wall, m
  double gap = 0;                  ///< m, at q_m
};

struct ConsideredContacts {
  Index number = 0;
  double boundary_speed = 0;      ///< of the fastest driven grain, or wall at one of its contacts, m/s
  std::vector<DeepOverlap> deep;  ///< in no order
};

/// Finds the contacts of a step at q_m and calls visit(contact) for each, in no order: pairs of a free grain and a
/// grain or wall whose gap is within the alert distance, or would be after the step at the velocities V^- + h M^-1 F
/// and those of the boundaries. Pairs that met on the path since contacts were last found, and have turned since (see
/// Passage), have the normal with which they met, and gap 0 if they are apart again. Without restitution the same holds
/// for grains that move far in a step and meet before its end; grains that miss each other are no contact. With
/// restitution contacts act once they touch. Throws Error naming the grain if one would move by more than ten of its
/// radii in the step or has a velocity that is not finite, and naming both grains if two have the same centre. Bodies
/// may overlap, see check_overlaps.
ConsideredContacts for_each_step_contact(const StepStart& start, const std::function<void(const StepContact&)>& visit);

/// Whether the bodies of a contact touch, see touching_gap.
bool touches(const GranularSystem& system, const StepContact& contact);

/// Overlaps of the contacts of a step at q_m, before it is solved.
struct Interpenetration {
  double maximum = 0, mean = 0;  ///< m, over the contacts that overlap; 0 if none does
  double relative = 0;           ///< the largest ratio of an overlap to the smaller radius of its two bodies
};
Interpenetration interpenetration(const GranularSystem& system, const std::vector<StepContact>& contacts);

/// Throws Error if bodies overlap too far where the contacts of the next step are found, or on their path there. It
/// names the bodies of the first such contact or, if the step is too long, the step, how far they move, and a step that
/// is short enough. `deep`: of ConsideredContacts.
void check_overlaps(const StepStart& start, const std::vector<DeepOverlap>& deep);

/// The same for the path from there to the end of the step, where grains have these velocities.
void check_end_of_step(const StepStart& start, const std::vector<GrainMotion>& velocities);

/// A time step, s, at most that of the scheme, without too large moves and overlaps; 0 if the state is not finite.
double safe_step(const StepStart& start);

/// Largest motion of a grain in a step, in radii; no grid would find the contacts of faster grains.
inline constexpr double largest_move = 10;

}  // namespace nscdd
