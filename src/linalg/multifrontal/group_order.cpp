// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/group_order.hpp"

#include "core/disjoint_sets.hpp"

#include <map>

namespace nscdd {
namespace {

constexpr int seed = 1;  // of METIS

template <class Visit>
void for_neighbours(const Graph& graph, std::size_t node, const Visit& visit) {
  for (int k = graph.start[node]; k < graph.start[node + 1]; ++k) visit(at(graph.neighbours[at(k)]));
}

// The connected part of each unmarked node; parts are numbered by their first nodes.
std::vector<int> connected_parts(const Graph& graph, const std::vector<char>& last) {
  DisjointSets sets(count(last));
  for (std::size_t node = 0; node < last.size(); ++node)
    for_neighbours(graph, node, [&](std::size_t other) {
      if (!last[node] && !last[other]) sets.join(static_cast<Index>(node), static_cast<Index>(other));
    });
  std::vector<int> of_root(last.size(), -1), part(last.size(), -1);
  int parts = 0;
  for (std::size_t node = 0; node < last.size(); ++node) {
    if (last[node]) continue;
    int& own = of_root[at(sets.root(static_cast<Index>(node)))];
    part[node] = own < 0 ? own = parts++ : own;
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
    sort_unique(touched);
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
class MinimumDegree {
 public:
  explicit MinimumDegree(std::vector<Segment> segments) : segments_(std::move(segments)) {
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
  // The segments left that share a clique with this one, itself included.
  std::vector<int> tied_to(const Segment& segment) const {
    std::vector<int> tied;
    for (const int clique : segment.cliques)
      for (const int other : cliques_[at(clique)])
        if (!segments_[at(other)].eliminated) tied.push_back(other);
    sort_unique(tied);
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

// Nodes tied to many others, such as motions of a large rigid cluster: eliminated first, they would tie all of these.
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

struct Subgraph {
  Graph graph;
  std::vector<int> node;  // of the whole graph, for each of its own
};

// The subgraph of unmarked nodes.
Subgraph without(const Graph& graph, const std::vector<char>& marked) {
  Subgraph rest;
  std::vector<int> number(marked.size(), -1);
  for (std::size_t g = 0; g < marked.size(); ++g)
    if (!marked[g]) {
      number[g] = static_cast<int>(rest.node.size());
      rest.node.push_back(static_cast<int>(g));
    }
  for (const int g : rest.node) {
    for (int k = graph.start[at(g)]; k < graph.start[at(g + 1)]; ++k)
      if (const int other = number[at(graph.neighbours[at(k)])]; other >= 0) rest.graph.neighbours.push_back(other);
    rest.graph.start.push_back(static_cast<int>(rest.graph.neighbours.size()));
  }
  return rest;
}

template <class T>
std::vector<T> picked(const std::vector<T>& values, const std::vector<int>& places) {
  std::vector<T> result;
  result.reserve(places.size());
  for (const int k : places) result.push_back(values[at(k)]);
  return result;
}

// Moves the groups marked `last` behind the dissection of the others.
std::vector<int> dissection_with_last(const Graph& graph, const std::vector<int>& weight,
                                      const std::vector<char>& last) {
  if (last.empty()) return nested_dissection(graph, weight, seed);
  const Subgraph inner = without(graph, last);
  std::vector<int> order = picked(inner.node, nested_dissection(inner.graph, picked(weight, inner.node), seed));
  const std::vector<int> tail = order_of_last(graph, weight, last);
  order.insert(order.end(), tail.begin(), tail.end());
  return order;
}

// Moves the groups marked `kept` behind all others, by their numbers.
std::vector<int> order_of_elimination(const Graph& graph, const std::vector<int>& weight, const GroupFlags& flags) {
  const auto& [last, kept] = flags;
  if (kept.empty()) return dissection_with_last(graph, weight, last);
  const Subgraph inner = without(graph, kept);
  std::vector<int> order = picked(inner.node, dissection_with_last(inner.graph, picked(weight, inner.node),
                                                                   last.empty() ? last : picked(last, inner.node)));
  for (std::size_t g = 0; g < kept.size(); ++g)
    if (kept[g]) order.push_back(static_cast<int>(g));
  return order;
}

// Moves the groups marked `kept` into one supernode, behind all others and by their numbers, since CHOLMOD traverses
// the tree branch by branch. Groups after a kept one in its supernode are kept, too.
Supernodes with_kept_apart(const Supernodes& nodes, const std::vector<char>& kept) {
  const auto keeps = [&](int position) { return kept[at(nodes.node[at(position)])] != 0; };
  const int all = static_cast<int>(nodes.node.size());
  std::vector<int> order;  // of the old positions
  for (int k = 0; k < all; ++k)
    if (!keeps(k)) order.push_back(k);
  const auto first_kept = static_cast<std::ptrdiff_t>(order.size());
  for (int k = 0; k < all; ++k)
    if (keeps(k)) order.push_back(k);
  std::ranges::sort(order.begin() + first_kept, order.end(), {}, [&](int k) { return nodes.node[at(k)]; });
  std::vector<int> position(order.size());  // new ones
  for (int k = 0; k < all; ++k) position[at(order[at(k)])] = k;
  Supernodes apart{.node = picked(nodes.node, order), .first_column = {}, .first_row = {}, .rows = {}};
  const auto begin = [&](int column) {
    apart.first_column.push_back(column);
    apart.first_row.push_back(static_cast<int>(apart.rows.size()));
  };
  for (std::size_t s = 0; s < at(nodes.size()); ++s) {
    if (keeps(nodes.first_column[s])) continue;
    begin(position[at(nodes.first_column[s])]);
    for (int k = nodes.first_row[s]; k < nodes.first_row[s + 1]; ++k)
      apart.rows.push_back(position[at(nodes.rows[at(k)])]);
    std::sort(apart.rows.begin() + apart.first_row.back(), apart.rows.end());
  }
  begin(static_cast<int>(first_kept));
  for (int k = static_cast<int>(first_kept); k < all; ++k) apart.rows.push_back(k);
  begin(all);
  return apart;
}

}  // namespace

std::vector<int> order_of_last(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last) {
  const std::vector<char> hubs = hubs_of(graph, last);
  std::vector<int> order = MinimumDegree(segments_of(graph, weight, last, hubs)).order();
  for (std::size_t node = 0; node < hubs.size(); ++node)
    if (hubs[node]) order.push_back(static_cast<int>(node));
  return order;
}

Supernodes ordered_supernodes(const Graph& graph, const std::vector<int>& weight, const GroupFlags& flags,
                              const MergedColumns& merged) {
  if (weight.empty()) return {.node = {}, .first_column = {0}, .first_row = {0}, .rows = {}};
  SparseMatrix lower(count(weight), count(weight));
  for (Index j = 0; j < lower.cols(); ++j) {
    lower.startVec(j);
    lower.insertBack(j, j) = 1;
    for (int k = graph.start[at(j)]; k < graph.start[at(j + 1)]; ++k)
      if (graph.neighbours[at(k)] > j) lower.insertBack(graph.neighbours[at(k)], j) = 1;
  }
  lower.finalize();
  const Supernodes nodes = supernodes(lower, order_of_elimination(graph, weight, flags), merged);
  return flags.kept.empty() ? nodes : with_kept_apart(nodes, flags.kept);
}

}  // namespace nscdd
