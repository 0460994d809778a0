// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/flexibility.hpp"
#include "mechanics/laws/cohesive.hpp"
#include "mechanics/laws/coulomb.hpp"
#include "mechanics/laws/frictionless.hpp"

namespace nscdd {

/// Laws between two bodies with a normal and a tangential component: one file and one word here per law. A law has
///   name
///   impulse(stop, w, friction)  the impulse of one contact, solved together with v = W (r - stop)
///   of(interaction, h, scale)   the law with its parameters, see contact_law
///   opens                       whether a contact may part: it then obeys Coulomb's law once `pull` is added to its
///                               normal impulse. Sweeps over spheres, statuses, residuals and contact solvers know
///                               it by that alone. Otherwise the law is linear and has a `flexibility`.
///   rubs                        whether a contact has a tangential impulse
///   pulls, pull()               whether touching bodies hold each other, and the largest impulse with which they do,
///                               N s; a law that pulls can be made from that impulse alone
using ContactLaw = std::variant<Coulomb, Frictionless, Cohesive, LinearViscous>;

/// A law by its place in ContactLaw.
enum class LawName {};
constexpr auto names_of(LawName) { return Alternatives<ContactLaw>::names; }

inline bool opens(const ContactLaw& law) {
  return std::visit([](const auto& one) { return one.opens; }, law);
}

/// The law of one contact, which pulls with at most `pull`, N s. That is 0 if its bodies do not touch.
template <class Law>
Law law_at(const Law& law, double pull) {
  if constexpr (Law::pulls)
    return Law{pull};
  else
    return law;
}

/// Signorini's condition of a contact: on the gap at the end of a step, v_n + gap/h >= 0, or on the velocity,
/// v_n + restitution v_n^- >= 0, once bodies touch.
enum class Signorini { gap, velocity };
constexpr auto names_of(Signorini) { return std::to_array<std::string_view>({"gap", "velocity"}); }

/// How bodies touch.
struct Interaction {
  Choice<LawName> law;  ///< Coulomb's by default
  double friction = 0.3, boundary_friction = -1;
  double static_friction = -1;  ///< of contacts that did not slide at the end of the last step
  Choice<Signorini> signorini;
  double restitution = 0, tangential_restitution = 0;
  double cohesion = 0;         ///< N
  double cohesion_range = -1;  ///< m; -1: contacts that touch, see touching_gap
  Flexibility epsilon;
  /// No parameter of a case: largest pull of a bond, times W_nn^-1 and the largest speed of a step; see solve_step.
  double bond_strength = 10;

  /// Whether contacts act once bodies touch.
  bool on_velocity() const { return signorini == Signorini::velocity || restitution > 0; }
  /// Of a contact between grains or with a boundary that slid in the last step or did not.
  double friction_of(bool at_boundary, bool slid) const {
    if (at_boundary && boundary_friction >= 0) return boundary_friction;
    return slid || static_friction < 0 ? friction : static_friction;
  }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("law", self.law, Field{.description = "contact law"});
    visit("friction", self.friction,
          Field{.description = "Coulomb's coefficient between grains", .minimum = 0, .maximum = 100});
    visit("boundary_friction", self.boundary_friction,
          Field{.description = "Coulomb's coefficient at boundaries; -1: as between grains",
                .minimum = 0,
                .maximum = 100,
                .also = -1});
    visit("static_friction", self.static_friction,
          Field{.description = "Coulomb's coefficient between grains that did not slide in the last step; -1: friction",
                .minimum = 0,
                .maximum = 100,
                .also = -1});
    visit("signorini", self.signorini,
          Field{.description = "condition on the gap at the end of a step, or on the velocity once bodies touch; a "
                               "restitution above 0 implies velocity"});
    visit("restitution", self.restitution,
          Field{.description = "Newton's coefficient of normal restitution", .minimum = 0, .maximum = 1});
    visit("tangential_restitution", self.tangential_restitution,
          Field{.description = "coefficient of tangential restitution", .minimum = 0, .maximum = 1});
    visit("cohesion", self.cohesion,
          Field{.description = "largest pulling force of a contact that touches, law cohesive",
                .unit = "N",
                .minimum = 0,
                .maximum = 1e100});
    visit("cohesion_range", self.cohesion_range,
          Field{.description = "largest gap of a contact that pulls, law cohesive; -1: 1e-3 of the smaller radius",
                .unit = "m",
                .minimum = 0,
                .also = -1});
    visit("epsilon", self.epsilon,
          Field{.description = "flexibility of law linear_viscous: a number, or a multiple of W",
                .unit = "1/kg",
                .minimum = 0});
  }
};

