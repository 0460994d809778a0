// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/granular_system.hpp"
#include <nscdd/core/components.hpp>
#include <nscdd/core/fields.hpp>

#include <functional>

namespace nscdd {

struct GlobalFrictionProblem;

/// Moreau-Jean scheme at velocity level, step h:
///     q_m = q^- + (1 - theta) h V^-              contacts are found here
///     M (V - V^-) = h F + H r,  law(H^T V, r)    solved by Gauss-Seidel sweeps, whole or decomposed
///     q   = q_m + theta h V
/// q_m moves by exactly h V from one step to the next, so v_n + gap/h >= 0 keeps it free of overlap. Where
/// bodies overlap already, the contact asks for v_n >= min(penetration_correction |gap|/h, push speed).
struct TimeStepping {
  double step = 0.005;  ///< h, s
  Index steps = 100;
  double theta = 0.5;
  Components<double> gravity{0, -9.81};  ///< see gravity_of
  double alert = 0.05;
  double penetration_correction = 1;
  double maximum_push_speed = -1;  ///< m/s; see push_speed
  double rest_speed = 0;           ///< m/s

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("step", self.step, Field{.description = "time step", .unit = "s", .minimum = 0, .minimum_excluded = true});
    visit("steps", self.steps, Field{.description = "number of time steps", .minimum = 0, .maximum = 1e9});
    visit("theta", self.theta,
          Field{.description = "weight of the velocity at the end of a step", .minimum = 0.5, .maximum = 1});
    visit(
        "gravity", self.gravity,
        Field{.description = "acceleration of free grains; by default downwards, along -y in the plane and -z in space",
              .unit = "m/s^2"});
    visit("alert", self.alert,
          Field{.description = "contacts are considered whose gap is below this, or comes below it within the "
                               "step, times the smallest radius",
                .minimum = 0,
                .maximum = 10});
    visit("penetration_correction", self.penetration_correction,
          Field{.description = "part of an overlap removed per step (restitution 0)", .minimum = 0, .maximum = 1});
    visit("maximum_push_speed", self.maximum_push_speed,
          Field{.description = "largest speed at which an overlap is pushed apart (restitution 0); -1: 0.02 "
                               "(sqrt(g r) + w), r the smaller radius, w the speed of the fastest boundary",
                .unit = "m/s",
                .minimum = 0,
                .also = -1});
    visit("rest_speed", self.rest_speed,
          Field{.description = "the run ends once free grains are slower for 10 steps: root mean square "
                               "weighted by mass, spin included; 0 for never",
                .unit = "m/s",
                .minimum = 0});
  }
};

/// Gravity in a system of dimension D. The default is downwards there: along -z in space.
template <int D>
Direction<D> gravity_of(const TimeStepping& scheme) {
  if constexpr (D == 2)
    return {scheme.gravity[0], scheme.gravity[1]};
  else if (scheme.gravity == TimeStepping().gravity)
    return {0, 0, scheme.gravity[1]};
  else
    return {scheme.gravity[0], scheme.gravity[1], scheme.gravity[2]};
}

/// Under a law that pulls, bodies touch if their gap at q_m is at most this part of the smaller radius: far more than
/// the gaps of rounding, unfinished iterations or a rolling contact, and far less than the alert distance, which must
/// have no effect.
inline constexpr double touching_gap = 1e-3;

/// Geometry of a contact considered in a step.
struct StepContact {
  Index a = 0, b = 0;              ///< grains a < b, or wall b = disks + w
  std::array<double, 3> normal{};  ///< from a to b; in the plane the third number is 0
  std::array<double, 3> point{};   ///< middle of the centres of two grains; the foot on a wall, m
  double gap = 0;                  ///< m, at q_m
};

/// The contact problem of one step. Bodies are grains, then one per wall contact, which moves as the wall there. If
/// several processes share a step, the part of each has only the grains of its own contacts.
template <int D>
struct StepProblem {
  ContactLaw law;                              ///< of all contacts
  double scale = 0;                            ///< W, the mean of the W_nn of the contacts, 1/kg; 0 without contacts
  double friction = 0, boundary_friction = 0;  ///< between free disks; between a free and a driven one
  bool tangential_bias = false;                ///< whether contacts have a bias_t (tangential restitution)
  bool pulls = false;                          ///< whether the law pulls; then contacts that touch have a pull
  double h = 0;                                ///< s
  std::vector<StepContact> geometry;           ///< ascending by (a, b)
  std::vector<GrainContact<D>> contacts;       ///< the same contacts for the solver, impulses to start from
  std::vector<GrainVelocity<D>> start;         ///< V^- of the bodies (of driven ones: in this step)
  std::vector<GrainVelocity<D>> free;          ///< V^- + h M^-1 F
  /// What each body is: a grain by its number, ascending, or disks + k for the k-th body of a wall. Of a whole step
  /// these are 0, 1, 2, ...
  std::vector<std::int32_t> numbers;
};

