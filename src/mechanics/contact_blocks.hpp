// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_frame.hpp"

namespace nscdd {

/// The entries of one contact of a vector with D entries per contact.
template <int D>
LocalVector<D> component(const Vector& values, Index contact) {
  return from_directions<D>(values.data() + D * contact);
}
template <int D>
void set_component(Vector& values, Index contact, const LocalVector<D>& value) {
  double* own = values.data() + D * contact;  // no loop: sweeps call this for each contact
  own[0] = value.n;
  if constexpr (D == 2) {
    own[1] = value.t;
  } else {
    own[1] = value.t.first;
    own[2] = value.t.second;
  }
}

/// Part of the contacts, or places, that one thread takes at a time: first ... last - 1.
struct ContactRange {
  Index first, last;
  Index part;  ///< number of the part: 0 ... parts_of(n) - 1
};
Index parts_of(Index contacts);
/// Calls visit(range) for all parts, in parallel if contacts are many.
void for_parts(Index contacts, const std::function<void(const ContactRange&)>& visit);

/// A matrix of contacts such as W, by rows of D x D blocks, which make products three times as fast as single entries.
/// Contacts may be in another order than in the matrix: a "place" is a position in this order.
template <int D>
class ContactBlocks {
 public:
  using Block = std::array<std::array<double, D>, D>;

  ContactBlocks() = default;
  /// `contact`: at each place; by default as they are numbered.
  explicit ContactBlocks(const SparseMatrix& w, const std::vector<Index>& contact = {});

  Index places() const { return count(start_) - 1; }
  /// The places of the blocks in the row of a place, by the numbers of their contacts.
  std::span<const int> row(Index place) const {
    return std::span(column_).subspan(at(start_[at(place)]), at(start_[at(place + 1)] - start_[at(place)]));
  }
  /// sum + the row of a place times x (D components per place), block by block from the left; inline for speed.
  LocalVector<D> add_row(Index place, const Vector& x, LocalVector<D> sum) const {
    for (Index k = start_[at(place)]; k < start_[at(place + 1)]; ++k) {
      const Block& b = block_[at(k)];
      const double* other = x.data() + D * static_cast<Index>(column_[at(k)]);
      if constexpr (D == 2) {
        const double n = other[0], t = other[1];
        sum.n += b[0][0] * n + b[0][1] * t;
        sum.t += b[1][0] * n + b[1][1] * t;
      } else {
        const double n = other[0], s = other[1], t = other[2];
        sum.n += b[0][0] * n + b[0][1] * s + b[0][2] * t;
        sum.t.first += b[1][0] * n + b[1][1] * s + b[1][2] * t;
        sum.t.second += b[2][0] * n + b[2][1] * s + b[2][2] * t;
      }
    }
    return sum;
  }
  Vector operator*(const Vector& x) const;

 private:
  std::vector<Index> start_{0};
  std::vector<int> column_;
  std::vector<Block> block_;
};

}  // namespace nscdd
