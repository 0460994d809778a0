// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/rigid_system.hpp"

#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

constexpr Index hub_from = 65;      // grains of a cluster: smaller ones take part in the dissection
constexpr double rounding = 1e-15;  // of a column of unit length

SparseMatrix columns_of(const RangeBasis& basis, const SparseMatrix& h) {
  SparseEntries entries;
  entries.add_block(selected_columns(h, basis.columns), 0, 0);
  for (Index k = 0; k < basis.others.cols(); ++k)
    for (Index i = 0; i < h.rows(); ++i)
      if (std::abs(basis.others(i, k)) > rounding) entries.add(i, count(basis.columns) + k, basis.others(i, k));
  return entries.matrix(h.rows(), basis.size());
}

RigidSubdomain rigid_subdomain(const Subdomain& subdomain, Index dofs_per_grain) {
  RigidSubdomain result;
  result.motions = rigid_motions({dofs_per_grain, subdomain.centres, subdomain.inertia, subdomain.h});
  const RigidMotions& motions = result.motions;
  result.a = SparseMatrix(subdomain.a * motions.z);
  for (const RigidBody& body : motions.bodies) result.hub.push_back(body.grains >= hub_from);
  const RangeBasis basis = range_basis(motions);
  result.h = columns_of(basis, motions.h);
  result.conclusive = basis.conclusive;
  // The basis is one whatever the masses. Seen through M^-1/2 an angle may be larger. It was measured on the contacts
  // that no body was set aside with; these are clearly apart from all others.
  if (motions.inertia.size() > 0)
    result.tilt = basis.tilt * std::sqrt(motions.inertia.maxCoeff() / motions.inertia.minCoeff());
  std::vector<char> early(at(result.h.cols()), 0);
  std::fill_n(early.begin(), basis.columns.size(), char{1});
  if (std::ranges::count(result.hub, 1) > 0) {
    RigidMotions chosen = motions;
    chosen.h = result.h.leftCols(count(basis.columns));
    std::fill(early.begin(), early.end(), char{0});
    for (const Index c : range_basis(chosen, result.hub, Tilt::not_measured).columns) early[at(c)] = 1;
  }
  for (std::size_t c = 0; c < early.size(); ++c)
    (early[c] ? result.early : result.late).push_back(static_cast<Index>(c));
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
  bool doubtful = false;
  for (const RigidSubdomain& one : system.subdomains) doubtful |= !one.conclusive;
  system.conclusive = !parts.interface.processes().any(doubtful);
  for (const RigidSubdomain& one : system.subdomains) system.tilt = std::max(system.tilt, one.tilt);
  system.tilt = parts.interface.processes().maximum(system.tilt);
  for (const double own : rows) system.hub_rows.push_back(static_cast<Index>(own));
  return system;
}

}  // namespace nscdd
