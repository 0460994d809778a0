// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_problem.hpp"
#include "contact_solvers/contact_turns.hpp"
#include "mechanics/step_problem.hpp"
#include "two_stage/step_solver.hpp"
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

/// V += change(k) for each unknown k of a grain.
template <int D, class Change>
void add(GrainVelocity<D>& v, const Change& change) {
  GrainUnknowns<D> sum = unknowns(v);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += change(k);
  v = with_unknowns(sum, v.inverse_mass);
}

/// Mass of the copies of a shared grain. It decides what subdomains exchange.
enum class CopyMass {
  shares,  ///< of 1/q each: impulses F_Gamma glue the copies, and jumps of velocity correct F_Gamma
  /// The whole one (Schwarz): F is the resultant of the contact impulses on each copy, a load on all other copies.
  whole,
};

inline CopyMass copy_mass(const StepSolver& solver) {
  return has_part(solver.algorithm, StepPart::whole_copies) ? CopyMass::whole : CopyMass::shares;
}

/// A copy with the whole mass of its grain.
template <int D>
struct WholeCopy {
  Index grain = 0;               ///< local number
  Index own = 0;                 ///< row of its resultant
  Index first = 0, last = 0;     ///< rows of all copies of the grain
  GrainVelocity<D> common = {};  ///< V_free + M^-1 times the resultants exchanged, equal for all copies
};

/// Sum of the rows [first, last) of F but for row `own`.
template <int D>
GrainUnknowns<D> load_of_others(const Vector& f, Index first, Index last, Index own) {
  GrainUnknowns<D> load{};
  for (Index row = first; row < last; ++row)
    for (Index k = 0; k < unknowns_of_grain<D> && row != own; ++k) load[at(k)] += f[unknowns_of_grain<D> * row + k];
  return load;
}

/// Sums of `quantities` numbers over all contacts of a step, added up subdomain by subdomain, see ContactSums.
/// add(k, sums) adds those of contact k of this rank.
Vector sums_over_contacts(const Partition& partition, Index quantities, const Processes& processes, auto&& add) {
  return ContactSums{partition.subdomain_of_contact, partition.subdomains, processes}.add_up(
      quantities, count(partition.subdomain_of_contact), add);
}

/// One subdomain E of a step: its contacts in sweep order, and their bodies. A shared grain has the mass of a copy.
template <int D>
struct GranularSubdomain {
  std::vector<Index> bodies;   ///< of the step problem, in the order the sweep meets them
  std::vector<Index> numbers;  ///< of the contacts, in the step problem
  ContactRows<D> contacts;
  std::vector<GrainVelocity<D>> velocities;
  std::vector<WholeCopy<D>> whole_copies;  ///< empty if copies have shares of mass

  GrainContact<D> contact(std::size_t k) const { return contacts.contact(k, velocities); }
  /// Open, stick or slide for each contact, at its present impulse.
  std::vector<ContactStatus> statuses(const ContactLaw& law) const {
    std::vector<ContactStatus> result;
    for (std::size_t k = 0; k < contacts.size(); ++k) result.push_back(status_of(law, contact(k)));
    return result;
  }
};

/// A step divided as in FETI: contacts are distributed, and shared free grains are split and glued by a chain of
/// equalities. Driven bodies are not glued: every subdomain knows their motion.
template <int D>
struct GranularDecomposition {
  Index contacts = 0;  ///< of the step problem
  std::vector<GranularSubdomain<D>> subdomains;
  Interface interface;  ///< in StepProblem::numbers, with GrainUnknowns per grain
  CopyMass copies = CopyMass::shares;
  /// kg, of a copy in each row of F, a row of the gluing or a whole copy; 0 for grains of other ranks
  std::vector<double> copy_mass;
  std::vector<Index> subdomain_of_row;                       ///< of the whole copy, or of the first copy of the gluing
  std::function<void(std::span<double>)> sum_of_neighbours;  ///< of resultants
  ImpulseScale scale;                                        ///< of all contacts on all ranks, with whole grains

  Index interface_size() const { return unknowns_of_grain<D> * count(copy_mass); }  ///< of F, n_Gamma if it glues

  /// The scale of the impulses of a step, summed by subdomains: no bit depends on the ranks.
  static ImpulseScale scale_of(const StepProblem<D>& problem, const Partition& partition, const Processes& processes);

  /// Jumps sum_E A_E V_E, or V_E - V_common of whole copies, in rows of grains that this rank holds, by neighbours.
  Vector interface_jumps() const;
  /// The same in all rows; collective.
  Vector all_interface_jumps() const;
  /// The part of f^T g from rows of a subdomain. The parts of all subdomains add up to f^T g.
  double part_of_dot(Index subdomain, const Vector& f, const Vector& g) const;
  /// The part of |g|^2 from the rows of a subdomain, g the jumps sum_E A_E V_E.
  double squared_jumps(Index subdomain, const Vector& g) const;
  /// Unknowns of the free bodies, subdomain by subdomain, each followed by V_common of its whole copies, m/s.
  Vector free_velocities() const;
  /// Sum of |V|^2, rim speed included, over the copies of shared grains in a subdomain.
  double glued_speed_squared(Index subdomain) const;
  /// X_inf^-1 g, see Interface::solve_generic; M g of whole copies. Rims have their own inertia.
  Vector generic_interface_solve(const Vector& g) const;
  /// V_E <- V_E - M_E^-1 A_E^T change, for a change of F_Gamma; the load of the other copies on a whole one.
  void apply_interface_impulses(const Vector& change);
};

/// Puts the numbers of contacts, which ascend, in their order in memory and in a sweep. `taken`: of the bodies.
template <int D>
std::vector<Index> contact_order(Choice<ContactOrder> order, const StepProblem<D>& problem, std::vector<Index> numbers,
                                 std::uint64_t seed, GreedyColours& taken);

/// Splits a step along a partition of its contacts; velocities start at V_free, impulses at those of the step. `order`,
/// `seed`: see contact_order. Ranks that share the step pass the contacts of their own subdomains and get these and the
/// whole gluing. `process_of_subdomain`: see `deal_out`. Throws Error if the partition does not fit.
template <int D>
GranularDecomposition<D> decompose(const StepProblem<D>& problem, const Partition& partition,
                                   Choice<ContactOrder> order, std::uint64_t seed,
                                   const std::vector<Index>& process_of_subdomain = {}, const Processes& processes = {},
                                   CopyMass copies = CopyMass::shares);

/// M and H of a step for the linear analysis. A grain has the rows of its unknowns (a disk x, y, rim with inertia m, m,
/// m/2), empty ones in H if it is driven. Columns D c, ... are the normal and the tangential directions of contact c.
/// The arriving velocity is V_free. `bodies`: grains and bodies with free directions; not those of walls after them.
template <int D>
ReferenceProblem reference_problem(const StepProblem<D>& problem, Index bodies);

/// The partition of the columns of reference_problem, `dimension` for each contact.
Partition partition_of_columns(const Partition& of_contacts, Index dimension);

}  // namespace nscdd