/// The body that a grain is in a step, -1 if none of the contacts of this part of a step touches it.
template <int D>
Index body_of(const StepProblem<D>& problem, Index grain) {
  const auto number = static_cast<std::int32_t>(grain);
  if (grain < count(problem.numbers) && problem.numbers[at(grain)] == number) return grain;
  const auto found = std::lower_bound(problem.numbers.begin(), problem.numbers.end(), number);
  return found != problem.numbers.end() && *found == number ? found - problem.numbers.begin() : -1;
}

/// Finds contacts and sets the problem up. Impulses start from those of the last step if `warm_start`, otherwise from
/// zero. Throws Error naming the disk if one would move by more than ten of its radii in the step or has a velocity
/// that is not finite, and naming both disks if two have the same centre. Bodies that overlap too far are accepted
/// unless `shallow`; see check_overlaps.
template <int D>
StepProblem<D> prepare_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                            const TimeStepping& scheme, bool warm_start, bool shallow = false);

/// Two bodies that overlap by more than largest_overlap times the smaller radius, or did so since contacts were found
/// last (in the first step of a run: since it began).
struct DeepOverlap {
  Index a = 0, b = 0;         ///< grains a < b, or wall b = disks + w
  double overlap = 0;         ///< the largest, m
  double before = 0;          ///< when contacts were found last, m; negative: a gap
  double path = 0, time = 0;  ///< of one body seen from the other since then, m and s
  double reached = infinity;  ///< s, from then until the overlap was nearly as large as is accepted
};

/// What a step considers.
struct ConsideredContacts {
  Index number = 0;
  double boundary_speed = 0;      ///< of the fastest driven grain, or wall at one of its contacts, m/s
  std::vector<DeepOverlap> deep;  ///< in no order
};

/// The two halves of prepare_step, for a process that keeps only some contacts. The first calls visit(contact) for
/// every contact that the step considers, in no order, and throws as prepare_step does.
template <int D>
ConsideredContacts for_each_step_contact(const GranularSystem& system, const GranularState& state,
                                         const Interaction& interaction, const TimeStepping& scheme,
                                         const std::function<void(const StepContact&)>& visit);
/// The second sets up the problem of the contacts in `geometry`, ascending by (a, b), with the grains `grains`,
/// ascending, which must be those of these contacts at least. Impulses start from those in `last`, ascending by (a, b).
template <int D>
StepProblem<D> step_of_contacts(const GranularSystem& system, const GranularState& state,
                                const Interaction& interaction, const TimeStepping& scheme,
                                std::vector<StepContact> geometry, double boundary_speed,
                                std::vector<std::int32_t> grains, const std::vector<RememberedImpulse>& last);

/// Sets the scale W, 1/kg, and the law that depends on it; without this call W is that of the contacts of the problem.
template <int D>
void set_scale(StepProblem<D>& problem, const Interaction& interaction, double scale);

/// V^- + h M^-1 F of a free grain, or the velocity of a driven one in this step; of every grain, also of those that
/// touch nothing. `motions`: those of the boundaries in the step, see step_motions.
template <int D>
GrainVelocity<D> free_velocity(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme,
                               const std::vector<RigidVelocity>& motions, Index grain);
std::vector<RigidVelocity> step_motions(const GranularSystem& system, const GranularState& state,
                                        const TimeStepping& scheme);

/// What was remembered of each contact, or null. Both lists ascend by (a, b).
template <class Remembered>
std::vector<const Remembered*> remembered(const std::vector<Remembered>& last,
                                          const std::vector<StepContact>& contacts) {
  std::vector<const Remembered*> result;
  auto old = last.begin();
  for (const StepContact& c : contacts) {
    while (old != last.end() && std::pair(old->a, old->b) < std::pair(c.a, c.b)) ++old;
    const bool known = old != last.end() && old->a == c.a && old->b == c.b;
    result.push_back(known ? &*old : nullptr);
  }
  return result;
}

