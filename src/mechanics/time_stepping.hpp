// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/granular_system.hpp"

namespace nscdd {

/// Instant of a step whose velocities of boundaries its contacts see: its middle, whose velocity then holds for the
/// whole step; or its end, as in LMGC90, with (1 - theta) v(t) + theta v(t + h) as the mean of the step.
enum class BoundaryInstant { middle, end };
constexpr auto names_of(BoundaryInstant) { return std::to_array<std::string_view>({"middle", "end"}); }

/// Moreau-Jean scheme at velocity level, step h:
///     q_m = q^- + (1 - theta) h V^-              contacts are found here
///     M (V - V^-) = h F + H r,  law(H^T V, r)    solved by Gauss-Seidel sweeps, whole or decomposed
///     q   = q_m + theta h V
/// q_m moves by exactly h V from one step to the next, so v_n + gap/h >= 0 keeps it free of overlap. Bodies that
/// overlap already must obey v_n >= min(penetration_correction |gap|/h, push speed).
struct TimeStepping {
  double step = 0.005;  ///< h, s
  Index steps = 100;
  double theta = 0.5;
  Components<double> gravity{0, -9.81};  ///< see gravity_of
  double alert = 0.05;
  double penetration_correction = 1;
  double maximum_push_speed = -1;  ///< m/s; see step_problem.cpp
  double rest_speed = 0;           ///< m/s
  Choice<BoundaryInstant> boundary_instant;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("step", self.step, Field{.description = "time step", .unit = "s", .above = 0});
    visit("steps", self.steps, Field{.description = "number of time steps", .minimum = 0, .maximum = 1e9});
    visit("theta", self.theta,
          Field{.description = "weight of the velocity at the end of a step", .minimum = 0.5, .maximum = 1});
    visit(
        "gravity", self.gravity,
        Field{.description = "acceleration of free grains; by default downwards, along -y in the plane and -z in space",
              .unit = "m/s^2"});
    visit("alert", self.alert,
          Field{.description = "gap, in smallest radii, below which a contact is considered, now or within the step",
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
    visit("boundary_instant", self.boundary_instant,
          Field{.description = "instant of a step whose velocities of boundaries its contacts see"});
  }
};

/// Gravity in a system of that dimension. The default in space is along -z.
Place gravity_of(const TimeStepping& scheme, Index dimension);

struct StepStart {
  const GranularSystem& system;
  const GranularState& state;
  const Interaction& interaction;
  const TimeStepping& scheme;
};

/// Velocities of boundaries that contacts of a step see, along free directions V^- + h M^-1 F with the mean force
/// (1 - theta) F(t) + theta F(t + h); and those that lead to q_m, where contacts are found: the same, or with
/// BoundaryInstant::end those at the beginning of the step, in the first step Motion::initial, and V^- along free
/// directions. In space a body that turns freely keeps its angular momentum on the way to q_m.
std::vector<RigidVelocity> step_motions(const StepStart& start);
std::vector<RigidVelocity> first_motions(const StepStart& start);

/// Poses of boundaries at q_m, where contacts are found: their arms and principal axes are those of the step.
std::vector<Pose> poses_at_contacts(const StepStart& start);

/// V^-, the velocity of a body of a step as it begins (if driven: by `motions`, with its arm at q_m); and
/// V^- + h M^-1 F. Bodies with free directions, after the grains, have those of `motions`. `poses`: poses_at_contacts.
GrainMotion start_motion(const StepStart& start, const std::vector<Pose>& poses,
                         const std::vector<RigidVelocity>& motions, Index number);
GrainMotion free_motion(const StepStart& start, const std::vector<Pose>& poses,
                        const std::vector<RigidVelocity>& motions, Index number);

/// `motions` with the free directions of bodies as in `velocities`, of grains and then of bodies.
std::vector<RigidVelocity> with_free_bodies(const StepStart& start, std::vector<RigidVelocity> motions,
                                            const std::vector<GrainMotion>& velocities);

/// Energy balance of the free grains and bodies in a step, J:
///     change of kinetic + potential = boundary_work - dissipation + numerical.
struct StepEnergy {
  double kinetic = 0, potential = 0;  ///< at the end of the step
  double boundary_work = 0;           ///< done by driven grains and walls, and by loads
  double dissipation = 0;             ///< - sum r . (v + v^-)/2 over contacts
  double numerical = 0;               ///< what is left; at theta = 1/2 only rounding, but for bodies that turn in space
};

/// Work of the impulse of a contact in a step, J.
struct ContactWork {
  double boundary = 0;     ///< done by its driven bodies
  double dissipation = 0;  ///< - r . (v + v^-)/2
};

/// Ends a step: moves boundaries and all grains. `state`: that of `start`. `velocities`: at the end of the step, of all
/// grains and then of free bodies. `work`: of all contacts.
StepEnergy finish_step(const StepStart& start, GranularState& state, const std::vector<GrainMotion>& velocities,
                       const ContactWork& work);

/// Sets kinetic and potential energy only.
StepEnergy energy_of(const GranularSystem& system, const GranularState& state, const TimeStepping& scheme);

}  // namespace nscdd
