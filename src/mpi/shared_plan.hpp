// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/factor.hpp"
#include "mpi/communicator.hpp"

namespace nscdd::mpi {

/// A set of ranks first ... last - 1 that merge their parts of a matrix: one rank, or two sets.
struct ProcessSet {
  Index first = 0, last = 1;
  Index worker = 0;                    ///< the rank that merges
  Index parent = -1;                   ///< of the sets
  std::vector<Index> children = {};    ///< two, or none
  std::vector<Index> eliminated = {};  ///< border rows of groups that no other rank touches, group by group
  std::vector<Index> handed_on = {};   ///< other border rows on which their parts are not zero, group by group
};

/// The tree of these sets, children before parents; the first ones are the single ranks. `touched`: for each rank the
/// border rows on which its part is not zero, ascending; `group`: for each border row the first row of its group. A row
/// is eliminated once, in the smallest set that holds its whole group.
std::vector<ProcessSet> elimination_tree(const std::vector<std::vector<Index>>& touched,
                                         const std::vector<Index>& group);

/// Which rank eliminates which rows, for all matrices of a shared pattern. The constructor is collective.
struct SharedPlan {
  SharedPlan(std::shared_ptr<const Communicator> communicator, const InertiaPattern& pattern);

  const ProcessSet& joint_set() const { return sets[at(*joint)]; }
  /// Counts the operations of a pass up or down the tree: those of this rank, and those on the critical path. `flops`:
  /// of the fronts of one rank, or of one front of several ranks.
  void add_work(const std::function<double(const EliminationWork&)>& flops) const;

  Index front_rows() const { return count(joint_set().eliminated) + count(joint_set().handed_on); }

  std::shared_ptr<const Communicator> all;
  Index rank, border, own_rows;
  std::vector<Index> touched;  ///< border rows on which the part of this rank is not zero, ascending
  std::vector<ProcessSet> sets;
  /// Of the part of this rank: its own rows, then the touched ones. Those that others touch, too, are kept.
  std::unique_ptr<SymmetricFamily> own;
  std::vector<Index> kept;                 ///< its rows that are handed on, in that order
  std::vector<Index> place_of_eliminated;  ///< in `touched`, of the border rows that this rank eliminates itself
  std::optional<Index> joint;              ///< the set of several ranks that this one merges
  std::array<std::vector<Index>, 2> place_of_child;  ///< in the front of `joint`, of the rows of its children
  std::vector<Index> group_ends;                     ///< of the rows that `joint` eliminates
  std::vector<EliminationWork> work;                 ///< of all sets
};

}  // namespace nscdd::mpi
