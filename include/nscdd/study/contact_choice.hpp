// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/case.hpp>

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace nscdd {

/// Contacts that Stage 1 works with; Stage 2 always has them all.
enum class ContactSet {
  all,         ///< H_E
  active,      ///< G_E: those in compression in the linear rigid problem ([ADI12] section 4.3)
  unilateral,  ///< G_E: those that carry in the frictionless unilateral problem
};

constexpr auto names_of(ContactSet) { return std::to_array<std::string_view>({"all", "active", "unilateral"}); }

/// The contacts of a set, and how they were found.
struct ContactChoice {
  std::vector<char> active;  ///< one flag per contact
  Vector impulses;           ///< r behind the flags, kg m/s; empty for ContactSet::all
  /// "all", "compressive (unique)", "compressive (least norm)", "complementarity (unique)", or
  /// "complementarity (maximal)". The last means that other impulses solve the unilateral problem too; the
  /// flags are then those of every contact that carries in one of its solutions.
  std::string rule;
  /// The same as one word: "unique", "least_norm", "unilateral_unique", "unilateral_maximal", "none" for all.
  std::string solution;
  Index idle = 0;       ///< unilateral: contacts that neither carry nor open
  bool certain = true;  ///< the impulses were found to 1e-8
};

/// Throws Error where the choice depends on impulses and no grain has an arriving velocity.
ContactChoice choose_contacts(const Model& model, ContactSet contacts);

}  // namespace nscdd
