// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd::mpi {

/// A set of processes first ... last - 1 whose parts of a matrix come together: one process, or two sets.
struct ProcessSet {
  Index first = 0, last = 1;
  Index worker = 0;               ///< the process that puts them together
  Index parent = -1;              ///< of the sets
  std::vector<Index> children;    ///< two, or none
  std::vector<Index> eliminated;  ///< border rows of groups that no other process touches, group by group
  std::vector<Index> handed_on;   ///< other border rows on which their parts are not zero, group by group
};

/// The tree of these sets, children before parents; the first ones are the single processes. `touched`: for each
/// process the border rows on which its part is not zero, ascending; `group`: of a border row, the first row of its
/// group. A row is eliminated once, in the smallest set that has its whole group.
std::vector<ProcessSet> elimination_tree(const std::vector<std::vector<Index>>& touched,
                                         const std::vector<Index>& group);

}  // namespace nscdd::mpi
