// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/disk_contacts.hpp"

namespace nscdd {

/// Where a body stands in H.
struct BodyRows {
  Index first = -1;  ///< its first row: x, y and, where the problem has rotations, spin; -1 for a driven body
  double arm = 1;    ///< lever arm of tangential impulses, m; 1 where the speed of the rim stands for the spin
};

/// Builds H column by column, where it stays: all that knows how an impulse at a contact acts on two bodies. A column
/// belongs to a contact and a direction (n, t) of its frame: -impulse on a, +impulse on b, and -arm r_t on the spin of
/// both. Directions without a tangential part leave the rows of spin out. In space a body has six rows, a frame two
/// tangents.
class ConnectivityBuilder {
 public:
  /// `columns`: at the most.
  ConnectivityBuilder(Index rows, std::size_t columns) : h_(rows, static_cast<Index>(columns)) {
    h_.reserve(5 * static_cast<Index>(columns));
  }

  /// The bodies must differ.
  void add(const std::array<double, 2>& normal, const BodyRows& a, const BodyRows& b, LocalVector direction) {
    h_.startVec(columns_);
    const bool ascending = a.first < b.first;
    put(normal, ascending ? a : b, ascending ? -1 : 1, direction);
    put(normal, ascending ? b : a, ascending ? 1 : -1, direction);
    ++columns_;
  }

  /// The matrix with as many columns as were added, once.
  SparseMatrix matrix() {
    h_.finalize();
    h_.conservativeResize(h_.rows(), columns_);
    return std::move(h_);
  }

 private:
  void put(const std::array<double, 2>& normal, const BodyRows& body, double sign, LocalVector direction) {
    if (body.first < 0) return;
    const auto impulse = impulse_on_disk(normal, sign, direction);
    h_.insertBackByOuterInner(columns_, body.first) = impulse[0];
    h_.insertBackByOuterInner(columns_, body.first + 1) = impulse[1];
    if (direction.t != 0) h_.insertBackByOuterInner(columns_, body.first + 2) = body.arm * impulse[2];
  }

  SparseMatrix h_;
  Index columns_ = 0;
};

}  // namespace nscdd
