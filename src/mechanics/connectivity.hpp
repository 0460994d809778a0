// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_frame.hpp"

namespace nscdd {

struct BodyRows {
  Index first = -1;  ///< its first row: translations and, where the problem has them, rotations; -1 for a driven body
  double arm = 1;    ///< lever arm of tangential impulses, m; 1 where the speed of the rim stands for the spin
};

/// The one builder of H, column by column. A column belongs to a contact and a direction of its frame, (n, t) in the
/// plane (D = 2) or (n, t_1, t_2) in space (D = 3): -impulse on a, +impulse on b, and, unless it is n, on the spins of
/// both -arm r_t, or -arm n x r_t in space. A body has D rows of translations, then one of rotation or three.
template <int D>
class ConnectivityBuilder {
 public:
  /// `columns`: at most.
  ConnectivityBuilder(Index rows, std::size_t columns) : h_(rows, static_cast<Index>(columns)) {
    h_.reserve((2 * D + 1) * static_cast<Index>(columns));
  }

  /// The bodies must differ.
  void add(const Direction<D>& normal, const BodyRows& a, const BodyRows& b, const LocalVector<D>& direction) {
    h_.startVec(columns_);
    const bool ascending = a.first < b.first;
    put(normal, ascending ? a : b, ascending ? -1 : 1, direction);
    put(normal, ascending ? b : a, ascending ? 1 : -1, direction);
    ++columns_;
  }

  /// The matrix with the columns added; to be called once.
  SparseMatrix matrix() {
    h_.finalize();
    h_.conservativeResize(h_.rows(), columns_);
    return std::move(h_);
  }

 private:
  void put(const Direction<D>& normal, const BodyRows& body, double sign, const LocalVector<D>& direction) {
    if (body.first < 0) return;
    const auto impulse = impulse_on_grain(normal, sign, direction);
    for (Index k = 0; k < D; ++k) h_.insertBackByOuterInner(columns_, body.first + k) = impulse[at(k)];
    if (squared(LocalVector<D>{0, direction.t}) == 0) return;
    for (Index k = D; k < count(impulse); ++k)
      h_.insertBackByOuterInner(columns_, body.first + k) = body.arm * impulse[at(k)];
  }

  SparseMatrix h_;
  Index columns_ = 0;
};

/// The directions of a contact, each of which has a column of H, in order.
template <int D>
constexpr std::array<LocalVector<D>, D> contact_directions() {
  if constexpr (D == 2)
    return {{{1, 0}, {0, 1}}};
  else
    return {{{1, {0, 0}}, {0, {1, 0}}, {0, {0, 1}}}};
}

}  // namespace nscdd
