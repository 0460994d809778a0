// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/ldlt/symmetric_analysis.hpp"

#include "linalg/one_metis.hpp"

#include <cholmod.h>
#include <metis.h>

#include <algorithm>
#include <new>
#include <numeric>

namespace nscdd {
namespace {

constexpr Index panel_width = 128;  // columns among which pivots are sought

// Adjacency of the groups, without loops, each list ascending.
struct GroupGraph {
  std::vector<int> start, neighbours;
};

// Groups that each row without one of its own touches, in the order of these rows.
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
  GroupGraph graph{{0}, {}};
  for (auto& list : lists) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    graph.neighbours.insert(graph.neighbours.end(), list.begin(), list.end());
    graph.start.push_back(static_cast<int>(graph.neighbours.size()));
  }
  return graph;
}

// Nested dissection; groups weigh as many rows as they have.
std::vector<int> nested_dissection(GroupGraph graph, std::vector<int> weight) {
  auto n = static_cast<idx_t>(weight.size());
  std::vector<idx_t> order(weight.size()), position(weight.size());
  std::iota(order.begin(), order.end(), 0);
  if (graph.neighbours.empty()) return order;  // METIS wants an edge
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  const auto lock = one_metis_at_a_time();
  if (METIS_NodeND(&n, graph.start.data(), graph.neighbours.data(), weight.data(), options, order.data(),
                   position.data()) != METIS_OK)
    throw std::bad_alloc();
  return order;
}

// The same with the groups marked `last` behind all others.
std::vector<int> dissection_with_last(const GroupGraph& graph, const std::vector<int>& weight,
                                      const std::vector<char>& last) {
  if (last.empty()) return nested_dissection(graph, weight);
  std::vector<int> kept, number(weight.size(), -1), kept_weight, order, tail;
  for (std::size_t g = 0; g < weight.size(); ++g)
    if (last[g]) {
      tail.push_back(static_cast<int>(g));
    } else {
      number[g] = static_cast<int>(kept.size());
      kept.push_back(static_cast<int>(g));
      kept_weight.push_back(weight[g]);
    }
  GroupGraph inner{{0}, {}};
  for (const int g : kept) {
    for (int k = graph.start[at(g)]; k < graph.start[at(g + 1)]; ++k)
      if (const int other = number[at(graph.neighbours[at(k)])]; other >= 0)
        inner.neighbours.push_back(other);
    inner.start.push_back(static_cast<int>(inner.neighbours.size()));
  }
  for (const int k : nested_dissection(inner, kept_weight)) order.push_back(kept[at(k)]);
  order.insert(order.end(), tail.begin(), tail.end());
  return order;
}

// Supernodes of groups: CHOLMOD's symbolic factorisation of the graph under a given order.
class Supernodes {
 public:
  Supernodes(const GroupGraph& graph, std::vector<int> order) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_GIVEN;
    common_.postorder = 1;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    std::vector<int> start{0}, rows;  // lower triangle with its diagonal
    const auto n = static_cast<int>(order.size());
    for (int j = 0; j < n; ++j) {
      rows.push_back(j);
      for (int k = graph.start[at(j)]; k < graph.start[at(j + 1)]; ++k)
        if (graph.neighbours[at(k)] > j) rows.push_back(graph.neighbours[at(k)]);
      start.push_back(static_cast<int>(rows.size()));
    }
    cholmod_sparse a{};
    a.nrow = a.ncol = order.size();
    a.nzmax = rows.size();
    a.p = start.data();
    a.i = rows.data();
    a.stype = -1;
    a.itype = CHOLMOD_INT;
    a.xtype = CHOLMOD_PATTERN;
    a.sorted = 1;
    a.packed = 1;
    factor_ = cholmod_analyze_p(&a, order.data(), nullptr, 0, &common_);
    if (factor_ == nullptr || common_.status < CHOLMOD_OK) {
      cholmod_free_factor(&factor_, &common_);
      cholmod_finish(&common_);
      throw std::bad_alloc();
    }
  }
  ~Supernodes() {
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }
  Supernodes(const Supernodes&) = delete;
  Supernodes& operator=(const Supernodes&) = delete;

  Index size() const { return static_cast<Index>(factor_->nsuper); }
  int group(Index position) const { return static_cast<const int*>(factor_->Perm)[position]; }
  Index first_column(Index s) const { return static_cast<const int*>(factor_->super)[s]; }
  Index first_row(Index s) const { return static_cast<const int*>(factor_->pi)[s]; }
  Index row(Index k) const { return static_cast<const int*>(factor_->s)[k]; }

 private:
  cholmod_common common_;
  cholmod_factor* factor_ = nullptr;
};

