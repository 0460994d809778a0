// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/analysis.hpp"

#include "linalg/sparse_entries.hpp"

namespace nscdd {
namespace {

constexpr Index panel_width = 128;  // columns among which pivots are sought

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
    sort_unique(list);
    graph.neighbours.insert(graph.neighbours.end(), list.begin(), list.end());
    graph.start.push_back(static_cast<int>(graph.neighbours.size()));
  }
  return graph;
}

double elimination_flops(const Front& front) {  // the sum over the pivots of (rows left)^2
  const auto first = static_cast<double>(front.rows), last = static_cast<double>(front.update_rows());
  return (first * first * first - last * last * last) / 3;
}

double factor_entries(const Front& front) {  // its columns of L and D
  return static_cast<double>(front.pivots) * (static_cast<double>(front.rows + front.update_rows()) + 1) / 2;
}

// The rows of the matrix in their groups, and the supernode and the position of each group.
struct RowGroups {
  RowGroups(std::vector<Index> of_rows, const std::vector<std::vector<Index>>& touched, Index groups,
            const Supernodes& nodes, const GroupFlags& flags)
      : group(std::move(of_rows)), supernode(at(groups)), rank(group.size()), position_of(at(groups)) {
    for (Index k = 0; k < groups; ++k) position_of[at(nodes.node[at(k)])] = k;
    for (Index s = 0; s < nodes.size(); ++s)
      for (int k = nodes.first_column[at(s)]; k < nodes.first_column[at(s + 1)]; ++k) supernode[at(k)] = s;
    // Groups behind the dissection take a row without a group only if it touches no other.
    const auto marked = [](const std::vector<char>& marks, Index g) { return !marks.empty() && marks[at(g)] != 0; };
    const auto behind = [&](Index g) { return marked(flags.last, g) || marked(flags.kept, g); };
    const auto earlier = [&](Index a, Index b) {
      return std::pair(!behind(a), position_of[at(a)]) < std::pair(!behind(b), position_of[at(b)]);
    };
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
    if (tree.keeps_rows && s + 1 == nodes.size()) continue;  // no pivots, no parent
    front.pivots = ends.back();
    front.panels = cut_panels(ends);
    if (first + pivot_groups < end) front.parent = groups.supernode[at(nodes.rows[at(first + pivot_groups)])];
    front.subtree_flops += elimination_flops(front);
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

// Replaces rows of the matrix by places in a front, for its entries and for the updates of its children.
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
                                     const GroupFlags& flags, const std::vector<Index>& border,
                                     const MergedColumns& merged) {
  const Index groups = group.empty() ? 0 : *std::max_element(group.begin(), group.end()) + 1;
  std::vector<int> weight(at(groups), 0);
  for (const Index g : group)
    if (g >= 0) ++weight[at(g)];
  const std::vector<std::vector<Index>> touched = touched_groups(pattern, group);
  const Supernodes nodes = ordered_supernodes(group_graph(pattern, group, touched, groups), weight, flags, merged);
  const RowGroups rows(group, touched, groups, nodes, flags);
  const auto tree = std::make_shared<FrontTree>();
  tree->rows = pattern.rows();
  tree->border = border;
  tree->keeps_rows = !flags.kept.empty();
  lay_out_fronts(*tree, nodes, rows);
  share_out_entries(*tree, pattern, rows);
  place_rows(*tree, rows);
  mark_border(*tree);
  tree_ = tree;
}

double EliminationWork::solve_flops(Fronts up, Fronts down) const {
  double flops = 0;
  for (const Fronts which : {up, down}) flops += 2 * (border_entries + (which == Fronts::all ? interior_entries : 0.0));
  return flops;
}

EliminationWork work_of_front(Index eliminated, Index others) {
  Front front;
  front.rows = eliminated + others;
  front.pivots = eliminated;
  return {.border_flops = elimination_flops(front), .border_entries = factor_entries(front)};
}

EliminationWork SymmetricAnalysis::work() const {
  EliminationWork work;
  for (const Front& front : tree_->fronts) {
    (front.on_border ? work.border_flops : work.interior_flops) += elimination_flops(front);
    (front.on_border ? work.border_entries : work.interior_entries) += factor_entries(front);
  }
  return work;
}

std::vector<Index> SymmetricAnalysis::kept_rows() const {
  if (!tree_->keeps_rows) return {};
  const Front& kept = tree_->fronts.back();
  return {tree_->rows_of(kept), tree_->rows_of(kept) + kept.rows};
}

}  // namespace nscdd
