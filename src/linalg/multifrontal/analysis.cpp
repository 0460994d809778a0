// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/analysis.hpp"

#include "linalg/multifrontal/factor.hpp"
#include "linalg/multifrontal/last_groups.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"

namespace nscdd {
namespace {

constexpr Index panel_width = 128;  // columns among which pivots are sought
constexpr int seed = 1;             // of METIS

struct Subgraph {
  Graph graph;
  std::vector<int> node;  // of the whole graph, for each of its own
};

// The nodes that are not marked, and what ties them.
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

// The groups marked `last` come behind the dissection of the others.
std::vector<int> dissection_with_last(const Graph& graph, const std::vector<int>& weight,
                                      const std::vector<char>& last) {
  if (last.empty()) return nested_dissection(graph, weight, seed);
  const Subgraph inner = without(graph, last);
  std::vector<int> order = picked(inner.node, nested_dissection(inner.graph, picked(weight, inner.node), seed));
  const std::vector<int> tail = order_of_last(graph, weight, last);
  order.insert(order.end(), tail.begin(), tail.end());
  return order;
}

// The groups marked `kept` come behind all others, by their numbers.
std::vector<int> order_of_elimination(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last,
                                      const std::vector<char>& kept) {
  if (kept.empty()) return dissection_with_last(graph, weight, last);
  const Subgraph inner = without(graph, kept);
  std::vector<int> order = picked(inner.node, dissection_with_last(inner.graph, picked(weight, inner.node),
                                                                   last.empty() ? last : picked(last, inner.node)));
  for (std::size_t g = 0; g < kept.size(); ++g)
    if (kept[g]) order.push_back(static_cast<int>(g));
  return order;
}

// Moves the groups marked `kept` behind all others again (CHOLMOD follows one branch of the tree after the other), and
// out of the supernodes that eliminate them, into one supernode of their own. What comes after a kept one is kept, too.
Supernodes with_kept_apart(const Supernodes& nodes, const std::vector<char>& kept) {
  const auto keeps = [&](int position) { return kept[at(nodes.node[at(position)])] != 0; };
  std::vector<int> position(nodes.node.size());  // new ones
  const int all = static_cast<int>(nodes.node.size());
  int next = 0;
  for (const bool behind : {false, true})
    for (int k = 0; k < all; ++k)
      if (keeps(k) == behind) position[at(k)] = next++;
  Supernodes apart{.node = std::vector<int>(nodes.node.size()), .first_column = {}, .first_row = {}, .rows = {}};
  for (int k = 0; k < all; ++k) apart.node[at(position[at(k)])] = nodes.node[at(k)];
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
  const auto first_kept = static_cast<int>(std::ranges::count(kept, 0));
  begin(first_kept);
  for (int k = first_kept; k < all; ++k) apart.rows.push_back(k);
  begin(all);
  return apart;
}

// Orders groups of `weight` rows each by nested dissection (METIS), those marked in `last` (one flag per group, or
// none) behind all others, those marked `kept` behind these, and finds the supernodes of the groups in that order.
Supernodes ordered_supernodes(const Graph& graph, const std::vector<int>& weight, const std::vector<char>& last,
                              const std::vector<char>& kept, const MergedColumns& merged) {
  if (weight.empty()) return {.node = {}, .first_column = {0}, .first_row = {0}, .rows = {}};
  SparseMatrix lower(count(weight), count(weight));
  for (Index j = 0; j < lower.cols(); ++j) {
    lower.startVec(j);
    lower.insertBack(j, j) = 1;
    for (int k = graph.start[at(j)]; k < graph.start[at(j + 1)]; ++k)
      if (graph.neighbours[at(k)] > j) lower.insertBack(graph.neighbours[at(k)], j) = 1;
  }
  lower.finalize();
  const Supernodes nodes = supernodes(lower, order_of_elimination(graph, weight, last, kept), merged);
  return kept.empty() ? nodes : with_kept_apart(nodes, kept);
}

// For each row without a group of its own, the groups that it touches.
std::vector<std::vector<Index>> touched_groups(const SparseMatrix& pattern, const std::vector<Index>& group) {
  std::vector<std::vector<Index>> touched(group.size());
  for_entries(pattern, [&](Index i, Index j, double) {
    if (group[at(i)] < 0 && group[at(j)] >= 0) touched[at(i)].push_back(group[at(j)]);
    if (group[at(j)] < 0 && group[at(i)] >= 0) touched[at(j)].push_back(group[at(i)]);
  });
  return touched;
}

Graph group_graph(const SparseMatrix& pattern, const std::vector<Index>& group,
                  const std::vector<std::vector<Index>>& touched, Index groups) {
  std::vector<std::vector<int>> lists(at(groups));
  const auto connect = [&](Index a, Index b) {
    if (a == b) return;
    lists[at(a)].push_back(static_cast<int>(b));
    lists[at(b)].push_back(static_cast<int>(a));
  };
  for_entries(pattern, [&](Index i, Index j, double) {
    if (group[at(i)] >= 0 && group[at(j)] >= 0) connect(group[at(i)], group[at(j)]);
  });
  for (const std::vector<Index>& together : touched)
    for (std::size_t i = 0; i < together.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) connect(together[i], together[j]);
  Graph graph;
  for (auto& list : lists) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    graph.neighbours.insert(graph.neighbours.end(), list.begin(), list.end());
    graph.start.push_back(static_cast<int>(graph.neighbours.size()));
  }
  return graph;
}

double elimination_flops(const Front& front) {  // the sum over the pivots of (rows left)^2
  const auto first = static_cast<double>(front.rows), last = static_cast<double>(front.update_rows());
  return (first * first * first - last * last * last) / 3;
}

// The rows of the matrix in their groups, and the supernode and the position of each group.
struct RowGroups {
  RowGroups(std::vector<Index> of_rows, const std::vector<std::vector<Index>>& touched, Index groups,
            const Supernodes& nodes)
      : group(std::move(of_rows)), supernode(at(groups)), rank(group.size()), position_of(at(groups)) {
    for (Index k = 0; k < groups; ++k) position_of[at(nodes.node[at(k)])] = k;
    for (Index s = 0; s < nodes.size(); ++s)
      for (int k = nodes.first_column[at(s)]; k < nodes.first_column[at(s + 1)]; ++k) supernode[at(k)] = s;
    const auto earlier = [&](Index a, Index b) { return position_of[at(a)] < position_of[at(b)]; };
    for (std::size_t i = 0; i < group.size(); ++i)
      if (group[i] < 0) group[i] = *std::max_element(touched[i].begin(), touched[i].end(), earlier);
    members.resize(at(groups));
    for (std::size_t i = 0; i < group.size(); ++i) {
      std::vector<int>& others = members[at(group[i])];
      rank[i] = static_cast<int>(others.size());
      others.push_back(static_cast<int>(i));
    }
  }
  Index position(Index row) const { return position_of[at(group[at(row)])]; }
  Index front(Index row) const { return supernode[at(position(row))]; }

