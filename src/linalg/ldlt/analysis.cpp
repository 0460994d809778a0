// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/ldlt/analysis.hpp"

#include "linalg/ldlt/ordering.hpp"

#include <algorithm>
#include <utility>

namespace nscdd {
namespace {

constexpr Index panel_width = 128;  // columns among which pivots are sought

// For each row without a group of its own, the groups that it touches.
std::vector<std::vector<Index>> touched_groups(const SparseMatrix& pattern, const std::vector<Index>& group) {
  std::vector<std::vector<Index>> touched(group.size());
  for (Index j = 0; j < pattern.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(pattern, j); e; ++e) {
      if (group[at(e.row())] < 0 && group[at(j)] >= 0) touched[at(e.row())].push_back(group[at(j)]);
      if (group[at(j)] < 0 && group[at(e.row())] >= 0) touched[at(j)].push_back(group[at(e.row())]);
    }
  return touched;
}

GroupGraph group_graph(const SparseMatrix& pattern, const std::vector<Index>& group,
                       const std::vector<std::vector<Index>>& touched, Index groups) {
  std::vector<std::vector<int>> lists(at(groups));
  const auto connect = [&](Index a, Index b) {
    if (a == b) return;
    lists[at(a)].push_back(static_cast<int>(b));
    lists[at(b)].push_back(static_cast<int>(a));
  };
  for (Index j = 0; j < pattern.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(pattern, j); e; ++e)
      if (group[at(e.row())] >= 0 && group[at(j)] >= 0) connect(group[at(e.row())], group[at(j)]);
  for (const std::vector<Index>& together : touched)
    for (std::size_t i = 0; i < together.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) connect(together[i], together[j]);
  GroupGraph graph;
  for (auto& list : lists) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    graph.neighbours.insert(graph.neighbours.end(), list.begin(), list.end());
    graph.start.push_back(static_cast<int>(graph.neighbours.size()));
  }
  return graph;
}

// Cuts the pivots of a front into panels. A panel ends where a group ends.
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

double elimination_flops(const Front& front) {  // the sum over the pivots of (rows left)^2
  const auto first = static_cast<double>(front.rows), last = static_cast<double>(front.update_rows());
  return (first * first * first - last * last * last) / 3;
}

}  // namespace

