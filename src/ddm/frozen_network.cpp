// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/frozen_network.hpp"

#include "linalg/sparse_entries.hpp"

namespace nscdd {

FrozenNetwork frozen_network(const GranularSubdomain<2>& subdomain, const std::vector<ContactStatus>& statuses) {
  FrozenNetwork network;
  std::vector<double> root;
  for (const GrainVelocity<2>& v : subdomain.velocities) {
    network.rows.push_back({v.inverse_mass > 0 ? count(root) : -1});
    if (v.inverse_mass == 0) continue;
    const double of_body = std::sqrt(1 / v.inverse_mass);
    root.insert(root.end(), {of_body, of_body, of_body / std::sqrt(rim_mass_ratio<2>)});
  }
  network.root = Vector::Map(root.data(), count(root));
  const Index size = network.root.size();
  ConnectivityBuilder<2> impulses(size, 2 * statuses.size()), resting(size, 2 * statuses.size());
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    if (statuses[k] == ContactStatus::open) continue;
    const GrainContact<2> c = subdomain.contacts.contact(k, subdomain.velocities);
    const auto put = [&](LocalVector<2> impulse, LocalVector<2> rest) {
      impulses.add(c.normal, network.rows[at(c.a)], network.rows[at(c.b)], impulse);
      resting.add(c.normal, network.rows[at(c.a)], network.rows[at(c.b)], rest);
    };
    put({1, sliding_slope(statuses[k], c.friction)}, {1, 0});
    if (statuses[k] == ContactStatus::stick) put({0, 1}, {0, 1});
  }
  network.impulses = over_rows(impulses.matrix(), network.root);
  network.resting = over_rows(resting.matrix(), network.root);
  return network;
}

}  // namespace nscdd
