// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/statistics.hpp"
#include "study/case/case.hpp"
#include <nscdd/core/table.hpp>

namespace nscdd {

/// Kinematics of a contact network, rank W = rank H; 0 if ranks were not computed.
struct NetworkDegrees {
  Index grains = 0;
  Index contacts = 0;        ///< columns of H: two or, in space, three for each contact with friction
  Index rank = 0;            ///< of the Delassus operator
  Index rigid_modes = 0;     ///< grain motions without relative velocity at any contact: d n - rank
  Index hyperstaticity = 0;  ///< self-stresses: contacts - rank
};

struct Inspection {
  NetworkDegrees whole;  ///< without isolated grains
  std::vector<NetworkDegrees> subdomains;
  Index isolated_grains = 0;                ///< without contacts
  Index components = 0;                     ///< connected pieces of the network without isolated grains
  double coordination_number = 0;           ///< mean number of contacts per grain, 2 c / n
  std::map<Index, Index> interface_grains;  ///< multiplicity q >= 2 -> number of grains
  Index interface_dofs = 0;
  Index empty_subdomains = 0;
  /// Multiplicity of the eigenvalue 1 of B_0 by ranks: hyperstaticity of the whole minus that of the subdomains
  /// (self-stresses that cross the interface).
  Index unit_multiplicity = 0;
  bool ranks = false;  ///< ranks were computed
  // Of packings only:
  SolidFraction solid_fraction;
  double largest_overlap = 0;                ///< of two grains, in units of the smaller radius; 0 without one
  Index rattlers = 0;                        ///< see rattlers() in packing/statistics.hpp
  double coordination_without_rattlers = 0;  ///< of the other grains among themselves; NaN without any
  std::vector<SizeClass> sizes;              ///< ten classes of radii
};

/// Largest number of contacts for which ranks are computed: there they take seconds.
inline constexpr Index ranks_up_to_by_default = 100'000;

/// A case that moves gets the overlap tolerance of its simulation, unless it states one.
Case with_overlaps_of_motion(Case one);

/// Why the interface of a model is empty: "3 subdomains, no shared grain", and how many separate pieces the
/// partition leaves whole; "" if it is not empty.
std::string why_empty(const Model& model);

/// Remarks for a user: contacts that depend on rounding, and empty subdomains of METIS.
std::vector<std::string> remarks_on(const Model& model, const Partitioner& partitioner);

Inspection inspect(const Model& model, Index ranks_up_to = ranks_up_to_by_default);

/// A contact with its impulse in a choice of contacts, as in Figures 2-4 of [ADI12].
struct Link {
  const Model& model;
  const ContactChoice& choice;
  Index number;    ///< of the contact
  double impulse;  ///< kg m/s; NaN without an arriving velocity

  const Contact& contact() const { return model.network.contacts[at(number)]; }
};

/// ContactSet::all has the impulses of the linear rigid problem, as ContactSet::active.
ResultColumns<Link> link_columns(ContactSet contacts = ContactSet::active, Index dimension = 2);

/// All links in the order of the contacts. Returns the choice. Throws Error for a contact problem.
ContactChoice links(const Model& model, const Sink<Link>& sink, ContactSet contacts = ContactSet::active);

/// A contact of a contact problem, which has no geometry.
struct ProblemContact {
  const Model& model;
  Index number;
  Index body_a, body_b;  ///< body_b is -1 for a support
};
ResultColumns<ProblemContact> problem_contact_columns();
void problem_contacts(const Model& model, const Sink<ProblemContact>& sink);

/// A grain with its multiplicity and prescribed velocity.
struct PackingGrain {
  const Model& model;
  Index number, contacts;
};
ResultColumns<PackingGrain> grain_columns(Index dimension = 2);
void grains(const Model& model, const Sink<PackingGrain>& sink);  ///< throws Error as `links`

/// Grains by size, ten classes of radii.
struct GrainSizes {
  const Model& model;
  SizeClass one;
  double all;  ///< area of all grains, m^2, or volume, m^3
};
ResultColumns<GrainSizes> size_columns(Index dimension = 2);
void grain_sizes(const Model& model, const Sink<GrainSizes>& sink);  ///< throws Error as `links`

}  // namespace nscdd
