// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/saddle_entries.hpp"

namespace nscdd {
namespace {

// M_E on the diagonal and A_E in the interface rows.
void add_inertia_and_gluing(SaddleEntries& entries, const Subdomain& subdomain, Index first, Index interface) {
  for (Index i = 0; i < subdomain.inertia.size(); ++i) entries.add(first + i, first + i, subdomain.inertia[i], 0);
  for_entries(subdomain.a, [&](Index i, Index j, double value) { entries.add(interface + i, first + j, value, 0); });
}

}  // namespace

void add_condensed(SaddleEntries& entries, const Decomposition& parts, Index first, Index interface) {
  for (const Subdomain& subdomain : parts.subdomains) {
    add_inertia_and_gluing(entries, subdomain, first, interface);
    const SparseMatrix stiffness = SparseMatrix(subdomain.h * subdomain.h.transpose());
    for_entries(stiffness, [&](Index i, Index j, double value) {
      if (i >= j) entries.add(first + i, first + j, 0, value);
    });
    first += stiffness.cols();
  }
}

void add_augmented(SaddleEntries& entries, const Decomposition& parts, Index first_impulse, Index interface) {
  Index first = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    add_inertia_and_gluing(entries, subdomain, first, interface);
    for (Index c = 0; c < subdomain.h.cols(); ++c, ++first_impulse) {
      entries.add(first_impulse, first_impulse, 0, -1);
      for (SparseMatrix::InnerIterator e(subdomain.h, c); e; ++e)
        entries.add(first_impulse, first + e.row(), e.value(), 0);
    }
    first += subdomain.inertia.size();
  }
}

void add_rigid(SaddleEntries& entries, const RigidSystem& system, const RigidRows& rows) {
  Index next_body = 0, next_impulse = rows.first_impulse, next_hub = rows.first_hub;
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
    std::vector<std::vector<std::pair<Index, double>>> acting(row.size());  // impulses on each motion that is condensed
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
    for_entries(own.a, [&](Index i, Index j, double value) { act(rows.interface + i, j, value); });
    for (Index i = 0; i < count(row); ++i)
      for (const auto& [one, value] : acting[at(i)])
        for (const auto& [other, other_value] : acting[at(i)]) {
          if (other > one) continue;
          const double product = -value * other_value / own.motions.inertia[i];
          const bool both_at_interface = other >= rows.interface;  // where `inertia` has the coefficient of sigma
          entries.add(one, other, both_at_interface ? 0 : product, both_at_interface ? product : 0);
        }
    next_hub += system.hub_rows[e];
  }
}

}  // namespace nscdd
