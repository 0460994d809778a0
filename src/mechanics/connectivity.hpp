// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/sparse_entries.hpp"
#include "mechanics/disk_contacts.hpp"

namespace nscdd {

/// Where a body stands in H.
struct BodyRows {
  Index first = -1;  ///< its first row: x, y and, where the problem has rotations, spin; -1 for a driven body
  double arm = 1;    ///< lever arm of tangential impulses, m; 1 where the speed of the rim stands for the spin
};

/// Builds H column by column: all that knows how an impulse at a contact acts on two bodies. A column belongs to a
/// contact and a direction (n, t) of its frame: -impulse on a, +impulse on b, and -arm r_t on the spin of both.
/// Directions without a tangential part leave the rows of spin out. In space a body has six rows, a frame two tangents.
class ConnectivityBuilder {
 public:
  explicit ConnectivityBuilder(std::size_t columns) { entries_.reserve(5 * columns); }

  void add(const std::array<double, 2>& normal, const BodyRows& a, const BodyRows& b, LocalVector direction) {
    for (const auto& [body, sign] : {std::pair(a, -1.0), std::pair(b, 1.0)}) {
      if (body.first < 0) continue;
      const auto impulse = impulse_on_disk(normal, sign, direction);
      entries_.add(body.first, columns_, impulse[0]);
      entries_.add(body.first + 1, columns_, impulse[1]);
      if (direction.t != 0) entries_.add(body.first + 2, columns_, body.arm * impulse[2]);
    }
    ++columns_;
  }

  SparseMatrix matrix(Index rows) const { return entries_.matrix(rows, columns_); }

 private:
  SparseEntries entries_;
  Index columns_ = 0;
};

}  // namespace nscdd
