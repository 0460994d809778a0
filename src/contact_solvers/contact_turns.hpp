// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/random.hpp"

#include <algorithm>
#include <bit>

/// The order in which a sweep visits contacts.
namespace nscdd {

/// Contacts in a block of an interleaved order: enough for out-of-order execution, few enough for the first cache.
inline constexpr Index interleaved_block = 256;

/// Greedy colours of contacts that share nodes, such as grains; each block of contacts is coloured on its own.
class GreedyColours {
 public:
  explicit GreedyColours(Index nodes) { words_.emplace_back(at(nodes)); }

  void next_block() { ++block_; }

  /// The least colour that no contact of this block has marked at the nodes `seen`; marks it at `marked`.
  [[gnu::always_inline]] Index take_least(const auto& seen, const auto& marked) {
    for (std::size_t word = 0;; ++word) {
      if (word == words_.size()) words_.emplace_back(words_.front().size());
      std::uint64_t all = 0;
      for (const Index node : seen) all |= taken(word, node);
      const int least = std::countr_one(all);
      if (least == 64) continue;
      for (const Index node : marked) taken(word, node) |= std::uint64_t{1} << least;
      return 64 * static_cast<Index>(word) + least;
    }
  }

 private:
  struct Word {
    Index block = 0;          // in which colours were taken last
    std::uint64_t taken = 0;  // a bit for each colour
  };
  // Without a branch on memory: grains of an interleaved order are far apart there, and are waited for together.
  std::uint64_t& taken(std::size_t word, Index node) {
    Word& here = words_[word][at(node)];
    here.taken = here.block == block_ ? here.taken : 0;
    here.block = block_;
    return here.taken;
  }

  std::vector<std::vector<Word>> words_;  // of each node, 64 colours in a word
  Index block_ = 0;
};

inline std::vector<Index> shuffled(std::vector<Index> order, std::uint64_t seed) {
  RandomStream stream(seed);
  for (Index k = count(order) - 1; k > 0; --k) std::swap(order[at(k)], order[at(stream.below(k + 1))]);
  return order;
}

/// Sorts each block of an order by colours, which are given place by place (stable).
inline void sort_by_colour(std::vector<Index>& order, const std::vector<Index>& colours, Index block) {
  const std::vector<Index> before = order;
  std::vector<Index> next;  // place of the next contact of each colour
  for (Index first = 0; first < count(order); first += block) {
    const Index last = std::min(first + block, count(order));
    next.assign(at(2 + *std::max_element(colours.begin() + first, colours.begin() + last)), 0);
    next.front() = first;
    for (Index place = first; place < last; ++place) ++next[at(colours[at(place)] + 1)];
    std::partial_sum(next.begin(), next.end(), next.begin());
    for (Index place = first; place < last; ++place) order[at(next[at(colours[at(place)])]++)] = before[at(place)];
  }
}

}  // namespace nscdd
