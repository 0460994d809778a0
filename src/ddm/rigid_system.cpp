// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/rigid_system.hpp"

#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

constexpr Index hub_from = 65;  // grains of a cluster: smaller ones take part in the dissection

RigidSubdomain rigid_subdomain(const Subdomain& subdomain, Index dofs_per_grain) {
  RigidSubdomain result{.motions = rigid_motions({dofs_per_grain, subdomain.centres, subdomain.inertia, subdomain.h}),
                        .a = {},
                        .hub = {},
                        .early = {},
                        .late = {}};
  const RigidMotions& motions = result.motions;
  result.a = SparseMatrix(subdomain.a * motions.z);
  for (const RigidBody& body : motions.bodies) result.hub.push_back(body.grains >= hub_from);
  const std::vector<Index> independent = independent_columns(motions).columns;
  if (std::ranges::count(result.hub, 1) == 0) {
    result.early = independent;
    return result;
  }
  RigidMotions chosen = motions;
  chosen.h = selected_columns(motions.h, independent);
  std::vector<char> early(independent.size(), 0);
  for (const Index c : independent_columns(chosen, result.hub).columns) early[at(c)] = 1;
  for (std::size_t k = 0; k < independent.size(); ++k)
    (early[k] ? result.early : result.late).push_back(independent[k]);
  return result;
}

}  // namespace

RigidSystem rigid_system(const Decomposition& parts) {
  RigidSystem system;
  system.subdomains.resize(parts.subdomains.size());
  for_each_in_parallel(count(parts.subdomains), [&](Index e) {
    system.subdomains[at(e)] = rigid_subdomain(parts.subdomains[at(e)], parts.dofs_per_grain());
  });
  std::vector<double> rows;
  for (const RigidSubdomain& one : system.subdomains) {
    Index own = count(one.late);
    for (std::size_t b = 0; b < one.hub.size(); ++b) own += one.hub[b] ? one.motions.bodies[b].rows : 0;
    rows.push_back(static_cast<double>(own));
  }
  parts.interface.processes().add_up(rows);
  for (const double own : rows) system.hub_rows.push_back(static_cast<Index>(own));
  return system;
}

}  // namespace nscdd
