// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/step_contacts.hpp"

namespace nscdd {
namespace {

// The lever of a contact on the grain or wall `body`, sign -1 for a and +1 for b.
template <int D>
Lever<D> lever_on(const GranularSystem& system, const Configuration& where, const StepContact& c, Index body,
                  double sign) {
  const Direction<D> normal = narrowed<D>(c.normal);
  const auto directions = contact_directions<D>();
  Lever<D> lever;
  for (std::size_t d = 0; d < D; ++d) lever.rows[d] = impulse_on_grain(normal, sign, directions[d]);
  lever.moves.fill(1);
  if (system.node_of(body) < system.grains()) return lever;  // a grain, a driven one or a wall
  const Index k = system.boundary_of(body);
  const FreeBody& own = *system.boundaries[at(k)].body;
  const Pose& pose = where.poses[at(k)];
  const Place arm = difference(contact_point(system, where, c, body), pose.place());
  const std::array<double, 3> rims = own.rims(system.dimension);
  const Eigen::Matrix3d axes = principal_axes(own, pose);
  for (std::size_t d = 0; d < D; ++d) {
    const auto on_b = impulse_on_grain(normal, 1, directions[d]);  // its first D numbers are the direction
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    for (std::size_t j = 0; j < D; ++j) direction[static_cast<Index>(j)] = on_b[j];
    const Eigen::Vector3d turn = Eigen::Vector3d::Map(arm.data()).cross(direction);
    if constexpr (D == 2)
      lever.rows[d][2] = sign * turn[2] / rims[2];
    else
      for (Index j = 0; j < 3; ++j) lever.rows[d][at(3 + j)] = sign * axes.col(j).dot(turn) / rims[at(j)];
  }
  for (std::size_t j = 0; j < lever.moves.size(); ++j)
    lever.moves[j] = own.directions[j < D ? j : D == 2 ? 5 : j] ? 1 : 0;
  return lever;
}

// How impulses along the surface move the bodies of a contact.
enum class Sliding { free, idle, tied };

// Idle: not at all, since both bodies are driven along the surface. Tied: W is singular for another reason, as where a
// plate that is free along y alone touches a slope.
template <int D>
Sliding sliding_of(const Levers<D>& levers, double inverse_mass_a, double inverse_mass_b) {
  constexpr double part = 1e-12;
  const FullDelassus<D> w = lever_delassus(levers, inverse_mass_a, inverse_mass_b);
  if constexpr (D == 2) {
    if (w.tt <= part * w.nn) return Sliding::idle;
    return w.nn * w.tt - w.nt * w.nt > part * w.nn * w.tt ? Sliding::free : Sliding::tied;
  } else {
    if (std::max(w.tt.first, w.tt.second) <= part * w.nn) return Sliding::idle;
    const TangentMatrix s = w.schur_complement();
    const bool regular = s.first > part * w.nn && s.second - s.mixed * s.mixed / s.first > part * w.nn;
    return regular ? Sliding::free : Sliding::tied;
  }
}

}  // namespace

template <int D>
std::shared_ptr<const Levers<D>> levers_of(const StepStart& start, const Configuration& where, const StepContact& c) {
  const GranularSystem& system = start.system;
  if (std::max(system.node_of(c.a), system.node_of(c.b)) < system.grains()) return nullptr;
  Levers<D> levers{lever_on<D>(system, where, c, c.a, -1), lever_on<D>(system, where, c, c.b, 1)};
  const Sliding sliding =
      sliding_of(levers, system.inverse_mass(system.node_of(c.a)), system.inverse_mass(system.node_of(c.b)));
  const bool rubs =
      std::visit([](const auto& law) { return law.rubs; }, contact_law(start.interaction, start.scheme.step, 1));
  if (sliding == Sliding::tied && rubs && std::max(friction_of(start, c, false), friction_of(start, c, true)) > 0)
    fail(
        "contact of {} and {}: expected bodies that move across and along the surface independently, or no friction, "
        "met one that its free directions tie to the other",
        body_name(system, c.a), body_name(system, c.b));
  if (sliding != Sliding::free)
    for (std::size_t d = 1; d < D; ++d) levers.a.rows[d] = levers.b.rows[d] = {};
  return std::make_shared<const Levers<D>>(levers);
}

template std::shared_ptr<const Levers<2>> levers_of(const StepStart&, const Configuration&, const StepContact&);
template std::shared_ptr<const Levers<3>> levers_of(const StepStart&, const Configuration&, const StepContact&);

}  // namespace nscdd
