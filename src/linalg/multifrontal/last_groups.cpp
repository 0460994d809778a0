// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/last_groups.hpp"

#include <map>

namespace nscdd {
namespace {

template <class Visit>
void for_neighbours(const Graph& graph, std::size_t node, const Visit& visit) {
  for (int k = graph.start[node]; k < graph.start[node + 1]; ++k) visit(at(graph.neighbours[at(k)]));
}

void sort_once(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

// For each unmarked node the number of its connected part.
std::vector<int> connected_parts(const Graph& graph, const std::vector<char>& last) {
  std::vector<int> part(last.size(), -1);
  int parts = 0;
  std::vector<std::size_t> reached;
  for (std::size_t first = 0; first < last.size(); ++first) {
    if (last[first] || part[first] >= 0) continue;
    part[first] = parts;
    reached.push_back(first);
    while (!reached.empty()) {
      const std::size_t node = reached.back();
      reached.pop_back();
      for_neighbours(graph, node, [&](std::size_t other) {
        if (last[other] || part[other] >= 0) return;
        part[other] = parts;
        reached.push_back(other);
      });
    }
    ++parts;
  }
  return part;
}

struct Segment {
  std::vector<int> nodes;
  std::vector<int> cliques;  // of segments tied to each other: parts, and fill of eliminated segments
  Index weight = 0, tied = 0;
  int height = 0;  // of the chain of segments below
  bool eliminated = false;
};

std::vector<Segment> segments_of(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last,
                                 const std::vector<char>& hubs) {
  const std::vector<int> part = connected_parts(graph, last);
  std::map<std::vector<int>, Segment> by_parts;
  for (std::size_t node = 0; node < last.size(); ++node) {
    if (!last[node] || hubs[node]) continue;
    std::vector<int> touched;
    for_neighbours(graph, node, [&](std::size_t other) {
      if (!last[other]) touched.push_back(part[other]);
    });
    sort_once(touched);
    Segment& segment = by_parts[touched];
    segment.nodes.push_back(static_cast<int>(node));
    segment.weight += weight[node];
  }
  std::vector<Segment> segments;
  for (auto& [parts, segment] : by_parts) {
    segments.push_back(std::move(segment));
    segments.back().cliques = parts;
  }
  return segments;
}

// The quotient graph of minimum degree: eliminating a segment joins its cliques into one.
class Elimination {
 public:
  explicit Elimination(std::vector<Segment> segments) : segments_(std::move(segments)) {
    for (std::size_t s = 0; s < segments_.size(); ++s)
      for (const int clique : segments_[s].cliques) {
        if (clique >= count(cliques_)) cliques_.resize(at(clique + 1));
        cliques_[at(clique)].push_back(static_cast<int>(s));
      }
    for (Segment& segment : segments_) measure(segment);
  }

  std::vector<int> order() {
    std::vector<int> nodes;
    for (std::size_t k = 0; k < segments_.size(); ++k) {
      const auto next = std::ranges::min_element(segments_, {}, [](const Segment& segment) {
        return std::tuple(segment.eliminated, segment.tied, segment.height);
      });
      nodes.insert(nodes.end(), next->nodes.begin(), next->nodes.end());
      eliminate(*next);
    }
    return nodes;
  }

 private:
  // The segments left that share a clique with this one, and itself.
  std::vector<int> tied_to(const Segment& segment) const {
    std::vector<int> tied;
    for (const int clique : segment.cliques)
      for (const int other : cliques_[at(clique)])
        if (!segments_[at(other)].eliminated) tied.push_back(other);
    sort_once(tied);
    return tied;
  }

  void measure(Segment& segment) const {
    segment.tied = 0;
    for (const int other : tied_to(segment)) segment.tied += segments_[at(other)].weight;
  }

  void eliminate(Segment& segment) {
    segment.eliminated = true;
    const int joined = static_cast<int>(cliques_.size());
    cliques_.push_back(tied_to(segment));
    for (const int s : cliques_.back()) {
      Segment& other = segments_[at(s)];
      std::erase_if(other.cliques, [&](int clique) { return std::ranges::count(segment.cliques, clique) > 0; });
      other.cliques.push_back(joined);
      other.height = std::max(other.height, segment.height + 1);
    }
    for (const int s : cliques_.back()) measure(segments_[at(s)]);
  }

  std::vector<Segment> segments_;
  std::vector<std::vector<int>> cliques_;  // the segments of each
};

// Nodes tied to many others, such as the motions of a large rigid cluster to all impulses at its interface: eliminated
// before these they would tie them all to each other.
std::vector<char> hubs_of(const Graph& graph, const std::vector<char>& last) {
  constexpr int many = 16;
  std::vector<char> hubs(last.size(), 0);
  for (std::size_t node = 0; node < last.size(); ++node) {
    if (!last[node]) continue;
    int tied = 0;
    for_neighbours(graph, node, [&](std::size_t other) { tied += last[other] ? 1 : 0; });
    hubs[node] = tied > many;
  }
  return hubs;
}

}  // namespace

std::vector<int> order_of_last(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last) {
  const std::vector<char> hubs = hubs_of(graph, last);
  std::vector<int> order = Elimination(segments_of(graph, weight, last, hubs)).order();
  for (std::size_t node = 0; node < hubs.size(); ++node)
    if (hubs[node]) order.push_back(static_cast<int>(node));
  return order;
}

}  // namespace nscdd
