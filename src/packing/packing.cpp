// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "packing/disk_grid.hpp"
#include <nscdd/packing/packing.hpp>

#include <numbers>

namespace nscdd {
namespace {

void require_positive(const std::vector<double>& values, const char* name) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || values[i] <= 0)
      fail("grain {}: expected a finite {} > 0, met {}", i, name, values[i]);
}

// A pair (i, j) with its geometry, or a gap beyond the tolerance for a pair that does not touch.
Contact pair_geometry(const Packing& p, Index i, Index j) {
  const double dx = p.x[at(j)] - p.x[at(i)], dy = p.y[at(j)] - p.y[at(i)];
  const double distance = std::hypot(dx, dy);
  Contact contact{.a = i, .b = j};
  contact.gap = distance - (p.radius[at(i)] + p.radius[at(j)]);
  contact.midpoint = {p.x[at(i)] + 0.5 * dx, p.y[at(i)] + 0.5 * dy};
  if (distance > 0) contact.normal = {dx / distance, dy / distance};
  return contact;
}

void require_no_overlap(const Packing& p, const Contact& contact, double allowed) {
  const auto [i, j] = std::pair(contact.a, contact.b);
  const auto describe = [&](Index g) {
    return fmt::format("({}, {}) of radius {}", p.x[at(g)], p.y[at(g)], p.radius[at(g)]);
  };
  if (p.x[at(i)] == p.x[at(j)] && p.y[at(i)] == p.y[at(j)])
    fail("grains {} and {} have the same centre: {} and {}", i, j, describe(i), describe(j));
  if (-contact.gap > allowed)
    fail(
        "grains {} and {} overlap by {} m, more than the {} m allowed (contacts.overlap_tolerance, "
        "--overlap-tolerance): {} and {}",
        i, j, -contact.gap, allowed, describe(i), describe(j));
}

}  // namespace

void check(const Packing& packing) {
  if (packing.size() == 0) throw Error("packing: expected at least one grain, met none");
  for (Index i = 0; i < packing.size(); ++i)
    if (!std::isfinite(packing.x[at(i)]) || !std::isfinite(packing.y[at(i)]))
      fail("grain {}: expected finite coordinates, met ({}, {})", i, packing.x[at(i)], packing.y[at(i)]);
  require_positive(packing.radius, "radius");
  require_positive(packing.mass, "mass");
}

Packing with_masses(Packing packing, const Masses& masses) {
  const MassModel model = masses.model.value_or(packing.mass.empty() ? MassModel::unit : MassModel::given);
  switch (model) {
    case MassModel::given:
      if (packing.mass.empty())
        throw Error("masses: expected a packing with masses (a 'mass' column) for model \"given\", met none");
      break;
    case MassModel::unit:
      packing.mass.assign(packing.radius.size(), 1.0);
      break;
    case MassModel::density:
      packing.mass.clear();
      for (const double r : packing.radius) packing.mass.push_back(masses.density * std::numbers::pi * r * r);
      break;
  }
  check(packing);
  return packing;
}

ContactNetwork detect_contacts(const Packing& packing, const ContactDetection& detection) {
  ContactNetwork network{.contacts = {}, .grains = packing.size()};
  if (packing.size() == 0) return network;
  network.contacts.reserve(at(3 * packing.size()));  // as many as a plane graph can have edges
  // r_i + r_j + tolerance min(r_i, r_j) is at most stretch (r_i + r_j).
  const double stretch = 1 + 0.5 * detection.tolerance;
  const DiskGrid grid(packing.x, packing.y, packing.radius, stretch);
  grid.for_each_pair([&](Index i, Index j) {
    const double reach = stretch * (packing.radius[at(i)] + packing.radius[at(j)]);
    // Most pairs end here, without a root; the margin is wide for rounding.
    const double dx = packing.x[at(j)] - packing.x[at(i)], dy = packing.y[at(j)] - packing.y[at(i)];
    if (dx * dx + dy * dy > 1.000001 * reach * reach) return;
    const Contact contact = pair_geometry(packing, i, j);
    const double smaller = std::min(packing.radius[at(i)], packing.radius[at(j)]);
    if (contact.gap > detection.tolerance * smaller) return;
    require_no_overlap(packing, contact, detection.overlap_tolerance * smaller);
    network.contacts.push_back(contact);
  });
  // The order of cells is an accident of the grid; the order of grains is the packing's own.
  network.contacts = sorted_by_bodies(network.contacts, packing.size());
  return network;
}

std::vector<Index> contact_counts(const ContactNetwork& network) {
  std::vector<Index> counts(at(network.grains), 0);
  for (const Contact& contact : network.contacts) {
    ++counts[at(contact.a)];
    ++counts[at(contact.b)];
  }
  return counts;
}

}  // namespace nscdd
