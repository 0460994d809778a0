// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/contact_blocks.hpp"
#include "mechanics/contact_frame.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// W = G^T G by the two bodies of each contact, G = M^-1/2 H. A sweep that carries the scaled velocities y = G r of the
/// bodies reads two blocks per contact, not a whole row of W. Contacts may be in another order than in the problem: a
/// "place" is a position in this order.
template <int D>
class BodyBlocks {
 public:
  /// Rows of a body in H: translations and rotations.
  static constexpr int K = D == 2 ? 3 : 6;

  /// Nothing without M and H, a diagonal M, K rows of H a body, at most two bodies a contact. `contact`: at each place.
  static std::optional<BodyBlocks> of(const LocalFrictionProblem& problem, const std::vector<Index>& contact);

  Index bodies() const { return nobody_ / K; }
  /// Numbers of the bodies of a place: one or two.
  std::vector<Index> bodies_of(Index place) const {
    std::vector<Index> own;
    for (const int first : contacts_[at(place)].first)
      if (first != nobody_) own.push_back(first / K);
    return own;
  }
  /// y = G r, for impulses r by places.
  Vector velocities(const Vector& impulses) const {
    Vector y = Vector::Zero(nobody_ + K);
    for (Index place = 0; place < count(contacts_); ++place) push(place, component<D>(impulses, place), y);
    return y;
  }
  /// sum + the row of a place of G^T times y.
  LocalVector<D> add_row(Index place, const Vector& y, const LocalVector<D>& sum) const {
    const Contact& own = contacts_[at(place)];
    const Components u = own.rows[0].lazyProduct(Body::Map(y.data() + own.first[0])) +
                         own.rows[1].lazyProduct(Body::Map(y.data() + own.first[1]));
    return sum + from_directions<D>(u.data());
  }
  /// y += G_c r for the impulse r of a place.
  void push(Index place, const LocalVector<D>& impulse, Vector& y) const {
    const Contact& own = contacts_[at(place)];
    const std::array<double, at(D)> r = along_directions(impulse);
    for (std::size_t side = 0; side < 2; ++side)
      if (own.first[side] != nobody_)  // which other threads read
        Body::Map(y.data() + own.first[side]) += own.rows[side].transpose().lazyProduct(Components::Map(r.data()));
  }

 private:
  using Components = Eigen::Matrix<double, D, 1>;
  using Body = Eigen::Matrix<double, K, 1>;
  struct Contact {
    std::array<int, 2> first{};                                                           // rows of y of both bodies
    std::array<Eigen::Matrix<double, D, K, Eigen::RowMajor | Eigen::DontAlign>, 2> rows;  // of G^T
  };
  std::vector<Contact> contacts_;
  int nobody_ = 0;  // the first row of y behind all bodies, for contacts with one body only
};

}  // namespace nscdd