/// The law with its parameters; `h`: time step, s (a cohesive force acts through its impulse); `scale`: W, 1/kg, of
/// which its flexibility may be a multiple.
inline ContactLaw contact_law(const Interaction& interaction, double h, double scale) {
  ContactLaw law = Alternatives<ContactLaw>::at(static_cast<std::size_t>(LawName{interaction.law}));
  std::visit([&](auto& one) { one = one.of(interaction, h, scale); }, law);
  return law;
}

/// Status of a contact under Coulomb's law, or under a cohesive one if the impulse is shifted. A contact slides if its
/// impulse is within `tolerance` x friction r_n of the edge of the cone.
template <int D>
ContactStatus contact_status(LocalVector<D> impulse, double friction, double tolerance = 0) {
  if (impulse.n <= 0) return ContactStatus::open;
  const double edge = friction * impulse.n;
  if (norm(impulse.t) < edge * (1 - tolerance)) return ContactStatus::stick;
  if constexpr (D == 2)
    return impulse.t > 0 ? ContactStatus::slide_backward : ContactStatus::slide_forward;
  else
    return ContactStatus::slide;
}

/// What stays of Coulomb's law for small changes of a contact (docs/theory.md, section 9): the status at
/// z = r - rho u with, where it slides along d = z_t / |z_t|,
///     r_t = slope r_n + turning (I - d d^T) (r_t - rho u_t),   slope = friction d.
/// The last term is of space alone: an impulse turns with the velocity. In the plane I = d d^T.
template <int D>
struct FrozenContact {
  ContactStatus status = ContactStatus::open;
  Tangent<D> slope{};
  double turning = 0;  ///< friction z_n / |z_t| <= 1
};

/// The slope of a contact that slides, in the plane by its status alone; 0 for any other.
inline double sliding_slope(ContactStatus status, double friction) {
  return status == ContactStatus::slide_forward ? -friction : status == ContactStatus::slide_backward ? friction : 0.0;
}

template <int D>
FrozenContact<D> frozen_contact(LocalVector<D> z, double friction, double tolerance = 0) {
  FrozenContact<D> result{.status = contact_status(z, friction, tolerance)};
  if constexpr (D == 2) {
    result.slope = sliding_slope(result.status, friction);
  } else if (const double size = norm(z.t); slides(result.status) && size > 0) {
    result.slope = (friction / size) * z.t;
    result.turning = std::min(1.0, friction * z.n / size);
  }
  return result;
}

/// Orthogonal projection of an impulse on Coulomb's cone { |r_t| <= friction r_n }. Solvers spend their time here: a
/// call would take as long as what it does.
template <int D>
[[gnu::always_inline]] inline LocalVector<D> project_on_cone(LocalVector<D> impulse, double friction) {
  const double size = norm(impulse.t);
  if (friction * size <= -impulse.n) return {};      // inside the polar cone; first, for friction 0
  if (size <= friction * impulse.n) return impulse;  // inside
  const double n = (impulse.n + friction * size) / (1 + friction * friction);  // on the edge (1, friction)
  if constexpr (D == 2)
    return {n, std::copysign(friction * n, impulse.t)};
  else
    return {n, (friction * n / size) * impulse.t};
}

/// Residual of the contact law in the form of De Saxce, the "natural map": r - P_K(r - rho (v + friction |v_t| n)), N
/// s. For any rho > 0 (kg) it is zero if and only if (v, r) obeys Signorini and Coulomb.
template <int D>
LocalVector<D> natural_map(LocalVector<D> impulse, LocalVector<D> velocity, double friction, double rho) {
  const LocalVector<D> moved{impulse.n - rho * (velocity.n + friction * norm(velocity.t)),
                             impulse.t - rho * velocity.t};
  return impulse - project_on_cone(moved, friction);
}

}  // namespace nscdd
