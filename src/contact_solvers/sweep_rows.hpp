// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/body_blocks.hpp"
#include "contact_solvers/contact_problem.hpp"

#include <variant>

namespace nscdd {

/// A contact problem with its data in the order in which a sweep visits the contacts. A "place" is a position in it.
template <int D>
struct SweepRows {
  SweepRows(const LocalFrictionProblem& problem, SweepOrder sweep_order, Index seed);

  SweepOrder order;
  std::vector<Index> contact;                       ///< at each place
  std::variant<ContactBlocks<D>, BodyBlocks<D>> w;  ///< the latter if M and H have its form
  std::vector<DiagonalDelassus> uncoupled;  ///< diagonal blocks of W without coupling; others have inverse_n = 0
  std::vector<FullDelassus<D>> diagonal;    ///< all of them, read for the others
  std::vector<ConeContact> cones{};         ///< the same, prepared for the law in space; empty in the plane
  Vector q, friction;
  /// Of order `coloured`: W couples no two contacts of the places first_of_colour[k] ... first_of_colour[k + 1] - 1.
  std::vector<Index> first_of_colour;

  Index size() const { return count(contact); }
  /// Impulses by contact in the order of places, and back.
  Vector in_order(const Vector& impulses) const { return impulses.reshaped(D, size())(Eigen::all, contact).reshaped(); }
  Vector by_contact(const Vector& impulses) const {
    Vector result(impulses.size());
    result.reshaped(D, size())(Eigen::all, contact) = impulses.reshaped(D, size());
    return result;
  }
  /// The impulses, by contact, after the sweeps of a turn from r. In each sweep every contact in turn takes the impulse
  /// of its law while the others keep theirs, relaxed by omega. Coloured rows are swept in threads, with the same bits.
  Vector swept(const Vector& r, const SweepTurn& turn, double relaxation) const;
};

}  // namespace nscdd