  std::vector<Index> group;               // of a row
  std::vector<Index> supernode;           // that eliminates the group at a position
  std::vector<std::vector<int>> members;  // rows of a group, ascending
  std::vector<int> rank;                  // of a row in its group
  std::vector<Index> position_of;         // of a group
};

// One front for each supernode.
void lay_out_fronts(FrontTree& tree, const Supernodes& nodes, const RowGroups& groups) {
  tree.fronts.resize(at(nodes.size()));
  for (Index s = 0; s < nodes.size(); ++s) {
    Front& front = tree.fronts[at(s)];
    front.first_row = count(tree.row_of);
    const int pivot_groups = nodes.first_column[at(s + 1)] - nodes.first_column[at(s)];
    const int first = nodes.first_row[at(s)], end = nodes.first_row[at(s + 1)];
    std::vector<Index> ends;
    for (int k = first; k < end; ++k) {
      const std::vector<int>& members = groups.members[at(nodes.node[at(nodes.rows[at(k)])])];
      tree.row_of.insert(tree.row_of.end(), members.begin(), members.end());
      if (k - first < pivot_groups) ends.push_back(count(tree.row_of) - front.first_row);
    }
    front.rows = count(tree.row_of) - front.first_row;
    if (tree.keeps_rows && s + 1 == nodes.size()) {
      front.pivots = 0;
      continue;
    }
    front.pivots = ends.back();
    front.panels = cut_panels(ends);
    if (first + pivot_groups < end) front.parent = groups.supernode[at(nodes.rows[at(first + pivot_groups)])];
    front.subtree_flops += elimination_flops(front);
    tree.factor_entries +=
        static_cast<double>(front.pivots) * (static_cast<double>(front.rows + front.update_rows()) + 1) / 2;
    if (front.parent >= 0) {
      tree.fronts[at(front.parent)].children.push_back(s);
      tree.fronts[at(front.parent)].subtree_flops += front.subtree_flops;
    }
  }
  tree.front_of_row.resize(at(tree.rows));
  for (Index i = 0; i < tree.rows; ++i) tree.front_of_row[at(i)] = static_cast<int>(groups.front(i));
}

// Each entry of the matrix belongs to the front that eliminates the earlier of its two rows.
void share_out_entries(FrontTree& tree, const SparseMatrix& pattern, const RowGroups& groups) {
  const auto for_front_entries = [&](auto&& visit) {
    int source = 0;
    for_entries(pattern, [&](Index i, Index j, double) {
      const Index earlier = groups.position(i) < groups.position(j) ? i : j;
      visit(tree.fronts[at(groups.front(earlier))], FrontEntry{source++, static_cast<int>(i), static_cast<int>(j)});
    });
  };
  for_front_entries([](Front& front, const FrontEntry&) { ++front.last_entry; });  // counts them
  Index next = 0;
  for (Front& front : tree.fronts) {
    const Index entries_of_front = front.last_entry;
    front.first_entry = front.last_entry = next;
    next += entries_of_front;
  }
  tree.entries.resize(at(next));
  for_front_entries([&](Front& front, const FrontEntry& entry) { tree.entries[at(front.last_entry++)] = entry; });
}

// From rows of the matrix to places in a front, for its entries and for the updates of its children.
void place_rows(FrontTree& tree, const RowGroups& groups) {
  tree.place_in_parent.assign(tree.row_of.size(), -1);
  std::vector<int> first(groups.supernode.size(), 0);  // place of the first row of a group, by position
  const auto place = [&](int row) { return first[at(groups.position(row))] + groups.rank[at(row)]; };
  for (const Front& front : tree.fronts) {
    for (Index i = 0; i < front.rows; ++i) {
      const int row = tree.row_of[at(front.first_row + i)];
      if (groups.rank[at(row)] == 0) first[at(groups.position(row))] = static_cast<int>(i);
    }
    for (const Index c : front.children)
      for (Index i = tree.fronts[at(c)].pivots; i < tree.fronts[at(c)].rows; ++i) {
        const Index k = tree.fronts[at(c)].first_row + i;
        tree.place_in_parent[at(k)] = place(tree.row_of[at(k)]);
      }
    for (Index k = front.first_entry; k < front.last_entry; ++k) {
      FrontEntry& entry = tree.entries[at(k)];
      const int a = place(entry.row), b = place(entry.column);
      entry.row = std::max(a, b);
      entry.column = std::min(a, b);
    }
  }
}

void mark_border(FrontTree& tree) {
  for (const Index row : tree.border)
    for (Index s = tree.front_of_row[at(row)]; s >= 0 && !tree.fronts[at(s)].on_border; s = tree.fronts[at(s)].parent)
      tree.fronts[at(s)].on_border = true;
  if (tree.keeps_rows) tree.fronts.back().on_border = true;
  for (Index s = 0; s < count(tree.fronts); ++s) {
    const Front& front = tree.fronts[at(s)];
    if (!front.on_border && (front.parent < 0 || tree.fronts[at(front.parent)].on_border))
      tree.interior_roots.push_back(s);
  }
}

}  // namespace

