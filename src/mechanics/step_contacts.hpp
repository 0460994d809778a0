// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/passage.hpp"

namespace nscdd {

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
/// Passage), have the normal with which they met, and gap 0 if they are apart again. Under a condition on the gap the
/// same holds for grains that move far in a step and meet before its end; grains that miss each other are no contact.
/// Under one on the velocity contacts act once they touch. No contact has two bodies that are both driven along its
/// normal. Throws Error naming the grain if one would move by more than ten of its radii in the step or has a velocity
/// that is not finite, and naming both grains if two have the same centre. Bodies may overlap, see check_overlaps.
ConsideredContacts for_each_step_contact(const StepStart& start, const std::function<void(const StepContact&)>& visit);

/// The point of the surface of one of its bodies where a contact acts, m; in a periodic cell the image at its body.
Place contact_point(const GranularSystem& system, const Configuration& where, const StepContact& contact, Index body);

/// The levers of a contact with a body with free directions; null for others. Rows of tangential impulses that move
/// nothing are 0, see Levers::rubs. With friction, throws Error naming both bodies if W is singular in another way.
template <int D>
std::shared_ptr<const Levers<D>> levers_of(const StepStart& start, const Configuration& where,
                                           const StepContact& contact);

/// Coulomb's coefficient of a contact, by the rule of its colours if there is one. `slid`: in the last step.
double friction_of(const StepStart& start, const StepContact& contact, bool slid);

/// Whether bodies hold each other under a law that pulls: in touch (touching_gap) or in Interaction::cohesion_range.
bool hold(const GranularSystem& system, const Interaction& interaction, const StepContact& contact);

/// The bond that a contact is (PairRule::bond), if it is one: a known bond, or a new one where the gap is at most the
/// alert distance, or bodies touch (touching_gap).
std::optional<RememberedBond> bond_of(const StepStart& start, const StepContact& contact, double alert_distance);
double alert_distance(const GranularSystem& system, const TimeStepping& scheme);  ///< m

/// Overlaps of the contacts of a step at q_m, before it is solved.
struct Interpenetration {
  double maximum = 0, mean = 0;  ///< m, over the contacts that overlap; 0 if none does
  double relative = 0;           ///< the largest ratio of an overlap to the smaller radius of its two bodies
};

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
