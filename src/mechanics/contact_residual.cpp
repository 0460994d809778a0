// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_residual.hpp"

namespace nscdd {
namespace {

constexpr double largest_growth = 1e5;        // of impulses over those that drive the step
constexpr double squared_rounding = 1e-28;    // of velocities of a step, relative to those that it begins with
constexpr double maxima_over_means = 16.666;  // allowed by LMGC90's criterion QM/16

template <class Law, int D>
void add(ContactResidual& sum, const Law& law, const GrainContact<D>& c, GrainVelocities<D> v) {
  const LocalVector<D> r = c.impulse, shifted{r.n + c.pull, r.t}, velocity = relative_velocity(c, v) + c.bias;
  LocalVector<D> next, change, here, there;
  double inverse_n = 0;
  with_delassus(c, [&](const auto& w) {
    next = law_at(law, c.pull).impulse(r - w.solve(velocity), w, c.friction);
    change = w.apply(next - r);
    here = w.apply(r);
    there = w.apply(next);
    inverse_n = w.inverse_normal();
  });
  const LocalVector<D> mean = 0.5 * (next + r);
  const double violation = squared(change), squared_work = violation * squared(mean);
  sum.impulses += squared(shifted);
  sum.violation += violation;
  sum.work += dot(mean, change);
  sum.squared_work += squared_work;
  sum.largest_violation = std::max(sum.largest_violation, violation);
  sum.largest_squared_work = std::max(sum.largest_squared_work, squared_work);
  sum.loaded += carries(mean);
  sum.scale_work += (dot(here, r) + dot(there, next)) / 2;
  sum.scale_velocity += (squared(here) + squared(there)) / 2;
  sum.natural_map += squared(Law::opens ? natural_map(shifted, velocity, c.friction, inverse_n) : next - r);
  sum.active += carries(r);
  const ContactStatus status = Law::opens ? status_in_cone(c) : ContactStatus::stick;
  sum.stick += status == ContactStatus::stick;
  sum.slide += slides(status);
}

// The law is chosen once for all contacts.
template <int D>
ContactResidual sum_over(const ContactLaw& law, std::size_t contacts, GrainVelocities<D> v, const auto& contact) {
  ContactResidual sum;
  const auto under = [&](const auto& one) {
    for (std::size_t k = 0; k < contacts; ++k) add(sum, one, contact(k), v);
  };
  std::visit(under, law);
  return sum;
}

// A part of `scale`. One that is rounding is a part of `origin`, if that is larger: of what it is the rounding of.
double relative(double part, double scale, double origin) {
  if (part == 0) return 0;
  const bool noise = std::abs(part) <= squared_rounding * origin;
  return part / (noise ? std::max(scale, origin) : scale);
}

}  // namespace

double natural_map_scale(double maps, double impulses, double alone, double momenta, bool squared, double believed) {
  const auto power = [&](double factor) { return squared ? factor * factor : factor; };
  if (maps <= power(rounding_of_sums) * std::max(std::min(impulses, believed), momenta))
    return std::max({impulses, alone, momenta});
  const double driving = std::max(alone, momenta);
  const double scale = std::max(alone, driving > 0 ? std::min(impulses, power(largest_growth) * driving) : impulses);
  return scale > 0 ? scale : maps;  // 0 if cohesion alone closes contacts
}

double ContactResidual::relative_natural_map() const {
  if (natural_map == 0) return 0;
  return std::sqrt(natural_map / natural_map_scale(natural_map, impulses, scale.alone, scale.momenta, true));
}

double ContactResidual::quad_dv() const { return std::sqrt(relative(violation, scale_velocity, scale.speeds)); }

double ContactResidual::quad_dvr() const {
  return std::sqrt(static_cast<double>(loaded)) * relative(std::sqrt(squared_work), scale_work, scale.energies);
}

double ContactResidual::mean_dv_over_r() const { return relative(work, scale_work, scale.energies); }

double ContactResidual::qm_16() const {
  const auto contacts = static_cast<double>(loaded);
  const std::array indicators{
      std::abs(mean_dv_over_r()), quad_dv(), quad_dvr(),
      std::sqrt(contacts * relative(largest_violation, scale_velocity, scale.speeds)) / maxima_over_means,
      contacts * relative(std::sqrt(largest_squared_work), scale_work, scale.energies) / maxima_over_means};
  // NaN remains, because it must not pass for converged.
  return std::accumulate(indicators.begin(), indicators.end(), 0.0,
                         [](double a, double b) { return std::isnan(a) || a > b ? a : b; });
}

template <int D>
ContactResidual contact_residual(const ContactLaw& law, const ContactRows<D>& contacts, GrainVelocities<D> v) {
  return sum_over<D>(law, contacts.size(), v, [&](std::size_t k) { return contacts.contact(k, v); });
}

template <int D>
ContactResidual contact_residual(const ContactLaw& law, const std::vector<GrainContact<D>>& contacts,
                                 GrainVelocities<D> v) {
  return sum_over<D>(
      law, contacts.size(), v, [&](std::size_t k) -> auto& { return contacts[k]; });
}

template ContactResidual contact_residual(const ContactLaw&, const ContactRows<2>&, GrainVelocities<2>);
template ContactResidual contact_residual(const ContactLaw&, const ContactRows<3>&, GrainVelocities<3>);
template ContactResidual contact_residual(const ContactLaw&, const std::vector<GrainContact<2>>&, GrainVelocities<2>);
template ContactResidual contact_residual(const ContactLaw&, const std::vector<GrainContact<3>>&, GrainVelocities<3>);

}  // namespace nscdd