/// Speed at which two bodies that overlap are pushed apart at the most, m/s: `maximum_push_speed`, or where that is
/// negative c (sqrt(g r) + w), c = natural_push_speed, with the smaller radius r, g = |gravity| and the speed w of the
/// fastest boundary. A push of bodies at rest brings at most c^2/2 of the energy m g r that lifts a grain by its
/// radius. Where N overlaps follow each other from a support, their speeds add up, and a column gains c^2 N/12 of its
/// weight times its height: 0.3 % for a hundred grains, whatever the overlaps, the grains and the step. Without gravity
/// and with boundaries at rest overlaps stay.
double push_speed(const TimeStepping& scheme, double smaller_radius, double boundary_speed);
inline constexpr double natural_push_speed = 0.02;

/// Overlap that ends a run, as bodies would pass each other, and one that deserves attention, times the smaller radius.
inline constexpr double largest_overlap = 0.5, notable_overlap = 0.1;

/// Throws Error if bodies overlap too far where the contacts of the next step are found, or on their way there. It
/// names the bodies of the first such contact; or, where bodies came together because the step is too long, the step,
/// how far they move, and a step that is short enough. `deep`: as ConsideredContacts has them.
template <int D>
void check_overlaps(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                    const TimeStepping& scheme, const std::vector<DeepOverlap>& deep);

/// The same of the path from there to the end of the step, with the velocities of all grains at its end.
template <int D>
void check_end_of_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                       const TimeStepping& scheme, const std::vector<GrainUnknowns<D>>& velocities);

/// A time step, s, no longer than that of the scheme, at which the next step moves no grain too far and brings no
/// bodies together that overlap too far. Velocities must be finite.
template <int D>
double safe_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                 const TimeStepping& scheme);

/// Largest motion of a grain in a step, in radii. No grid finds the contacts of grains that move further.
inline constexpr double largest_move = 10;

/// V_free + M^-1 H r for the impulses of the contacts.
template <int D>
std::vector<GrainVelocity<D>> velocities_of(const StepProblem<D>& problem,
                                            const std::vector<GrainContact<D>>& contacts);

/// What a step did to the energy of the free disks, J:
///     change of kinetic + potential = boundary_work - dissipation + numerical.
struct StepEnergy {
  double kinetic = 0, potential = 0;  ///< at the end of the step
  double boundary_work = 0;           ///< done by driven disks and walls
  double dissipation = 0;             ///< - sum r . (v + v^-)/2 over contacts
  double numerical = 0;               ///< what is left; at theta = 1/2 only rounding
};

/// What the impulse of a contact did in a step, J.
struct ContactWork {
  double boundary = 0;     ///< done by the bodies of it that are driven
  double dissipation = 0;  ///< - r . (v + v^-)/2
};
template <int D>
ContactWork work_of(const StepProblem<D>& problem, const GrainContact<D>& contact,
                    const std::vector<GrainVelocity<D>>& velocities);

/// The impulses that are not zero, to be kept for the next step; `contacts` are those of the problem.
template <int D>
std::vector<RememberedImpulse> impulses_to_remember(const StepProblem<D>& problem,
                                                    const std::vector<GrainContact<D>>& contacts);

/// Ends a step: moves all grains, whose velocities at its end are given, and boundaries. `work`: of all contacts.
template <int D>
StepEnergy finish_step(const GranularSystem& system, GranularState& state, const TimeStepping& scheme,
                       const std::vector<GrainUnknowns<D>>& velocities, const ContactWork& work);

/// Kinetic and potential energy of the free disks.
StepEnergy energy_of(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme);

/// Overlaps of the contacts of a step at q_m, before it is solved.
struct Interpenetration {
  double maximum = 0, mean = 0;  ///< m, over the contacts that overlap; 0 if none does
  double relative = 0;           ///< the largest ratio of an overlap to the smaller radius of its two bodies
};
Interpenetration interpenetration(const GranularSystem& system, const std::vector<StepContact>& contacts);

/// The contact problem of a step in the unknowns (v_x, v_y, spin) of its free bodies, three rows each in their order,
/// in space (v, spin) with six, as other programs have it:
///     M = diag(m, m, m R^2 / 2), in space diag(m, m, m, 2/5 m R^2 I_3),   f = M V_free,   M v = H r + f,   u = H^T v +
///     w.
/// The law acts on u: w holds its biases (gap / h, restitution) and the velocities of driven bodies, which have no
/// rows. In the rows of spin a tangential column has the lever arm, -R. `bodies`: V_free and inverse masses. `radius`:
/// of each body, m; it may end before the driven bodies at the end (walls have no radius).
template <int D>
GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<D>>& bodies,
                                       const std::vector<GrainContact<D>>& contacts, std::span<const double> radius);

}  // namespace nscdd
