// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/frozen_network.hpp"

#include "linalg/sparse_entries.hpp"

namespace nscdd {

template <int D>
FrozenContact<D> frozen_as(ContactStatus status, const GranularSubdomain<D>& subdomain, std::size_t k) {
  const GrainContact<D> contact = subdomain.contact(k);
  FrozenContact<D> result{.status = status};
  if constexpr (D == 2) {
    result.slope = sliding_slope(status, contact.friction);
  } else if (slides(status)) {
    const LocalVector<3> z = stopping_impulse<3>(contact, subdomain.velocities);
    if (const double size = norm(z.t); size > 0) {
      result.slope = (contact.friction / size) * z.t;
      result.turning = std::clamp(contact.friction * (z.n + contact.pull) / size, 0.0, 1.0);
    }
  }
  return result;
}

template <int D>
std::vector<FrozenContact<D>> frozen_contacts(const GranularDecomposition<D>& parts,
                                              const std::vector<ContactStatus>& statuses) {
  std::vector<FrozenContact<D>> result(statuses.size());
  for (const GranularSubdomain<D>& subdomain : parts.subdomains)
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
      result[at(subdomain.numbers[k])] = frozen_as(statuses[at(subdomain.numbers[k])], subdomain, k);
  return result;
}

TangentVector side_of(const FrozenContact<3>& contact) {
  const double size = norm(contact.slope);
  return {-contact.slope.second / size, contact.slope.first / size};
}

template <int D>
FrozenNetwork frozen_network(const GranularSubdomain<D>& subdomain, const std::vector<FrozenContact<D>>& frozen) {
  FrozenNetwork network;
  std::vector<double> root, flexibility;
  for (const GrainVelocity<D>& v : subdomain.velocities) {
    network.rows.push_back({v.inverse_mass > 0 ? count(root) : -1});
    if (v.inverse_mass == 0) continue;
    const double of_body = std::sqrt(1 / v.inverse_mass), of_rim = of_body / std::sqrt(rim_mass_ratio<D>);
    for (Index k = 0; k < unknowns_of_grain<D>; ++k) root.push_back(k < D ? of_body : of_rim);
  }
  network.root = Vector::Map(root.data(), count(root));
  const Index size = network.root.size();
  ConnectivityBuilder<D> impulses(size, D * frozen.size()), resting(size, D * frozen.size());
  for (std::size_t k = 0; k < frozen.size(); ++k) {
    const FrozenContact<D>& now = frozen[k];
    if (now.status == ContactStatus::open) continue;
    const GrainContact<D> c = subdomain.contact(k);
    const auto put = [&](LocalVector<D> impulse, LocalVector<D> rest, double flexible = 0) {
      impulses.add(c.normal, network.rows[at(c.a)], network.rows[at(c.b)], impulse);
      resting.add(c.normal, network.rows[at(c.a)], network.rows[at(c.b)], rest);
      flexibility.push_back(flexible);
    };
    if (now.status == ContactStatus::stick) {
      for (const LocalVector<D>& direction : contact_directions<D>()) put(direction, direction);
      continue;
    }
    put({1, now.slope}, {1, {}});
    if constexpr (D == 3)
      if (now.turning > 0) {  // the same factor on both keeps fast sliding contacts of size 1
        network.turning.push_back(count(flexibility));
        const LocalVector<3> side{0, std::sqrt(now.turning) * side_of(now)};
        put(side, side, (1 - now.turning) / c.inverse_w.inverse_t);
      }
  }
  network.impulses = over_rows(impulses.matrix(), network.root);
  network.resting = over_rows(resting.matrix(), network.root);
  network.flexibility = Vector::Map(flexibility.data(), count(flexibility));
  return network;
}

template FrozenContact<2> frozen_as(ContactStatus, const GranularSubdomain<2>&, std::size_t);
template FrozenContact<3> frozen_as(ContactStatus, const GranularSubdomain<3>&, std::size_t);
template std::vector<FrozenContact<2>> frozen_contacts(const GranularDecomposition<2>&,
                                                       const std::vector<ContactStatus>&);
template std::vector<FrozenContact<3>> frozen_contacts(const GranularDecomposition<3>&,
                                                       const std::vector<ContactStatus>&);
template FrozenNetwork frozen_network(const GranularSubdomain<2>&, const std::vector<FrozenContact<2>>&);
template FrozenNetwork frozen_network(const GranularSubdomain<3>&, const std::vector<FrozenContact<3>>&);

}  // namespace nscdd
