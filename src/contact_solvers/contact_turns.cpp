// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/contact_turns.hpp"

#include "linalg/random.hpp"

namespace nscdd {

std::vector<Index> random_order(Index contacts, std::uint64_t seed) {
  std::vector<Index> order = natural_order(contacts);
  RandomStream stream(seed);
  for (Index k = contacts - 1; k > 0; --k) std::swap(order[at(k)], order[at(stream.below(k + 1))]);
  return order;
}

void sort_by_colour(std::vector<Index>& order, const std::vector<Index>& colours, Index block) {
  for (Index first = 0; first < count(order); first += block)
    std::stable_sort(order.begin() + first, order.begin() + std::min(first + block, count(order)),
                     [&](Index a, Index b) { return colours[at(a)] < colours[at(b)]; });
}

}  // namespace nscdd
