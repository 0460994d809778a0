// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/contact_turns.hpp"

#include "linalg/random.hpp"

#include <bit>
#include <numeric>

namespace nscdd {

// Without a branch on memory: grains of an interleaved order are far apart there, and are waited for together.
std::uint64_t& GreedyColours::taken(std::size_t word, Index node, Index block) {
  Word& here = words_[word][at(node)];
  here.taken = here.block == block ? here.taken : 0;
  here.block = block;
  return here.taken;
}

Index GreedyColours::take_least(std::span<const Index> seen, std::span<const Index> marked, Index block) {
  for (std::size_t word = 0;; ++word) {
    if (word == words_.size()) words_.emplace_back(words_.front().size());
    std::uint64_t all = 0;
    for (const Index node : seen) all |= taken(word, node, block);
    const int least = std::countr_one(all);
    if (least == 64) continue;
    for (const Index node : marked) taken(word, node, block) |= std::uint64_t{1} << least;
    return 64 * static_cast<Index>(word) + least;
  }
}

std::vector<Index> natural_order(Index contacts) {
  std::vector<Index> order(at(contacts));
  std::iota(order.begin(), order.end(), Index{0});
  return order;
}

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
