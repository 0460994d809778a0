// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/impulse_scale.hpp"

namespace nscdd {
namespace {

constexpr double largest_growth = 1e5;  // of impulses over those that drive the step

}  // namespace

double natural_map_scale(double maps, double impulses, double alone, double momenta, bool squared, double believed) {
  const auto power = [&](double factor) { return squared ? factor * factor : factor; };
  if (maps <= power(rounding_of_sums) * std::max(std::min(impulses, believed), momenta))
    return std::max({impulses, alone, momenta});
  const double driving = std::max(alone, momenta);
  return std::max(alone, driving > 0 ? std::min(impulses, power(largest_growth) * driving) : impulses);
}

template <int D>
double meeting_speed(const GrainContact<D>& contact, GrainVelocities<D> v) {
  const auto speed = [](const GrainVelocity<D>& one) {
    return std::sqrt(squared_velocity(one)) + std::sqrt(squared_rim(one));
  };
  return speed(v[static_cast<std::size_t>(contact.a)]) + speed(v[static_cast<std::size_t>(contact.b)]);
}

template <int D>
ImpulseScale impulse_scale(const ContactLaw& law, const GrainContact<D>& contact, GrainVelocities<D> free) {
  const LocalVector<D> stop = -1.0 * contact.inverse_w.solve(relative_velocity(contact, free) + contact.bias);
  const LocalVector<D> alone = std::visit(
      [&](const auto& one) { return law_at(one, contact.pull).impulse(stop, contact.inverse_w, contact.friction); },
      law);
  const double speed = meeting_speed(contact, free), mass = contact.inverse_w.inverse_n;
  return {.alone = squared(LocalVector<D>{alone.n + contact.pull, alone.t}),
          .momenta = speed * speed * mass * mass,
          .speeds = speed * speed,
          .energies = speed * speed * mass};
}

template double meeting_speed(const GrainContact<2>&, GrainVelocities<2>);
template double meeting_speed(const GrainContact<3>&, GrainVelocities<3>);
template ImpulseScale impulse_scale(const ContactLaw&, const GrainContact<2>&, GrainVelocities<2>);
template ImpulseScale impulse_scale(const ContactLaw&, const GrainContact<3>&, GrainVelocities<3>);

}  // namespace nscdd