std::vector<Index> cut_panels(const std::vector<Index>& group_ends) {
  std::vector<Index> panels;
  Index start = 0;
  for (std::size_t g = 0; g < group_ends.size(); ++g)
    if (g + 1 == group_ends.size() || group_ends[g + 1] - start > panel_width) {
      panels.push_back(group_ends[g]);
      start = group_ends[g];
    }
  return panels;
}

SymmetricAnalysis::SymmetricAnalysis(const SparseMatrix& pattern, const std::vector<Index>& group,
                                     const std::vector<char>& last, const std::vector<Index>& border,
                                     const std::vector<char>& kept, const MergedColumns& merged) {
  const Index groups = group.empty() ? 0 : *std::max_element(group.begin(), group.end()) + 1;
  std::vector<int> weight(at(groups), 0);
  for (const Index g : group)
    if (g >= 0) ++weight[at(g)];
  const std::vector<std::vector<Index>> touched = touched_groups(pattern, group);
  const Supernodes nodes = ordered_supernodes(group_graph(pattern, group, touched, groups), weight, last, kept, merged);
  const RowGroups rows(group, touched, groups, nodes);
  const auto tree = std::make_shared<FrontTree>();
  tree->rows = pattern.rows();
  tree->border = border;
  tree->keeps_rows = !kept.empty();
  lay_out_fronts(*tree, nodes, rows);
  share_out_entries(*tree, pattern, rows);
  place_rows(*tree, rows);
  mark_border(*tree);
  tree_ = tree;
}

double SymmetricAnalysis::entries() const { return tree_->factor_entries; }

std::vector<Index> SymmetricAnalysis::kept_rows() const {
  if (!tree_->keeps_rows) return {};
  const Front& kept = tree_->fronts.back();
  return {tree_->rows_of(kept), tree_->rows_of(kept) + kept.rows};
}

}  // namespace nscdd
