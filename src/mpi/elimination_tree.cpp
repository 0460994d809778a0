// SPDX-License-Identifier: GPL-3.0-or-later
#include "mpi/elimination_tree.hpp"

#include <limits>

namespace nscdd::mpi {
namespace {

// Which processes, from the first to the last, touch rows of a group.
struct Reach {
  Index first = std::numeric_limits<Index>::max(), last = -1;
  void include(Index process) {
    first = std::min(first, process);
    last = std::max(last, process);
  }
};

// Adds the sets of processes first ... last - 1, and returns the number of the whole.
// Halves are those of METIS_PartGraphRecursive, which numbers the parts of the first half before the others.
Index add_sets(std::vector<ProcessSet>& sets, Index first, Index last) {
  if (last - first == 1) return first;
  const Index middle = first + (last - first) / 2;
  const Index left = add_sets(sets, first, middle), right = add_sets(sets, middle, last), whole = count(sets);
  sets[at(left)].parent = sets[at(right)].parent = whole;
  // The last process of the left half: no other set has the same one.
  sets.push_back({.first = first,
                  .last = last,
                  .worker = middle - 1,
                  .parent = -1,
                  .children = {left, right},
                  .eliminated = {},
                  .handed_on = {}});
  return whole;
}

std::vector<ProcessSet> sets_of(Index processes) {
  std::vector<ProcessSet> sets;
  for (Index p = 0; p < processes; ++p)
    sets.push_back(
        {.first = p, .last = p + 1, .worker = p, .parent = -1, .children = {}, .eliminated = {}, .handed_on = {}});
  add_sets(sets, 0, processes);
  return sets;
}

}  // namespace

std::vector<ProcessSet> elimination_tree(const std::vector<std::vector<Index>>& touched,
                                         const std::vector<Index>& group) {
  std::vector<Reach> reach(group.size());
  for (Index process = 0; process < count(touched); ++process)
    for (const Index row : touched[at(process)]) reach[at(group[at(row)])].include(process);
  const auto group_by_group = [&](Index row) { return std::pair(group[at(row)], row); };
  std::vector<ProcessSet> sets = sets_of(count(touched));
  for (Index s = 0; s < count(sets); ++s) {
    ProcessSet& set = sets[at(s)];
    std::vector<Index> rows;
    if (set.children.empty()) {
      rows = touched[at(s)];
      std::ranges::sort(rows, {}, group_by_group);
    } else {
      const std::vector<Index>&left = sets[at(set.children[0])].handed_on, &right = sets[at(set.children[1])].handed_on;
      std::ranges::set_union(left, right, std::back_inserter(rows), {}, group_by_group, group_by_group);
    }
    for (const Index row : rows) {
      const Reach& of_row = reach[at(group[at(row)])];
      const bool here = set.first <= of_row.first && of_row.last < set.last;
      (here ? set.eliminated : set.handed_on).push_back(row);
    }
  }
  return sets;
}

}  // namespace nscdd::mpi