// The rows of the matrix in their groups, and the supernode and the position of each group.
struct RowGroups {
  RowGroups(std::vector<Index> of_rows, const std::vector<std::vector<Index>>& touched, Index groups,
            const Supernodes& nodes)
      : group(std::move(of_rows)), supernode(at(groups)), rank(group.size()), position_of(at(groups)) {
    for (Index k = 0; k < groups; ++k) position_of[at(nodes.group[at(k)])] = k;
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

SymmetricAnalysis::Implementation::Implementation(const SparseMatrix& pattern, std::vector<Index> group,
                                                  const std::vector<char>& last, const std::vector<Index>& border_rows)
    : size(pattern.rows()), border(border_rows) {
  const Index groups = size == 0 ? 0 : *std::max_element(group.begin(), group.end()) + 1;
  std::vector<int> weight(at(groups), 0);
  for (const Index g : group)
    if (g >= 0) ++weight[at(g)];
  const std::vector<std::vector<Index>> touched = touched_groups(pattern, group);
  const Supernodes nodes = ordered_supernodes(group_graph(pattern, group, touched, groups), weight, last);
  const RowGroups rows(std::move(group), touched, groups, nodes);
  lay_out_fronts(nodes, rows);
  share_out_entries(pattern, rows);
  place_rows(rows);
  mark_border();
}

// One front for each supernode.
void SymmetricAnalysis::Implementation::lay_out_fronts(const Supernodes& nodes, const RowGroups& groups) {
  fronts.resize(at(nodes.size()));
  for (Index s = 0; s < nodes.size(); ++s) {
    Front& front = fronts[at(s)];
    front.first_row = count(row_of);
    const int pivot_groups = nodes.first_column[at(s + 1)] - nodes.first_column[at(s)];
    const int first = nodes.first_row[at(s)], end = nodes.first_row[at(s + 1)];
    std::vector<Index> ends;
    for (int k = first; k < end; ++k) {
      const std::vector<int>& members = groups.members[at(nodes.group[at(nodes.rows[at(k)])])];
      row_of.insert(row_of.end(), members.begin(), members.end());
      if (k - first < pivot_groups) ends.push_back(count(row_of) - front.first_row);
    }
    front.rows = count(row_of) - front.first_row;
    front.pivots = ends.back();
    front.panels = cut_panels(ends);
    if (first + pivot_groups < end) front.parent = groups.supernode[at(nodes.rows[at(first + pivot_groups)])];
    front.subtree_flops += elimination_flops(front);
    factor_entries +=
        static_cast<double>(front.pivots) * (static_cast<double>(front.rows + front.update_rows()) + 1) / 2;
    if (front.parent >= 0) {
      fronts[at(front.parent)].children.push_back(s);
      fronts[at(front.parent)].subtree_flops += front.subtree_flops;
    }
  }
  front_of_row.resize(at(size));
  for (Index i = 0; i < size; ++i) front_of_row[at(i)] = static_cast<int>(groups.front(i));
}

// Each entry of the matrix belongs to the front that eliminates the earlier of its two rows.
void SymmetricAnalysis::Implementation::share_out_entries(const SparseMatrix& pattern, const RowGroups& groups) {
  const auto for_entries = [&](auto&& visit) {
    int source = 0;
    for (Index j = 0; j < size; ++j)
      for (SparseMatrix::InnerIterator e(pattern, j); e; ++e, ++source) {
        const Index earlier = groups.position(e.row()) < groups.position(j) ? e.row() : j;
        visit(fronts[at(groups.front(earlier))], FrontEntry{source, static_cast<int>(e.row()), static_cast<int>(j)});
      }
  };
  for_entries([](Front& front, const FrontEntry&) { ++front.last_entry; });  // counts them
  Index next = 0;
  for (Front& front : fronts) {
    const Index entries_of_front = front.last_entry;
    front.first_entry = front.last_entry = next;
    next += entries_of_front;
  }
  entries.resize(at(next));
  for_entries([&](Front& front, const FrontEntry& entry) { entries[at(front.last_entry++)] = entry; });
}

// From rows of the matrix to places in a front, for its entries and for the updates of its children.
void SymmetricAnalysis::Implementation::place_rows(const RowGroups& groups) {
  place_in_parent.assign(row_of.size(), -1);
  std::vector<int> first(groups.supernode.size(), 0);  // place of the first row of a group, by position
  const auto place = [&](int row) { return first[at(groups.position(row))] + groups.rank[at(row)]; };
  for (const Front& front : fronts) {
    for (Index i = 0; i < front.rows; ++i) {
      const int row = row_of[at(front.first_row + i)];
      if (groups.rank[at(row)] == 0) first[at(groups.position(row))] = static_cast<int>(i);
    }
    for (const Index c : front.children)
      for (Index i = fronts[at(c)].pivots; i < fronts[at(c)].rows; ++i) {
        const Index k = fronts[at(c)].first_row + i;
        place_in_parent[at(k)] = place(row_of[at(k)]);
      }
    for (Index k = front.first_entry; k < front.last_entry; ++k) {
      FrontEntry& entry = entries[at(k)];
      const int a = place(entry.row), b = place(entry.column);
      entry.row = std::max(a, b);
      entry.column = std::min(a, b);
    }
  }
}

void SymmetricAnalysis::Implementation::mark_border() {
  for (const Index row : border)
    for (Index s = front_of_row[at(row)]; s >= 0 && !fronts[at(s)].on_border; s = fronts[at(s)].parent)
      fronts[at(s)].on_border = true;
  for (Index s = 0; s < count(fronts); ++s) {
    const Front& front = fronts[at(s)];
    if (!front.on_border && (front.parent < 0 || fronts[at(front.parent)].on_border)) interior_roots.push_back(s);
  }
}

SymmetricAnalysis::SymmetricAnalysis(const SparseMatrix& pattern, const std::vector<Index>& group,
                                     const std::vector<char>& last, const std::vector<Index>& border)
    : implementation_(std::make_shared<const Implementation>(pattern, group, last, border)) {}

Index SymmetricAnalysis::rows() const { return implementation_->size; }
double SymmetricAnalysis::entries() const { return implementation_->factor_entries; }
double SymmetricAnalysis::flops() const {
  double all = 0;
  for (const Front& front : implementation_->fronts)
    if (front.parent < 0) all += front.subtree_flops;
  return all;
}

}  // namespace nscdd
