// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/linalg/random.hpp>
#include <nscdd/mechanics/contact_order.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace nscdd {
namespace {

// Enough contacts for out-of-order execution to find independent ones, few enough to stay in the first cache.
constexpr Index interleaved_block = 256;

std::vector<Index> by_colour(const std::vector<int>& colours, Index block) {
  std::vector<Index> order(colours.size());
  std::iota(order.begin(), order.end(), Index{0});
  for (Index first = 0; first < count(order); first += block) {
    const Index last = std::min(first + block, count(order));
    std::stable_sort(order.begin() + first, order.begin() + last,
                     [&](Index p, Index q) { return colours[at(p)] < colours[at(q)]; });
  }
  return order;
}

}  // namespace

std::vector<int> contact_colours(std::span<const DiskContact> contacts, std::span<const DiskVelocity> bodies,
                                 Index block) {
  // Bit c of used[i]: colour c is taken at disk i within the present block. A disk has few contacts, but one
  // touched by more than 64 puts the rest into the last colour, which is then no longer free of conflicts.
  constexpr int most = 63;
  std::vector<std::uint64_t> used(bodies.size(), 0);
  std::vector<Index> block_of(bodies.size(), -1);
  std::vector<int> colours(contacts.size());
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Index here = static_cast<Index>(k) / block;
    std::uint64_t taken = 0;
    const std::size_t ends[2] = {static_cast<std::size_t>(contacts[k].a),
                                 static_cast<std::size_t>(contacts[k].b)};
    for (const std::size_t i : ends) {
      if (block_of[i] != here) {
        block_of[i] = here;
        used[i] = 0;
      }
      if (bodies[i].inverse_mass > 0) taken |= used[i];
    }
    int colour = 0;
    while (colour < most && (taken >> colour & 1U) != 0) ++colour;
    colours[k] = colour;
    for (const std::size_t i : ends) used[i] |= std::uint64_t{1} << colour;
  }
  return colours;
}

std::vector<Index> contact_order(const std::string& order, std::span<const DiskContact> contacts,
                                 std::span<const DiskVelocity> bodies, std::uint64_t seed) {
  const Index all = std::max<Index>(1, static_cast<Index>(contacts.size()));
  if (order == "coloured") return by_colour(contact_colours(contacts, bodies, all), all);
  if (order == "interleaved")
    return by_colour(contact_colours(contacts, bodies, interleaved_block), interleaved_block);
  std::vector<Index> result(contacts.size());
  std::iota(result.begin(), result.end(), Index{0});
  if (order == "random") {
    RandomStream stream(seed);
    for (Index k = count(result) - 1; k > 0; --k) std::swap(result[at(k)], result[at(stream.below(k + 1))]);
  } else if (order == "reverse") {
    std::reverse(result.begin(), result.end());
  } else if (order != "natural") {
    throw Error(fmt::format("order of contacts: expected one of {}, met '{}'", contact_orders, order));
  }
  return result;
}

}  // namespace nscdd
