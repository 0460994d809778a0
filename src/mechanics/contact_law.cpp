// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_law.hpp"

#include "mechanics/disk_contacts.hpp"

namespace nscdd {
namespace {

// Rounding of a sum of impulses may leave the edge of the cone by some units in the last place.
constexpr double edge_tolerance = 1e-12;

template <class Law>
ContactStatus status_under(const Law&, const DiskContact& c) {
  if constexpr (!Law::opens) return ContactStatus::stick;
  return contact_status(LocalVector<2>{c.impulse.n + c.pull, c.impulse.t}, c.friction, edge_tolerance);
}

template <class Law>
void add(ContactResidual& sum, const Law& law, const DiskContact& c, std::span<const DiskVelocity> v) {
  const LocalVector<2> r = c.impulse;
  const LocalVector<2> next = law_at(law, c.pull).impulse(stopping_impulse(c, v), c.inverse_w, c.friction);
  const LocalVector<2> change = c.inverse_w.apply(next - r);
  const LocalVector<2> here = c.inverse_w.apply(r), there = c.inverse_w.apply(next);
  sum.impulses += squared(r);
  sum.violation += squared(change);
  sum.work += dot({(next.n + r.n) / 2, (next.t + r.t) / 2}, change);
  sum.scale_work += (dot(here, r) + dot(there, next)) / 2;
  sum.scale_velocity += (squared(here) + squared(there)) / 2;
  if constexpr (!Law::opens) {
    sum.natural_map += squared(next - r);
  } else {
    const LocalVector<2> velocity = relative_velocity(c, v) + c.bias;
    sum.natural_map +=
        squared(natural_map(LocalVector<2>{r.n + c.pull, r.t}, velocity, c.friction, c.inverse_w.inverse_n));
  }
  if (r.n == 0 && r.t == 0) return;
  ++sum.active;
  const ContactStatus status = status_under(law, c);
  sum.stick += status == ContactStatus::stick;
  sum.slide += slides(status);
}

template <class Contact>
ContactResidual sum_over(const ContactLaw& law, std::size_t contacts, std::span<const DiskVelocity> v,
                         const Contact& contact) {
  ContactResidual sum;
  const auto under = [&](const auto& one) {
    for (std::size_t k = 0; k < contacts; ++k) add(sum, one, contact(k), v);
  };
  std::visit(under, law);
  return sum;
}

}  // namespace

ContactLaw contact_law(const Interaction& interaction, double h, double scale) {
  ContactLaw law = Alternatives<ContactLaw>::at(static_cast<std::size_t>(LawName{interaction.law}));
  std::visit([&](auto& one) { one = one.of(interaction, h, scale); }, law);
  return law;
}

ContactResidual& ContactResidual::operator+=(const ContactResidual& other) {
  using Sums = ContactResidual;
  for (const auto sum :
       {&Sums::natural_map, &Sums::impulses, &Sums::violation, &Sums::work, &Sums::scale_work, &Sums::scale_velocity})
    this->*sum += other.*sum;
  for (const auto sum : {&Sums::active, &Sums::stick, &Sums::slide}) this->*sum += other.*sum;
  return *this;
}

double ContactResidual::relative_natural_map() const {
  return natural_map == 0 ? 0.0 : std::sqrt(natural_map / impulses);
}

double ContactResidual::quad_dv() const { return violation == 0 ? 0.0 : std::sqrt(violation / scale_velocity); }

double ContactResidual::mean_dv_over_r() const { return work == 0 ? 0.0 : work / scale_work; }

ContactResidual contact_residual(const ContactLaw& law, const ContactRows& contacts, std::span<const DiskVelocity> v) {
  return sum_over(law, contacts.size(), v, [&](std::size_t k) { return contacts.contact(k, v); });
}

ContactResidual contact_residual(const ContactLaw& law, std::span<const DiskContact> contacts,
                                 std::span<const DiskVelocity> v) {
  return sum_over(law, contacts.size(), v, [&](std::size_t k) { return contacts[k]; });
}

ContactStatus status_of(const ContactLaw& law, const DiskContact& contact) {
  return std::visit([&](const auto& one) { return status_under(one, contact); }, law);
}

}  // namespace nscdd
