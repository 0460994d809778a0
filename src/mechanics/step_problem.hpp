// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_residual.hpp"
#include "mechanics/step_contacts.hpp"

namespace nscdd {

struct GlobalFrictionProblem;

/// The contact problem of one step. Bodies are grains, then bodies with free directions, then one per contact of
/// another wall, which moves as the wall there. If ranks share a step, each has only the bodies of its own contacts.
template <int D>
struct StepProblem {
  ContactLaw law;                              ///< of all contacts
  double scale = 0;                            ///< W, the mean of the W_nn of the contacts, 1/kg; 0 without contacts
  double friction = 0, boundary_friction = 0;  ///< between free disks; between a free and a driven one, see friction_of
  bool tangential_bias = false;                ///< contacts have a bias_t (tangential restitution)
  bool rubs = true;                            ///< contacts have a tangential impulse
  bool own_frictions = false;                  ///< contacts have frictions of their own, by colours and statuses
  bool pulls = false;                          ///< the law pulls: contacts that touch have a pull
  double h = 0;                                ///< s
  std::vector<StepContact> geometry;           ///< ascending by (a, b)
  std::vector<GrainContact<D>> contacts;       ///< the same contacts for the solver, impulses to start from
  std::vector<GrainVelocity<D>> start;         ///< V^- of the bodies (of driven ones: in this step)
  std::vector<GrainVelocity<D>> free;          ///< V^- + h M^-1 F
  /// Number of each body, ascending: of a grain or free body, see GranularSystem::bodies, or bodies + k for the k-th
  /// wall body. 0, 1, 2, ... in a whole step.
  std::vector<std::int32_t> numbers;
};

/// The place of a body in a step, -1 if no contact of this part of a step touches it.
template <int D>
Index body_of(const StepProblem<D>& problem, Index body) {
  const auto number = static_cast<std::int32_t>(body);
  if (body < count(problem.numbers) && problem.numbers[at(body)] == number) return body;
  const auto found = std::lower_bound(problem.numbers.begin(), problem.numbers.end(), number);
  return found != problem.numbers.end() && *found == number ? found - problem.numbers.begin() : -1;
}

/// Finds contacts and sets the problem up, see for_each_step_contact. Impulses start from those of the last step if
/// `warm_start`, else from zero. With `shallow`, check_overlaps throws if bodies overlap too far.
template <int D>
StepProblem<D> prepare_step(const StepStart& start, bool warm_start, bool shallow = false);

/// Sets up the problem of the contacts in `geometry` with `bodies`, among them all grains and free bodies of these.
/// `last` tells which contacts slid; impulses start from those in it if `warm_start`. All ascend, contacts by (a, b).
template <int D>
StepProblem<D> step_of_contacts(const StepStart& start, std::vector<StepContact> geometry, double boundary_speed,
                                std::vector<std::int32_t> bodies, const std::vector<RememberedImpulse>& last,
                                bool warm_start);

/// Sets the scale W, 1/kg, and the law that depends on it; `step_of_contacts` sets the mean W_nn of the contacts.
template <int D>
void set_scale(StepProblem<D>& problem, const Interaction& interaction, double scale) {
  problem.scale = scale;
  problem.law = contact_law(interaction, problem.h, scale);
}

/// The remembered item of each contact, or null. Both lists ascend by (a, b).
template <class Remembered>
std::vector<const Remembered*> remembered(const std::vector<Remembered>& last,
                                          const std::vector<StepContact>& contacts) {
  std::vector<const Remembered*> result;
  result.reserve(contacts.size());
  auto old = last.begin();
  for (const StepContact& c : contacts) {
    while (old != last.end() && body_pair(*old) < body_pair(c)) ++old;
    const bool known = old != last.end() && body_pair(*old) == body_pair(c);
    result.push_back(known ? &*old : nullptr);
  }
  return result;
}

/// V_free + M^-1 H r for the impulses of the contacts.
template <int D>
std::vector<GrainVelocity<D>> velocities_of(const StepProblem<D>& problem,
                                            const std::vector<GrainContact<D>>& contacts) {
  std::vector<GrainVelocity<D>> v = problem.free;
  for (const GrainContact<D>& c : contacts) apply_impulse(c, c.impulse, v);
  return v;
}

template <int D>
ContactWork work_of(const StepProblem<D>& problem, const GrainContact<D>& c,
                    const std::vector<GrainVelocity<D>>& velocities) {
  ContactWork work;
  if (!carries(c.impulse)) return work;
  work.dissipation = -dot(c.impulse, relative_velocity(c, problem.start) + relative_velocity(c, velocities)) / 2;
  // Work of the impulses -r on a and r on b at the mean velocities of driven ones, and of driven unknowns.
  const auto add = [&](std::int32_t body, double sign, const Lever<D>* lever) {
    const GrainVelocity<D>& v = velocities[at(body)];
    if (v.inverse_mass > 0 && lever == nullptr) return;
    const GrainUnknowns<D> now = unknowns(v), before = unknowns(problem.start[at(body)]);
    GrainUnknowns<D> impulse = impulse_on_grain(c.normal, sign, c.impulse);
    if (lever != nullptr) {
      Lever<D> driven = *lever;
      for (double& moves : driven.moves) moves = v.inverse_mass > 0 ? 1 - moves : 1;
      impulse = driven.impulse(c.impulse);
    }
    double twice = 0;
    for (std::size_t k = 0; k < now.size(); ++k) twice += impulse[k] * (before[k] + now[k]);
    work.boundary -= twice / 2;
  };
  add(c.a, -1, c.levers ? &c.levers->a : nullptr);
  add(c.b, 1, c.levers ? &c.levers->b : nullptr);
  return work;
}

/// The nonzero impulses, to be kept for the next step; `contacts` are those of the problem.
template <int D>
std::vector<RememberedImpulse> impulses_to_remember(const StepProblem<D>& problem,
                                                    const std::vector<GrainContact<D>>& contacts) {
  std::vector<RememberedImpulse> impulses;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const GrainContact<D>& c = contacts[k];
    const StepContact& g = problem.geometry[k];
    if (carries(c.impulse))
      impulses.push_back({g.a, g.b, to_remember<D>(c.impulse, c.normal), slides(status_of(problem.law, c))});
  }
  return impulses;
}

/// The rims of each body but the walls at the end, see GranularSystem::rims.
using Rims = std::function<std::array<double, 3>(Index)>;

/// The contact problem of a step in the unknowns of other programs: (v_x, v_y, spin) of the free bodies, three rows
/// each in their order, in space (v, spin), six rows each; of a body with free directions the spins are about its
/// principal axes, and rows of driven directions have no entries in H:
///     M = diag(m, m, m R^2 / 2), in space diag(m, m, m, 2/5 m R^2 I_3),   f = M V_free,
///     M v = H r + f,   u = H^T v + w.
/// The law acts on u: w holds its biases (gap / h, restitution) and the velocities of driven bodies, which have no
/// rows. In the rows of spin a tangential column has the lever arm, -R. `bodies`: V_free and inverse masses.
template <int D>
GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<D>>& bodies,
                                       const std::vector<GrainContact<D>>& contacts, const Rims& rims);

}  // namespace nscdd
