// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/interface.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

namespace nscdd {

/// Contacts distributed among subdomains 0 ... subdomains-1 ([ADI12] section 2); a subdomain may be empty.
struct Partition {
  Index subdomains = 1;
  std::vector<Index> subdomain_of_contact;  ///< one per column of H
};

/// Throws Error unless each of `contacts` contacts has an existing subdomain.
void check(const Partition& partition, Index contacts);

/// One subdomain E: the grains its contacts touch, with their share of mass.
struct Subdomain {
  std::vector<Index> grains;    ///< global numbers, ascending: n_E of them
  std::vector<Index> contacts;  ///< global numbers, ascending: c_E of them
  Vector inertia;               ///< diagonal of M_E, d n_E: a grain shared by q subdomains has 1/q of its inertia
  SparseMatrix h;               ///< H_E, d n_E x c_E
  SparseMatrix a;               ///< A_E, n_Gamma x d n_E, signed boolean
  Matrix centres = {};          ///< of the grains, d x n_E, m; empty if not known
  /// Spin unknowns of the grains at unit spins in the planes (x, y), (x, z), (y, z), a column each, m: s n_E x s for s
  /// spins of a grain; empty where grains do not turn, or if not known.
  Matrix turning = {};
};

/// A packing cut in the FETI way ([ADI12] section 2): sum_E A_E V_E = 0 glues the copies of shared grains.
struct Decomposition {
  Index contacts = 0;       ///< of the undivided packing
  Index first_contact = 0;  ///< number of the first contact of this rank, see PackingShare
  std::vector<Subdomain> subdomains;
  Interface interface;

  Index dofs_per_grain() const { return interface.dofs_per_grain(); }  ///< d
  Index interface_size() const { return interface.size(); }            ///< n_Gamma
};

/// The share of a packing that a rank holds: problem and partition of the contacts of its subdomains; by default all.
struct PackingShare {
  std::vector<Index> numbers = {};  ///< numbers in the packing of the problem's grains, ascending; empty: all
  std::vector<Index> process_of_subdomain = {};  ///< see `deal_out`; empty: one rank has all subdomains
  Processes processes = {};
};

/// Cuts M and H along a partition of the contacts. Collective on ranks that share a packing: the contacts of a rank are
/// numbered behind those of lower ranks. Throws Error if the partition does not fit the problem.
Decomposition decompose(const ReferenceProblem& problem, const Partition& partition,
                        GluingShape shape = GluingShape::chain, const PackingShare& share = {});

/// The two halves of `decompose` for a packing that every rank has. `cut` makes all but H_E and A_E, and
/// `with_matrices` adds these. A rank that drops other subdomains in between (`of_process`) never holds their matrices.
Decomposition cut(const ReferenceProblem& problem, const Partition& partition, GluingShape shape = GluingShape::chain,
                  const PackingShare& share = {});
Decomposition with_matrices(Decomposition parts, const ReferenceProblem& problem);

/// The same subdomains, grains and gluing with only some contacts: G_E = H_E C_E in place of H_E ([ADI12] eq. (28)).
/// `kept`: one flag per contact that this rank knows. Throws Error for another number of flags.
Decomposition restrict_contacts(const Decomposition& parts, const std::vector<char>& kept);

/// The interface and subdomains of one rank; others are empty. `process_of_subdomain`: see `deal_out`.
Decomposition of_process(Decomposition parts, const std::vector<Index>& process_of_subdomain,
                         const Processes& processes);

/// Throws Error for more processes than subdomains.
void require_subdomains(Index subdomains, Index processes);

/// The subdomain of this rank, for BDDC. Throws Error unless there are as many subdomains as ranks.
Index own_subdomain(const Decomposition& parts);

/// The rank of each subdomain. METIS cuts the graph of subdomains, whose edges weigh what two of them exchange, into
/// parts of about equal `weight` (one number per subdomain). Throws Error for more processes than subdomains.
std::vector<Index> deal_out(const Interface& interface, const std::vector<Index>& weight, Index processes);
/// The same with the number of unknowns of a subdomain as its weight.
std::vector<Index> deal_out(const Decomposition& parts, Index processes);

/// The undivided packing: one subdomain with whole masses and the grains that have contacts, without an interface.
Subdomain reassemble(const Decomposition& parts);

}  // namespace nscdd
