// SPDX-License-Identifier: GPL-3.0-or-later
// In what order processes eliminate the rows that they share.
#include "linalg/random.hpp"
#include "mpi/shared_plan.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

using namespace nscdd;
using mpi::elimination_tree;
using mpi::ProcessSet;

TEST_CASE("elimination tree: every row once, where its whole group is, and no process puts two pairs together") {
  RandomStream random(5);
  for (Index processes = 1; processes <= 21; ++processes) {
    CAPTURE(processes);
    // Groups of up to three rows, each touched by up to three processes.
    std::vector<Index> group;
    std::vector<std::set<Index>> met(at(processes));
    while (count(group) < 200) {
      const Index first = count(group), length = 1 + random.below(3);
      for (Index k = 0; k < length; ++k) {
        for (Index copy = 0; copy < 2; ++copy) met[at(random.below(processes))].insert(count(group));
        group.push_back(first);
      }
    }
    std::vector<std::vector<Index>> touched;
    for (const auto& rows : met) touched.emplace_back(rows.begin(), rows.end());
    const std::vector<ProcessSet> sets = elimination_tree(touched, group);
    REQUIRE(count(sets) == 2 * processes - 1);
    std::vector<Index> eliminated(group.size(), 0), jobs(at(processes), 0);
    for (Index s = 0; s < count(sets); ++s) {
      const ProcessSet& set = sets[at(s)];
      CHECK(set.worker >= set.first);
      CHECK(set.worker < set.last);
      CHECK((set.parent > s || s + 1 == count(sets)));
      if (!set.children.empty()) ++jobs[at(set.worker)];
      for (const auto& rows : {set.eliminated, set.handed_on})
        CHECK(std::ranges::is_sorted(rows, {}, [&](Index row) { return std::pair(group[at(row)], row); }));
      for (const Index row : set.eliminated) {
        ++eliminated[at(row)];
        for (Index p = 0; p < processes; ++p)  // nobody else has anything of its group
          for (const Index other : touched[at(p)])
            if (group[at(other)] == group[at(row)]) CHECK((set.first <= p && p < set.last));
      }
    }
    CHECK(sets.back().handed_on.empty());
    CHECK(sets.back().last - sets.back().first == processes);
    CHECK(std::ranges::all_of(jobs, [](Index n) { return n <= 1; }));
    CHECK(std::ranges::all_of(eliminated, [](Index n) { return n == 1; }));
  }
}
