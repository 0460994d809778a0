// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/choice.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/mechanics/friction_problem.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// A case made ready for analysis.
struct Model {
  std::string name;
  Packing packing;         ///< with masses; empty for a contact problem, as is the network
  ContactNetwork network;  ///< contacts with their geometry
  ReferenceProblem problem;
  Partition partition;
  Decomposition parts;
  std::shared_ptr<const GlobalFrictionProblem> friction = {};  ///< of a contact problem
  double flexibility = 1;                                      ///< scale of flexibilities, see flexibility_scale, 1/kg

  Index grains() const { return problem.grains(); }
  Index contacts() const { return problem.contacts() / problem.columns_per_contact; }
  bool has_geometry() const { return packing.size() > 0; }
};

/// The share of a rank: its own subdomains (see deal_out) and all undecomposed data, without the geometry of contacts.
Model of_process(Model model, const Processes& processes);

/// Throws Error, naming `what` needs the geometry, if the model is a contact problem, which has none.
void require_geometry(const Model& model, std::string_view what);

/// Contacts of Stage 1; Stage 2 always has all.
enum class ContactSet {
  all,         ///< H_E
  active,      ///< G_E: those in compression in the linear rigid problem ([ADI12] section 4.3)
  unilateral,  ///< G_E: those that carry in the frictionless unilateral problem
  frozen,  ///< G_E of a contact problem with friction: in its solution, sticking contacts, and normals of sliding ones
};

constexpr auto names_of(ContactSet) {
  return std::to_array<std::string_view>({"all", "active", "unilateral", "frozen"});
}

/// The contacts of a set, and how they were found.
struct ContactChoice {
  std::vector<char> active;  ///< one flag per column of H
  Vector impulses;           ///< r behind the flags, kg m/s; empty for ContactSet::all
  /// "all", "compressive (unique)", "compressive (least norm)", "complementarity (unique)", or "complementarity
  /// (maximal)": the unilateral problem has several solutions, and the flags are of contacts that carry in any of them.
  std::string rule;
  /// The same as one word: "unique", "least_norm", "unilateral_unique", "unilateral_maximal", "frozen", "none" for all.
  std::string solution;
  Index idle = 0;       ///< unilateral: contacts that neither carry nor open
  bool certain = true;  ///< the impulses were found to 1e-8
};

/// Throws Error if the choice depends on impulses and no grain has an arriving velocity.
ContactChoice choose_contacts(const Model& model, ContactSet contacts);

}  // namespace nscdd
