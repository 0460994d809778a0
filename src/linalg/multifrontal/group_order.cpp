// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/disjoint_sets.hpp"
#include "linalg/multifrontal/analysis.hpp"

#include <map>

namespace nscdd {
namespace {

constexpr int seed = 1;  // of METIS

void for_neighbours(const Graph& graph, std::size_t node, const auto& visit) {
  for (int k = graph.start[node]; k < graph.start[node + 1]; ++k) visit(at(graph.neighbours[at(k)]));
}

// The connected part of each unmarked node; parts are numbered by their first nodes.
std::vector<Index> connected_parts(const Graph& graph, const std::vector<char>& last) {
  DisjointSets sets(count(last));
  for (std::size_t node = 0; node < last.size(); ++node)
    for_neighbours(graph, node, [&](std::size_t other) {
      if (!last[node] && !last[other]) sets.join(static_cast<Index>(node), static_cast<Index>(other));
    });
  std::vector<Index> part(last.size(), -1);
  for (std::size_t node = 0; node < last.size(); ++node)
    if (!last[node]) part[node] = sets.root(static_cast<Index>(node));
  return renumbered(part);
}

struct Segment {
  std::vector<int> nodes;
  std::vector<Index> cliques;  // of segments tied to each other: parts, and fill of eliminated segments
  Index weight = 0, tied = 0;
  int height = 0;  // of the chain of segments below
  bool eliminated = false;
};

std::vector<Segment> segments_of(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last,
                                 const std::vector<char>& hubs) {
  const std::vector<Index> part = connected_parts(graph, last);
  std::map<std::vector<Index>, Segment> by_parts;
  for (std::size_t node = 0; node < last.size(); ++node) {
    if (!last[node] || hubs[node]) continue;
    std::vector<Index> touched;
    for_neighbours(graph, node, [&](std::size_t other) {
      if (!last[other]) touched.push_back(part[other]);
    });
    sort_unique(touched);
    Segment& segment = by_parts[touched];
    segment.cliques = touched;
    segment.nodes.push_back(static_cast<int>(node));
    segment.weight += weight[node];
  }
  std::vector<Segment> segments;
  for (auto& [parts, segment] : by_parts) segments.push_back(std::move(segment));
  return segments;
}

// The quotient graph of minimum degree: eliminating a segment joins its cliques into one.
class MinimumDegree {
 public:
  explicit MinimumDegree(std::vector<Segment> segments) : segments_(std::move(segments)) {
    for (std::size_t s = 0; s < segments_.size(); ++s)
      for (const Index clique : segments_[s].cliques) {
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
    for (const Index clique : segment.cliques)
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
    const Index joined = count(cliques_);
    cliques_.push_back(tied_to(segment));
    for (const int s : cliques_.back()) {
      Segment& other = segments_[at(s)];
      std::erase_if(other.cliques, [&](Index clique) { return std::ranges::count(segment.cliques, clique) > 0; });
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

std::vector<int> marked_nodes(const std::vector<char>& marks) {
  std::vector<int> nodes;
  for (std::size_t node = 0; node < marks.size(); ++node)
    if (marks[node]) nodes.push_back(static_cast<int>(node));
  return nodes;
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
    for_neighbours(graph, at(g), [&](std::size_t other) {
      if (number[other] >= 0) rest.graph.neighbours.push_back(number[other]);
    });
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

// The dissection of the unmarked groups, then those marked `last`, then those marked `kept` by their numbers.
std::vector<int> order_of_elimination(const Graph& graph, const std::vector<int>& weight, const GroupFlags& flags) {
  const auto& [last, kept] = flags;  // with some kept: the order of all others, then those
  const std::vector<char>& moved = kept.empty() ? last : kept;
  if (moved.empty()) return nested_dissection(graph, weight, seed);
  const auto [inner, node] = without(graph, moved);
  GroupFlags of_inner;
  if (!kept.empty() && !last.empty()) of_inner.last = picked(last, node);
  std::vector<int> order = picked(node, order_of_elimination(inner, picked(weight, node), of_inner));
  const std::vector<int> tail = kept.empty() ? order_of_last(graph, weight, last) : marked_nodes(kept);
  order.insert(order.end(), tail.begin(), tail.end());
  return order;
}

// Moves the groups marked `kept` into one supernode, behind all others and by their numbers, since CHOLMOD traverses
// the tree branch by branch. Groups after a kept one in its supernode are kept, too.
Supernodes with_kept_apart(const Supernodes& nodes, const std::vector<char>& kept) {
  const auto keeps = [&](int position) { return kept[at(nodes.node[at(position)])] != 0; };
  const int all = static_cast<int>(nodes.node.size());
  std::vector<int> order = natural_order<int>(all);  // of the old positions
  std::ranges::sort(order, {}, [&](int k) { return std::pair(keeps(k), keeps(k) ? nodes.node[at(k)] : k); });
  const auto first_kept = static_cast<int>(std::ranges::find_if(order, keeps) - order.begin());
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
  begin(first_kept);
  for (int k = first_kept; k < all; ++k) apart.rows.push_back(k);
  begin(all);
  return apart;
}

}  // namespace

std::vector<int> order_of_last(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last) {
  const std::vector<char> hubs = hubs_of(graph, last);
  std::vector<int> order = MinimumDegree(segments_of(graph, weight, last, hubs)).order();
  const std::vector<int> tail = marked_nodes(hubs);
  order.insert(order.end(), tail.begin(), tail.end());
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
