// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/multifrontal/family.hpp"
#include "mpi/communicator.hpp"

namespace nscdd::mpi {

/// A set of processes first ... last - 1 whose parts of a matrix come together: one process, or two sets.
struct ProcessSet {
  Index first = 0, last = 1;
  Index worker = 0;                    ///< the process that puts them together
  Index parent = -1;                   ///< of the sets
  std::vector<Index> children = {};    ///< two, or none
  std::vector<Index> eliminated = {};  ///< border rows of groups that no other process touches, group by group
  std::vector<Index> handed_on = {};   ///< other border rows on which their parts are not zero, group by group
};

/// The tree of these sets, children before parents; the first ones are the single processes. `touched`: for each
/// process the border rows on which its part is not zero, ascending; `group`: of a border row, the first row of its
/// group. A row is eliminated once, in the smallest set that has its whole group.
std::vector<ProcessSet> elimination_tree(const std::vector<std::vector<Index>>& touched,
                                         const std::vector<Index>& group);

/// What all matrices of a pattern that processes share have in common: who eliminates which rows. All processes
/// construct it together.
struct SharedPlan {
  SharedPlan(std::shared_ptr<const Communicator> communicator, const InertiaPattern& pattern);

  const ProcessSet& joint_set() const { return sets[at(*joint)]; }
  /// Counts the operations of a step of all processes, in which they go up or down the tree of sets: those of this
  /// process, and along the longest way. `flops`: of the fronts of a process, or of one of several processes.
  void add_work(const std::function<double(const EliminationWork&)>& flops) const;

  Index front_rows() const { return count(joint_set().eliminated) + count(joint_set().handed_on); }

  std::shared_ptr<const Communicator> all;
  Index rank, border, own_rows;
  std::vector<Index> touched;  ///< border rows on which this process's part is not zero, ascending
  std::vector<ProcessSet> sets;
  /// Of the own part, whose rows are the own ones and behind them those touched. What others touch, too, is kept.
  std::unique_ptr<SymmetricFamily> own;
  std::vector<Index> kept;                 ///< its rows that are handed on, in that order
  std::vector<Index> place_of_eliminated;  ///< of border rows that are this process's alone, among those it touches
  std::optional<Index> joint;              ///< the set of several processes that this one puts together
  std::array<std::vector<Index>, 2> place_of_child;  ///< of what its children hand on, in its front
  std::vector<Index> group_ends;                     ///< of the rows that it eliminates
  std::vector<EliminationWork> work;                 ///< of all sets
};

}  // namespace nscdd::mpi
