// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_problem.hpp"

namespace nscdd {

/// A contact problem as a sweep goes through it: the data of each contact lie in memory in the order of their turns. A
/// "place" is a position in this order.
template <int D>
struct SweepRows {
  SweepRows(const LocalFrictionProblem& problem, SweepOrder sweep_order, Index seed);

  SweepOrder order;
  std::vector<Index> contact;  ///< at each place
  ContactBlocks<D> w;
  /// The diagonal blocks once more, for the law: in the plane as they are, in space ready for it, and as they are.
  std::vector<FullDelassus<D>> diagonal;
  std::vector<ConeContact> cones{};  ///< in space only
  Vector q, friction;
  /// No two contacts of places first_of_colour[k] ... first_of_colour[k + 1] - 1 are coupled by W. Only where the order
  /// is `coloured`.
  std::vector<Index> first_of_colour;

  Index size() const { return count(contact); }
  Vector in_order(const Vector& impulses) const;    ///< D components per place
  Vector by_contact(const Vector& impulses) const;  ///< back again
  /// One sweep, the `number`th from 0: each place in turn takes the impulse that its law gives while the others keep
  /// theirs, relaxed by omega. Coloured rows are swept in threads; their number changes no bit.
  void sweep(double relaxation, Index number, Vector& impulses) const;
};

}  // namespace nscdd
