// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_order.hpp"

#include "linalg/random.hpp"

#include <algorithm>
#include <numeric>

namespace nscdd {
namespace {

// Contacts of a block: enough for out-of-order execution to find independent ones, few enough for the first cache.
constexpr Index interleaved_block = 256;

// Place of a cell of a 2^16 x 2^16 grid along Hilbert's curve.
std::uint32_t hilbert_place(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0;
  for (std::uint32_t side = 1U << 15; side > 0; side /= 2) {
    const bool right = (x & side) != 0, up = (y & side) != 0;
    place += side * side * ((right ? 3U : 0U) ^ (up ? 1U : 0U));
    if (!up) {  // turn the quadrant into the position of the first
      if (right) {
        x = ~x;
        y = ~y;
      }
      std::swap(x, y);
    }
  }
  return place;
}

std::vector<Index> along_curve(std::span<const std::array<double, 2>> points) {
  std::array<double, 2> low{infinity, infinity}, high{-infinity, -infinity};
  for (const auto& p : points)
    for (std::size_t k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  const double extent = std::max({high[0] - low[0], high[1] - low[1], 1e-300});
  const auto cell = [&](double x, double from) {
    return static_cast<std::uint32_t>(std::clamp((x - from) / extent * 65535, 0.0, 65535.0));
  };
  std::vector<std::pair<std::uint32_t, Index>> places;
  places.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k)
    places.emplace_back(hilbert_place(cell(points[k][0], low[0]), cell(points[k][1], low[1])), static_cast<Index>(k));
  std::sort(places.begin(), places.end());
  std::vector<Index> order;
  order.reserve(points.size());
  for (const auto& [place, k] : places) order.push_back(k);
  return order;
}

// Smallest colours such that no two contacts of one colour share a free disk, greedily in the given order within each
// block of `block` contacts.
std::vector<int> contact_colours(std::span<const DiskContact> contacts, std::span<const DiskVelocity> bodies,
                                 Index block) {
  // Bit c of used[i] says that colour c is taken at disk i within the present block. Disks have few contacts.
  // If one has more than 64, the rest get the last colour, whose contacts may then share this disk.
  constexpr int most = 63;
  std::vector<std::uint64_t> used(bodies.size(), 0);
  std::vector<Index> block_of(bodies.size(), -1);
  std::vector<int> colours(contacts.size());
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Index here = static_cast<Index>(k) / block;
    std::uint64_t taken = 0;
    const std::size_t ends[2] = {static_cast<std::size_t>(contacts[k].a), static_cast<std::size_t>(contacts[k].b)};
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

// The contacts in this order, by blocks, those of a block by their colours.
std::vector<Index> by_colour(const std::vector<Index>& order, std::span<const DiskContact> contacts,
                             std::span<const DiskVelocity> bodies, Index block) {
  std::vector<DiskContact> ordered;
  ordered.reserve(order.size());
  for (const Index k : order) ordered.push_back(contacts[at(k)]);
  const std::vector<int> colours = contact_colours(ordered, bodies, block);
  std::vector<Index> places(order.size());
  std::iota(places.begin(), places.end(), Index{0});
  for (Index first = 0; first < count(places); first += block)
    std::stable_sort(places.begin() + first, places.begin() + std::min(first + block, count(places)),
                     [&](Index p, Index q) { return colours[at(p)] < colours[at(q)]; });
  for (Index& place : places) place = order[at(place)];
  return places;
}

}  // namespace

std::vector<Index> contact_order(Choice<ContactOrder> order, std::span<const DiskContact> contacts,
                                 std::span<const DiskVelocity> bodies, std::uint64_t seed,
                                 std::span<const std::array<double, 2>> points) {
  std::vector<Index> result(contacts.size());
  std::iota(result.begin(), result.end(), Index{0});
  if (order == ContactOrder::coloured) return by_colour(result, contacts, bodies, std::max<Index>(1, count(result)));
  if (order == ContactOrder::interleaved)
    return by_colour(points.empty() ? result : along_curve(points), contacts, bodies, interleaved_block);
  if (order == ContactOrder::random) {
    RandomStream stream(seed);
    for (Index k = count(result) - 1; k > 0; --k) std::swap(result[at(k)], result[at(stream.below(k + 1))]);
  } else if (order == ContactOrder::reverse) {
    std::reverse(result.begin(), result.end());
  }
  return result;
}

}  // namespace nscdd
