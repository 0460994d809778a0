// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "packing/statistics.hpp"
#include <nscdd/core/table.hpp>
#include <nscdd/study/model.hpp>

namespace nscdd {

/// A link of the contact network with the impulse behind a choice of contacts: what Figures 2-4 draw.
/// Columns of this and the following tables are described in docs/formats.md.
struct Link {
  const Model& model;
  const ContactChoice& choice;
  Index number;    ///< of the contact
  double impulse;  ///< kg m/s; NaN without an arriving velocity

  const Contact& contact() const { return model.network.contacts[at(number)]; }
};

/// ContactSet::all shows the impulses of the linear rigid problem, as ContactSet::active does.
ResultColumns<Link> link_columns(ContactSet contacts = ContactSet::active);

/// All links in the order of the contacts. Returns the choice. Throws Error for a contact problem, of which
/// no geometry is known.
ContactChoice links(const Model& model, const Sink<Link>& sink, ContactSet contacts = ContactSet::active);

/// A contact of a contact problem, of which no geometry is known: its bodies and its subdomain.
struct ProblemContact {
  const Model& model;
  Index number;
  Index body_a, body_b;  ///< the second is -1 for a contact with a support
};
const ResultColumns<ProblemContact>& problem_contact_columns();
void problem_contacts(const Model& model, const Sink<ProblemContact>& sink);

/// A grain with its multiplicity and prescribed velocity.
struct Grain {
  const Model& model;
  Index number, contacts;
};
const ResultColumns<Grain>& grain_columns();
void grains(const Model& model, const Sink<Grain>& sink);  ///< throws Error as `links`

/// Grains by size, ten classes of radii.
struct GrainSizes {
  const Model& model;
  SizeClass one;
  double all_area;  ///< of all grains, m^2
};
const ResultColumns<GrainSizes>& size_columns();
void grain_sizes(const Model& model, const Sink<GrainSizes>& sink);  ///< throws Error as `links`

}  // namespace nscdd