// Cuts the pivots of a front into panels that end where a group ends.
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

double elimination_flops(const Front& front) {  // sum over the pivots of (rows left)^2
  const auto first = static_cast<double>(front.rows), last = static_cast<double>(front.update_rows());
  return (first * first * first - last * last * last) / 3;
}

}  // namespace

SymmetricAnalysis::Implementation::Implementation(const SparseMatrix& pattern,
                                                  const std::vector<Index>& group_or_none,
                                                  const std::vector<char>& last,
                                                  const std::vector<Index>& border_rows)
    : size(pattern.rows()), border(border_rows) {
  std::vector<Index> group = group_or_none;
  const Index groups = size == 0 ? 0 : *std::max_element(group.begin(), group.end()) + 1;
  std::vector<int> weight(at(groups), 0);
  for (const Index g : group)
    if (g >= 0) ++weight[at(g)];
  const std::vector<std::vector<Index>> touched = touched_groups(pattern, group);
  const GroupGraph graph = group_graph(pattern, group, touched, groups);
  const Supernodes nodes(graph, dissection_with_last(graph, weight, last));

  std::vector<Index> front_of(at(groups)), position_of(at(groups));  // of a position; of a group
  for (Index s = 0; s < nodes.size(); ++s)
    for (Index k = nodes.first_column(s); k < nodes.first_column(s + 1); ++k) {
      front_of[at(k)] = s;
      position_of[at(nodes.group(k))] = k;
    }
  for (std::size_t i = 0; i < group.size(); ++i)
    if (group[i] < 0)
      group[i] = *std::max_element(touched[i].begin(), touched[i].end(),
                                   [&](Index a, Index b) { return position_of[at(a)] < position_of[at(b)]; });
  std::vector<int> first_member(at(groups) + 1, 0), members(at(size));
  for (const Index g : group) ++first_member[at(g) + 1];
  std::partial_sum(first_member.begin(), first_member.end(), first_member.begin());
  std::vector<int> next(first_member.begin(), first_member.end() - 1);
  for (Index i = 0; i < size; ++i) members[at(next[at(group[at(i)])]++)] = static_cast<int>(i);
  // Fronts by rows of the matrix, and where the rows of a child lie among those of its parent.
  fronts.resize(at(nodes.size()));
  std::vector<Index> place(at(groups), 0);  // of a group (by position) in the front at hand
  for (Index s = 0; s < nodes.size(); ++s) {
    Front& front = fronts[at(s)];
    front.first_row = count(row_of);
    const Index pivot_groups = nodes.first_column(s + 1) - nodes.first_column(s);
    std::vector<Index> ends;
    for (Index k = nodes.first_row(s); k < nodes.first_row(s + 1); ++k) {
      const int g = nodes.group(nodes.row(k));
      for (int m = first_member[at(g)]; m < first_member[at(g + 1)]; ++m) row_of.push_back(members[at(m)]);
      if (k - nodes.first_row(s) < pivot_groups) ends.push_back(count(row_of) - front.first_row);
    }
    front.rows = count(row_of) - front.first_row;
    front.pivots = ends.back();
    front.panels = cut_panels(ends);
    if (nodes.first_row(s) + pivot_groups < nodes.first_row(s + 1))
      front.parent = front_of[at(nodes.row(nodes.first_row(s) + pivot_groups))];
    front.subtree_flops += elimination_flops(front);
    factor_entries +=
        static_cast<double>(front.pivots) * (static_cast<double>(front.rows + front.update_rows()) + 1) / 2;
    if (front.parent >= 0) {
      fronts[at(front.parent)].children.push_back(s);
      fronts[at(front.parent)].subtree_flops += front.subtree_flops;
    }
  }
  front_of_row.resize(at(size));
  for (Index i = 0; i < size; ++i)
    front_of_row[at(i)] = static_cast<int>(front_of[at(position_of[at(group[at(i)])])]);
  place_in_parent.assign(row_of.size(), -1);
  for (const Front& front : fronts) {
    for (Index i = front.rows - 1; i >= 0; --i)  // place of the first row of each group
      place[at(position_of[at(group[at(row_of[at(front.first_row + i)])])])] = i;
    for (const Index c : front.children) {
      const Front& child = fronts[at(c)];
      Index within = 0;
      for (Index i = child.pivots; i < child.rows; ++i) {
        const Index row = child.first_row + i;
        const Index g = group[at(row_of[at(row)])];
        const bool same = i > child.pivots && group[at(row_of[at(row - 1)])] == g;
        within = same ? within + 1 : 0;
        place_in_parent[at(row)] = static_cast<int>(place[at(position_of[at(g)])] + within);
      }
    }
  }
  // Each entry of the matrix belongs to the front that eliminates the earlier of its two rows.
  std::vector<int> rank(at(size));  // of a row in its group
  for (Index g = 0; g < groups; ++g)
    for (int m = first_member[at(g)]; m < first_member[at(g + 1)]; ++m)
      rank[at(members[at(m)])] = m - first_member[at(g)];
  std::vector<Index> owner(at(pattern.nonZeros()));
  std::vector<Index> counts(fronts.size() + 1, 0);
  Index entry = 0;
  for (Index j = 0; j < size; ++j)
    for (SparseMatrix::InnerIterator e(pattern, j); e; ++e, ++entry) {
      const Index earlier = std::min(position_of[at(group[at(e.row())])], position_of[at(group[at(j)])]);
      owner[at(entry)] = front_of[at(earlier)];
      ++counts[at(owner[at(entry)] + 1)];
    }
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
  for (std::size_t s = 0; s < fronts.size(); ++s) fronts[s].first_entry = counts[s];
  entries.resize(at(entry));
  entry = 0;
  for (Index j = 0; j < size; ++j)
    for (SparseMatrix::InnerIterator e(pattern, j); e; ++e, ++entry)
      entries[at(counts[at(owner[at(entry)])]++)] = {static_cast<int>(entry), static_cast<int>(e.row()),
                                                     static_cast<int>(j)};
  // From rows of the matrix to places in the front, front by front.
  for (std::size_t s = 0; s < fronts.size(); ++s) {
    const Front& front = fronts[s];
    for (Index i = front.rows - 1; i >= 0; --i)
      place[at(position_of[at(group[at(row_of[at(front.first_row + i)])])])] = i;
    for (Index k = front.first_entry;
         k < (s + 1 < fronts.size() ? fronts[s + 1].first_entry : count(entries)); ++k) {
      FrontEntry& one = entries[at(k)];
      const auto placed = [&](int row) {
        return static_cast<int>(place[at(position_of[at(group[at(row)])])]) + rank[at(row)];
      };
      const int a = placed(one.row), b = placed(one.column);
      one.row = std::max(a, b);
      one.column = std::min(a, b);
    }
  }
  mark_border();
}

