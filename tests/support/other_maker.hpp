// SPDX-License-Identifier: GPL-3.0-or-later
// A maker of contact problems that hides its stored W, with the linear systems of another class.
#pragma once

#include "contact_solvers/stored_contacts.hpp"

namespace nscdd::testing {

template <int D, class Systems>
struct OtherMaker {
  static constexpr int dimension = D;
  StoredContacts<D>& w;
  Systems& systems;
  const ContactData& data = w.data;

  Vector product(const Vector& r) const { return w.product(r); }
  auto sweeps(const FrictionSolverOptions& options) const { return w.sweeps(options); }
  Vector symmetric_product(const Vector& r) { return w.symmetric_product(r); }
  Vector rest(const Vector& r) { return w.rest(r); }
  bool factorise(std::vector<ContactRelation<D>> relations) { return systems.factorise(std::move(relations)); }
  bool factorise_shifted(const Vector& shift) { return factorise(ContactRelation<D>::shifted(shift)); }
  Vector solve(const Vector& b) { return systems.solve(b); }
  double take_operations() { return systems.take_operations(); }
  int determinant_sign() const { return systems.determinant_sign(); }
};

}  // namespace nscdd::testing
