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

std::vector<ProcessSet> sets_of(Index processes) {
  std::vector<ProcessSet> sets(at(processes));
  std::vector<Index> level;
  for (Index p = 0; p < processes; ++p) {
    sets[at(p)] = {
        .first = p, .last = p + 1, .worker = p, .parent = -1, .children = {}, .eliminated = {}, .handed_on = {}};
    level.push_back(p);
  }
  while (level.size() > 1) {
    std::vector<Index> next;
    for (std::size_t k = 0; k + 1 < level.size(); k += 2) {
      ProcessSet &left = sets[at(level[k])], &right = sets[at(level[k + 1])];
      left.parent = right.parent = count(sets);
      next.push_back(count(sets));
      // The last process of the left half: no other set has the same one.
      sets.push_back({.first = left.first,
                      .last = right.last,
                      .worker = left.last - 1,
                      .parent = -1,
                      .children = {level[k], level[k + 1]},
                      .eliminated = {},
                      .handed_on = {}});
    }
    if (level.size() % 2 == 1) next.push_back(level.back());
    level = next;
  }
  return sets;
}

}  // namespace

std::vector<ProcessSet> elimination_tree(const std::vector<std::vector<Index>>& touched,
                                         const std::vector<Index>& group) {
  std::vector<Reach> reach(group.size());
  for (Index process = 0; process < count(touched); ++process)
    for (const Index row : touched[at(process)]) reach[at(group[at(row)])].include(process);
  std::vector<ProcessSet> sets = sets_of(count(touched));
  for (Index s = 0; s < count(sets); ++s) {
    ProcessSet& set = sets[at(s)];
    std::vector<Index> rows;
    if (set.children.empty()) {
      rows = touched[at(s)];
    } else {
      const std::vector<Index>&left = sets[at(set.children[0])].handed_on, &right = sets[at(set.children[1])].handed_on;
      std::ranges::set_union(left, right, std::back_inserter(rows));
    }
    for (const Index row : rows) {
      const Reach& of_row = reach[at(group[at(row)])];
      const bool here = set.first <= of_row.first && of_row.last < set.last;
      (here ? set.eliminated : set.handed_on).push_back(row);
    }
    std::ranges::stable_sort(set.eliminated, {}, [&](Index row) { return group[at(row)]; });
  }
  return sets;
}

}  // namespace nscdd::mpi