void SymmetricAnalysis::Implementation::mark_border() {
  for (const Index row : border)
    for (Index s = front_of_row[at(row)]; s >= 0 && !fronts[at(s)].on_border; s = fronts[at(s)].parent)
      fronts[at(s)].on_border = true;
  for (Index s = 0; s < count(fronts); ++s) {
    const Front& front = fronts[at(s)];
    if (!front.on_border && (front.parent < 0 || fronts[at(front.parent)].on_border))
      interior_roots.push_back(s);
  }
}

SymmetricAnalysis::SymmetricAnalysis(const SparseMatrix& pattern, const std::vector<Index>& group,
                                     const std::vector<char>& last, const std::vector<Index>& border)
    : implementation_(std::make_shared<const Implementation>(pattern, group, last, border)) {}

Index SymmetricAnalysis::rows() const { return implementation_->size; }
double SymmetricAnalysis::entries() const { return implementation_->factor_entries; }
double SymmetricAnalysis::interior_updates() const {
  double all = 0;
  for (const Index s : implementation_->interior_roots) {
    const auto rows = static_cast<double>(implementation_->fronts[at(s)].update_rows());
    all += rows * rows;
  }
  return all;
}
double SymmetricAnalysis::flops() const {
  double all = 0;
  for (const Front& front : implementation_->fronts)
    if (front.parent < 0) all += front.subtree_flops;
  return all;
}

}  // namespace nscdd
