// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/shared_copies.hpp"
#include "two_stage/cut_contacts.hpp"
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {

/// Colours of the contacts of a step. No two contacts of one colour share a free grain, whatever process has them.
struct ContactColours {
  std::vector<Index> of_contact;  ///< of the contacts of this process
  Index number = 0;               ///< of colours, in all processes
};

/// The contact problem of a step cut into subdomains. W is never formed:  W r = H^T M^-1 H r  goes by the velocities of
/// grains, of which every subdomain that a grain is in has a copy with its whole mass. A sweep visits the contacts of
/// one colour after those of another; within a colour they do not feel each other, so that a sweep is the same for any
/// cut.
///
/// With a law that pulls, r + pull obeys Coulomb's law: impulses here are these, and q makes up for it. Several
/// processes each have the contacts of their own subdomains; no bit of a product, a sweep or a sum depends on their
/// number, nor on that of threads.
template <int D>
class DividedContacts {
 public:
  /// `parts`: the cut of `problem`, which must outlive this.
  DividedContacts(const StepProblem<D>& problem, GranularDecomposition<D> parts, const ContactColours& colours);

  Vector product(const Vector& r) const;  ///< W r
  Vector without_impulses() const;        ///< q
  /// Gauss-Seidel sweeps, so many, on impulses r, which it returns; relaxed by omega.
  Vector swept(const Vector& r, Index sweeps, double omega);
  /// Velocities of the bodies of the problem under impulses r of all contacts, those of other processes too.
  std::vector<GrainVelocity<D>> velocities(const Vector& r) const;

  const StepProblem<D>& problem() const { return problem_; }
  const Processes& processes() const { return processes_; }

 private:
  // The contacts of a subdomain that have one colour.
  struct Coloured {
    std::vector<Index> numbers;  // in the problem
    ContactRows<D> contacts;
  };

  CopiesOfGrains<D> caused(const Vector& r) const;                        // M^-1 H r of the whole packing in every copy
  CopiesOfGrains<D> moved(const Vector& r) const;                         // the same in addition to the free velocities
  Vector relative_velocities(const CopiesOfGrains<D>& velocities) const;  // H^T V
  void for_each_subdomain(const std::function<void(Index)>& work) const;

  const StepProblem<D>& problem_;
  Processes processes_;
  std::vector<std::vector<Index>> bodies_;       // of each subdomain
  std::vector<std::vector<Coloured>> coloured_;  // of each subdomain, by colours
  std::vector<std::vector<Index>> changed_;      // copies that contacts of each colour change, see SharedCopies
  SharedCopies<D> shared_;
  Vector pull_;  // N s, at the normal components
};
extern template class DividedContacts<2>;
extern template class DividedContacts<3>;

/// The same for a contact solver, with the linear systems of `cut`. Both must outlive it. `partition`: of the contacts.
template <int D>
ContactProblem<D> problem_of(DividedContacts<D>& contacts, const Partition& partition, CutContacts<D>& cut,
                             Refinement refinement);

}  // namespace nscdd
