// SPDX-License-Identifier: GPL-3.0-or-later
// Any text is a packing or an Error; the contacts of a small packing are those that looking at every pair finds.
#include "require.hpp"
#include <nscdd/formats/packing_file.hpp>
#include <nscdd/packing/packing.hpp>

#include <set>

namespace {

using namespace nscdd;
using namespace fuzzing;

// Every pair looked at; empty where two grains overlap.
std::optional<std::vector<std::pair<Index, Index>>> brute_force(const Packing& p, const ContactDetection& detection) {
  std::vector<std::pair<Index, Index>> pairs;
  for (Index i = 0; i < p.size(); ++i)
    for (Index j = i + 1; j < p.size(); ++j) {
      const double dx = p.x[at(j)] - p.x[at(i)], dy = p.y[at(j)] - p.y[at(i)];
      const double dz = p.z.empty() ? 0 : p.z[at(j)] - p.z[at(i)];
      const double distance = p.z.empty() ? std::hypot(dx, dy) : std::hypot(dx, dy, dz);
      const double gap = distance - (p.radius[at(i)] + p.radius[at(j)]);
      const double smaller = std::min(p.radius[at(i)], p.radius[at(j)]);
      if (gap > detection.tolerance * smaller) continue;
      if ((dx == 0 && dy == 0 && dz == 0) || -gap > detection.overlap_tolerance * smaller) return std::nullopt;
      pairs.emplace_back(i, j);
    }
  return pairs;
}

bool is_float(double value) { return static_cast<double>(static_cast<float>(value)) == value; }

// Whether the last places of the coordinates leave open if two grains touch, by more than a tenth of the smaller one.
bool beyond_last_places(const Packing& p) {
  const bool floats =
      std::ranges::all_of(p.x, is_float) && std::ranges::all_of(p.y, is_float) && std::ranges::all_of(p.z, is_float);
  const double unit = floats ? double{std::numeric_limits<float>::epsilon()} : std::numeric_limits<double>::epsilon();
  for (Index i = 0; i < p.size(); ++i)
    for (Index j = i + 1; j < p.size(); ++j) {
      const auto a = p.centre(i), b = p.centre(j);
      double sum = p.radius[at(i)] + p.radius[at(j)];
      for (std::size_t k = 0; k < 3; ++k) sum += std::abs(a[k]) + std::abs(b[k]);
      const double distance = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
      const double gap = distance - (p.radius[at(i)] + p.radius[at(j)]);
      if (1.1 * unit * sum > 0.1 * std::min(p.radius[at(i)], p.radius[at(j)]) && std::abs(gap) < 3.3 * unit * sum)
        return true;
    }
  return false;
}

// Pairs that touch within the tolerances are contacts. Those beyond are counted: there the worth of digits decides.
void require_same(const Packing& packing, const ContactDetection& detection) {
  const auto network = unless_error([&] { return detect_contacts(packing, detection); });
  const auto expected = brute_force(packing, detection);
  require(network.has_value() || !expected || beyond_last_places(packing),
          "nothing is refused but an overlap and coordinates that cannot tell");
  if (!network) return;
  std::set<std::pair<Index, Index>> pairs;
  for (const Contact& contact : network->contacts) {
    pairs.insert({contact.a, contact.b});
    const auto [nx, ny, nz] = contact.normal;
    require(std::abs(std::hypot(nx, ny, nz) - 1) < 1e-12, "a normal is a unit vector");
  }
  require(count(pairs) == network->size(), "every contact is there once");
  const Index decided = network->rounding.decided.size;
  require(expected.has_value() || decided > 0, "an overlap is refused unless digits explain it");
  if (!expected) return;
  for (const auto& pair : *expected) require(pairs.contains(pair), "a pair that touches is a contact");
  require(network->size() == count(*expected) + decided, "digits decide on all other contacts");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::optional<Packing> packing = unless_error([&] { return parse_packing(text, "fuzz.csv"); });
  if (!packing) return 0;
  check(*packing);  // throws, and so ends the program, for a packing that should not have passed
  require(count(packing->y) == packing->size() && count(packing->radius) == packing->size(),
          "every grain has a centre and a radius");
  require(packing->z.empty() || count(packing->z) == packing->size(), "every grain has a z, or none");
  require(packing->mass.empty() || count(packing->mass) == packing->size(), "every grain has a mass, or none");
  if (packing->size() > 200 || !packing->clump.empty()) return 0;  // clumps have no contact network
  require_same(*packing, {});
  require_same(*packing, {.tolerance = 1, .overlap_tolerance = 1});
  return 0;
}
