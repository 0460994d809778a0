// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/ddm/contraction.hpp>

namespace nscdd {

Decomposition whole_masses(const Decomposition& parts) {
  Decomposition whole = parts;
  const Index d = parts.dofs_per_grain();
  whole.interface = parts.interface.of_copies();
  for (Index e = 0; e < count(whole.subdomains); ++e) {
    Subdomain& subdomain = whole.subdomains[at(e)];
    for (Index i = 0; i < count(subdomain.grains); ++i)
      subdomain.inertia.segment(d * i, d) *= static_cast<double>(parts.interface.multiplicity(subdomain.grains[at(i)]));
    subdomain.a = whole.interface.matrix(e);
  }
  return whole;
}

Vector sum_of_others(const Interface& interface, const Vector& p) {
  const Index d = interface.dofs_per_grain();
  Vector others(p.size());
  interface.for_glued_grains([&](Index, Index first, Index last) {
    const Index copies = last - first;
    const auto own = p.segment(d * first, d * copies).reshaped(d, copies);
    const Vector sum = own.rowwise().sum();
    others.segment(d * first, d * copies).reshaped(d, copies) = sum.replicate(1, copies) - own;
  });
  return others;
}

Index largest_multiplicity(const Interface& of_copies) {
  Index largest = 1;
  of_copies.for_glued_grains([&](Index, Index first, Index last) { largest = std::max(largest, last - first); });
  return largest;
}

Vector Contraction::apply(const Vector& f) const {
  if (!schwarz()) return f - relaxation * preconditioner.solve(system.apply(f));
  const Vector others = sum_of_others(system.decomposition().interface, f);
  return f - relaxation * (f + others - preconditioner.solve_generic(system.apply(others)));
}

Contraction schwarz_contraction(const Decomposition& parts, const Law& law) {
  const InterfaceFamily family(whole_masses(parts));
  return {family.at(infinity), family.at(flexibility(law)), 1, DecompositionScheme::schwarz};
}

}  // namespace nscdd
