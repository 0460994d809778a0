// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/contact_turns.hpp"

#include "linalg/random.hpp"

#include <bit>
#include <numeric>

namespace nscdd {

Index GreedyColours::take_least(std::span<const Index> seen, std::span<const Index> marked, Index block) {
  for (const std::span<const Index> nodes : {seen, marked})
    for (const Index node : nodes)
      if (std::exchange(block_of_[at(node)], block) != block)
        for (std::vector<std::uint64_t>& word : words_) word[at(node)] = 0;
  for (std::size_t word = 0;; ++word) {
    if (word == words_.size()) words_.emplace_back(block_of_.size(), 0);
    std::uint64_t taken = 0;
    for (const Index node : seen) taken |= words_[word][at(node)];
    const int least = std::countr_one(taken);
    if (least == 64) continue;
    for (const Index node : marked) words_[word][at(node)] |= std::uint64_t{1} << least;
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
