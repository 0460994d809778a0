// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/rigid_system.hpp"

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
  result.motions = rigid_motions(dofs_per_grain, subdomain.centres, subdomain.inertia, subdomain.h);
  const RigidMotions& motions = result.motions;
  result.a = SparseMatrix(subdomain.a * motions.z);
  for (const RigidBody& body : motions.bodies) result.hub.push_back(body.grains >= hub_from);
  const RangeBasis basis = range_basis(motions);
  result.h = columns_of(basis, motions.h);
  result.conclusive = basis.conclusive;
  // M^-1/2 may enlarge the tilt. Columns set aside are clearly apart from all others, and have none.
  if (motions.inertia.size() > 0)
    result.tilt = basis.tilt * std::sqrt(motions.inertia.maxCoeff() / motions.inertia.minCoeff());
  result.early = natural_order(count(basis.columns));
  if (std::ranges::count(result.hub, 1) > 0) {
    RigidMotions chosen = motions;
    chosen.h = result.h.leftCols(count(basis.columns));
    std::vector<char> of_hub;  // for each row; bodies follow each other
    for (std::size_t b = 0; b < result.hub.size(); ++b)
      of_hub.resize(of_hub.size() + at(motions.bodies[b].rows), result.hub[b]);
    chosen.h.prune([&](Index row, Index, double) { return !of_hub[at(row)]; });
    result.early = range_basis(chosen, Tilt::not_measured).columns;
  }
  std::ranges::set_difference(natural_order(result.h.cols()), result.early, std::back_inserter(result.late));
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
  bool doubtful = false;
  for (const RigidSubdomain& one : system.subdomains) {
    doubtful |= !one.conclusive;
    system.tilt = std::max(system.tilt, one.tilt);
    Index own = count(one.late);
    for (std::size_t b = 0; b < one.hub.size(); ++b) own += one.hub[b] ? one.motions.bodies[b].rows : 0;
    rows.push_back(static_cast<double>(own));
  }
  parts.interface.processes().add_up(rows);
  system.conclusive = !parts.interface.processes().any(doubtful);
  system.tilt = parts.interface.processes().maximum(system.tilt);
  for (const double own : rows) system.hub_rows.push_back(static_cast<Index>(own));
  return system;
}

void add_rigid(SaddleEntries& entries, const RigidSystem& system, Index next_impulse, Index next_hub, Index interface) {
  Index next_body = 0;
  for (std::size_t e = 0; e < system.subdomains.size(); ++e) {
    const RigidSubdomain& own = system.subdomains[e];
    std::vector<Index> row(at(own.motions.inertia.size()));  // of each motion
    Index late = next_hub;
    for (std::size_t b = 0; b < own.motions.bodies.size(); ++b) {
      const RigidBody& body = own.motions.bodies[b];
      Index& next = own.hub[b] ? late : next_body;
      for (Index k = 0; k < body.rows; ++k) row[at(body.first_row + k)] = own.condensed(b) ? -1 : next++;
    }
    for (Index i = 0; i < count(row); ++i)
      if (row[at(i)] >= 0) entries.add(row[at(i)], row[at(i)], own.motions.inertia[i], 0);
    std::vector<std::vector<std::pair<Index, double>>> acting(row.size());  // impulses on each condensed motion
    const auto act = [&](Index impulse, Index motion, double value) {
      if (const Index own_row = row[at(motion)]; own_row >= 0)
        entries.add(std::max(impulse, own_row), std::min(impulse, own_row), value, 0);
      else
        acting[at(motion)].emplace_back(impulse, value);
    };
    const auto add = [&](Index impulse, Index column) {
      entries.add(impulse, impulse, 0, 0);
      for (SparseMatrix::InnerIterator e_h(own.h, column); e_h; ++e_h) act(impulse, e_h.row(), e_h.value());
    };
    for (const Index c : own.early) add(next_impulse++, c);
    for (const Index c : own.late) add(late++, c);
    for_entries(own.a, [&](Index i, Index j, double value) { act(interface + i, j, value); });
    for (Index i = 0; i < count(row); ++i)
      for (const auto& [one, value] : acting[at(i)])
        for (const auto& [other, other_value] : acting[at(i)]) {
          if (other > one) continue;
          const double product = -value * other_value / own.motions.inertia[i];
          const bool both_at_interface = other >= interface;  // there `inertia` has the coefficient of sigma
          entries.add(one, other, both_at_interface ? 0 : product, both_at_interface ? product : 0);
        }
    next_hub += system.hub_rows[e];
  }
}

}  // namespace nscdd
