// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/decomposition.hpp>

namespace nscdd {

/// How subdomains are coupled.
enum class DecompositionScheme {
  nscdd,    ///< copies share the mass of a grain, interface impulses glue them ([ADI12])
  schwarz,  ///< copies keep the whole mass, resultants of contact impulses are exchanged (`ddm_type` 0 of LMGC90)
};

constexpr auto names_of(DecompositionScheme) { return std::to_array<std::string_view>({"nscdd", "schwarz"}); }

/// The subdomains of the scheme schwarz: each copy has the whole mass of its grain, and each copy of a shared grain is
/// a row of the interface (Interface::of_copies). `parts`: of nscdd, with all contacts or some.
Decomposition whole_masses(const Decomposition& parts);

/// The resultants of the other copies of each grain: (1 1^T - I) p per grain. `interface`: of copies; p: its size.
Vector sum_of_others(const Interface& interface, const Vector& p);

/// Largest number of subdomains that share a grain; 1 if none is shared.
Index largest_multiplicity(const Interface& of_copies);

}  // namespace nscdd
