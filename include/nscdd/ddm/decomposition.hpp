// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/ddm/partition.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

#include <vector>

namespace nscdd {

/// One subdomain E: the grains its contacts touch, with their share of mass.
struct Subdomain {
  std::vector<Index> grains;    ///< global numbers, ascending: n_E of them
  std::vector<Index> contacts;  ///< global numbers, ascending: c_E of them
  Vector inertia;  ///< diagonal of M_E, d n_E: a grain shared by q subdomains has 1/q of its inertia
  SparseMatrix h;  ///< H_E, d n_E x c_E
  SparseMatrix a;  ///< A_E, n_Gamma x d n_E, signed boolean
};

/// The copy of a grain that a subdomain holds.
struct GrainCopy {
  Index subdomain = 0;
  Index grain = 0;  ///< local number
};

/// d rows of the gluing condition: V_first - V_second = 0. Within a grain the second copy is always a new
/// one, so the rows of a grain span its copies as a tree whose root is the first copy met.
struct Gluing {
  Index grain = 0;  ///< global number
  GrainCopy first, second;
};

/// How the q copies of a shared grain are tied by q - 1 equalities. Every choice has full rank and gives the
/// same spectra; the chain is the one used throughout.
enum class GluingShape {
  chain,  ///< each copy to the next
  star,   ///< each copy to the first
};

/// A packing cut in the FETI way ([ADI12] section 2): sum_E A_E V_E = 0 glues the copies of shared grains.
struct Decomposition {
  Index dofs_per_grain = 2;
  Index contacts = 0;  ///< of the undivided packing
  std::vector<Subdomain> subdomains;
  std::vector<Gluing> gluing;       ///< row block k holds interface unknowns d k ... d k + d - 1
  std::vector<Index> multiplicity;  ///< subdomains per grain; 0 for a grain that touches nothing

  Index interface_size() const { return dofs_per_grain * count(gluing); }  ///< n_Gamma
};

/// Splits M, H along a partition of the contacts. Throws Error where the partition does not fit the problem.
Decomposition decompose(const ReferenceProblem& problem, const Partition& partition,
                        GluingShape shape = GluingShape::chain);

/// The same subdomains, grains and gluing with only some contacts kept: G_E in place of H_E
/// ([ADI12] eq. (28), G_E = H_E C_E). `kept`: one flag per contact of the packing.
Decomposition restrict_contacts(const Decomposition& parts, const std::vector<char>& kept);

/// The undivided packing put together again: one subdomain, whole masses, no interface. Its grains are those
/// that touch something.
Subdomain reassemble(const Decomposition& parts);

}  // namespace nscdd
