// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/group_order.hpp"

#include "linalg/multifrontal/last_groups.hpp"

namespace nscdd {
namespace {

constexpr int seed = 1;  // of METIS

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

// Moves the groups marked `kept` behind all others again, by their numbers (CHOLMOD traverses the tree branch by
// branch), and out of their supernodes into one of their own. Groups after a kept one are kept, too.
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
