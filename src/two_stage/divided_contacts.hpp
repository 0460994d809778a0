// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/solver_run.hpp"
#include "ddm/shared_copies.hpp"
#include "two_stage/cut_contacts.hpp"
#include "two_stage/granular_decomposition.hpp"

namespace nscdd {

/// Colours of the contacts of a step. No two contacts of one colour share a free grain, also across ranks.
struct ContactColours {
  std::vector<Index> of_contact;  ///< of the contacts of this rank
  Index number = 0;               ///< number of colours on all ranks
};

/// Iterative refinement of solutions. Impulses are velocities divided by P: a small P amplifies errors.
enum class Refinement { none, one_step };

/// The ContactProblem of a step cut into subdomains, with the linear systems of a CutContacts. W is never formed: W
/// r = H^T M^-1 H r comes from the velocities of grains. Each subdomain keeps a copy, with full mass, of every grain it
/// touches. A sweep visits the contacts by colours, which are independent sets: it is the same for any cut.
///
/// With a law that pulls, r + pull obeys Coulomb's law: impulses here are r + pull, and q is shifted accordingly. Each
/// rank has the contacts of its own subdomains. No bit depends on the number of ranks or threads.
template <int D>
class DividedContacts {
 public:
  static constexpr int dimension = D;

  /// `problem` must outlive this; `partition`: of its contacts; `parts`: its cut; `cut`: the cut of its H,
  /// or nothing for a solver without linear systems.
  DividedContacts(const StepProblem<D>& problem, const Partition& partition, GranularDecomposition<D> parts,
                  const ContactColours& colours, std::optional<CutContacts<D>> cut, Refinement refinement);

  ContactData data;

  Vector product(const Vector& r) const;  ///< W r
  auto sweeps(const FrictionSolverOptions& options) {
    return [this, omega = options.relaxation](const Vector& r, const SweepTurn& turn) { return swept(r, turn, omega); };
  }
  /// The impulses after some Gauss-Seidel sweeps from r, relaxed by omega.
  Vector swept(const Vector& r, const SweepTurn& turn, double omega);
  /// Velocities of the bodies of the problem under impulses r of all contacts, also of other ranks.
  std::vector<GrainVelocity<D>> velocities(const Vector& r) const;

  Vector symmetric_product(const Vector& r) const { return product(r); }
  Vector rest(const Vector& r) const { return Vector::Zero(r.size()); }
  bool factorise(std::vector<ContactRelation<D>> relations) { return cut_->factorise(std::move(relations)); }
  bool factorise_shifted(const Vector& shift) { return factorise(ContactRelation<D>::shifted(shift)); }
  Vector solve(const Vector& b);
  double take_operations() { return cut_ ? cut_->take_operations() : 0; }
  int determinant_sign() const { return cut_->determinant_sign(); }
  typename CutContacts<D>::Work work() const { return cut_ ? cut_->work() : typename CutContacts<D>::Work{}; }

 private:
  // The contacts of one colour in a subdomain.
  struct Coloured {
    std::vector<Index> numbers;  // in the problem
    ContactRows<D> contacts;
  };

  CopiesOfGrains<D> caused(const Vector& r) const;                        // M^-1 H r of the whole packing in every copy
  CopiesOfGrains<D> moved(const Vector& r) const;                         // the same plus the free velocities
  Vector relative_velocities(const CopiesOfGrains<D>& velocities) const;  // H^T V
  void set_data(const Partition& partition);
  void for_each_subdomain(const std::function<void(Index)>& work) const;
  // Calls visit(e, colour, k) for all contacts, in parallel over subdomains e.
  template <class Self, class Visit>
  static void for_each_contact(Self& self, const Visit& visit);

  const StepProblem<D>& problem_;
  Processes processes_;
  std::vector<std::vector<Index>> bodies_;       // of each subdomain
  std::vector<std::vector<Coloured>> coloured_;  // of each subdomain, by colours
  std::vector<std::vector<Index>> changed_;      // copies that each colour changes, see SharedCopies
  SharedCopies<D> shared_;
  Vector pull_;  // N s, in the normal components
  std::optional<CutContacts<D>> cut_;
  Refinement refinement_;
};

}  // namespace nscdd
