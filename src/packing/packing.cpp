// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "packing/grain_grid.hpp"
#include <nscdd/packing/packing.hpp>

#include <numbers>

namespace nscdd {
namespace {

void require_positive(const std::vector<double>& values, const char* name) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || values[i] <= 0)
      fail("grain {}: expected a finite {} > 0, met {}", i, name, values[i]);
}

// "(x, y)" or "(x, y, z)".
std::string place(const Packing& p, Index grain) {
  const auto [x, y, z] = p.centre(grain);
  return p.z.empty() ? fmt::format("({}, {})", x, y) : fmt::format("({}, {}, {})", x, y, z);
}

// A pair (i, j) with its geometry, or a gap beyond the tolerance for a pair that does not touch.
Contact pair_geometry(const Packing& p, Index i, Index j) {
  const double dx = p.x[at(j)] - p.x[at(i)], dy = p.y[at(j)] - p.y[at(i)];
  const double dz = p.z.empty() ? 0 : p.z[at(j)] - p.z[at(i)];
  const double distance = p.z.empty() ? std::hypot(dx, dy) : std::hypot(dx, dy, dz);
  Contact contact{.a = i, .b = j};
  contact.gap = distance - (p.radius[at(i)] + p.radius[at(j)]);
  const auto [x, y, z] = p.centre(i);
  contact.midpoint = {x + 0.5 * dx, y + 0.5 * dy, z + 0.5 * dz};
  if (distance > 0) contact.normal = {dx / distance, dy / distance, dz / distance};
  return contact;
}

void require_no_overlap(const Packing& p, const Contact& contact, double allowed) {
  const auto [i, j] = std::pair(contact.a, contact.b);
  const auto describe = [&](Index g) { return fmt::format("{} of radius {}", place(p, g), p.radius[at(g)]); };
  if (p.centre(i) == p.centre(j))
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
  if (!packing.z.empty() && count(packing.z) != packing.size())
    fail("packing: expected a z for each of {} grains or for none, met {}", packing.size(), packing.z.size());
  for (Index i = 0; i < packing.size(); ++i)
    if (std::ranges::any_of(packing.centre(i), [](double one) { return !std::isfinite(one); }))
      fail("grain {}: expected finite coordinates, met {}", i, place(packing, i));
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
      for (const double r : packing.radius)
        packing.mass.push_back(masses.density * std::numbers::pi * r * r * (packing.z.empty() ? 1 : 4 * r / 3));
      break;
  }
  check(packing);
  return packing;
}

ContactNetwork detect_contacts(const Packing& packing, const ContactDetection& detection) {
  ContactNetwork network{.contacts = {}, .grains = packing.size(), .dimension = packing.dimension()};
  if (packing.size() == 0) return network;
  // As many as a plane graph can have edges; spheres of one size in a dense bed have about as many.
  network.contacts.reserve(at(3 * packing.size()));
  // r_i + r_j + tolerance min(r_i, r_j) is at most stretch (r_i + r_j).
  const double stretch = 1 + 0.5 * detection.tolerance;
  const GrainGrid grid({packing.x, packing.y, packing.z}, packing.radius, stretch);
  grid.for_each_pair([&](Index i, Index j) {
    const double reach = stretch * (packing.radius[at(i)] + packing.radius[at(j)]);
    // Most pairs end here, without a root; the margin is wide for rounding.
    const double dx = packing.x[at(j)] - packing.x[at(i)], dy = packing.y[at(j)] - packing.y[at(i)];
    const double dz = packing.z.empty() ? 0 : packing.z[at(j)] - packing.z[at(i)];
    if (dx * dx + dy * dy + dz * dz > 1.000001 * reach * reach) return;
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
