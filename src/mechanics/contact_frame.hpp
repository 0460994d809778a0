// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/law.hpp>

namespace nscdd {

/// Calls work(std::integral_constant<int, D>()) with the dimension D of a system or problem.
template <class Problem, class Work>
decltype(auto) in_dimension(const Problem& problem, Work&& work) requires requires {
  problem.dimension;
}
{
  if (problem.dimension == 3) return work(std::integral_constant<int, 3>());
  return work(std::integral_constant<int, 2>());
}

template <int D>
using Direction = std::array<double, D>;
template <int D>
Direction<D> narrowed(const Direction<3>& a) {
  if constexpr (D == 2)
    return {a[0], a[1]};
  else
    return a;
}

/// Two tangents of a contact with normal n: (n, t_1, t_2) is orthonormal and right-handed, and depends on n alone
/// (T. Duff et al., Building an orthonormal basis, revisited, J. Computer Graphics Techniques 6 (2017) 1-8).
struct Tangents {
  Direction<3> first, second;
};
inline Tangents tangents_of(const Direction<3>& n) {
  const double sign = std::copysign(1.0, n[2]);
  const double a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
  return {{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}, {b, sign + n[1] * n[1] * a, -n[1]}};
}

/// H_c r on one of the two disks of a contact, (x, y, rim), N s; sign +1 for b, -1 for a. The speed of the rim, radius
/// x angular velocity, stands for the spin. A unit vector r gives a column of H.
inline std::array<double, 3> impulse_on_grain(const Direction<2>& normal, double sign, const LocalVector<2>& r) {
  return {sign * (normal[0] * r.n - normal[1] * r.t), sign * (normal[1] * r.n + normal[0] * r.t), -r.t};
}

/// The same on a sphere, (x, y, z, rim), N s: p = sign (n r_n + p_t), p_t = t_1 r_1 + t_2 r_2, and -n x p_t on the rim.
inline std::array<double, 6> impulse_on_grain(const Direction<3>& n, double sign, const LocalVector<3>& r) {
  const auto [t1, t2] = tangents_of(n);
  std::array<double, 6> impulse;
  for (std::size_t k = 0; k < 3; ++k) {
    impulse[k] = sign * (n[k] * r.n + (t1[k] * r.t.first + t2[k] * r.t.second));
    impulse[3 + k] = t1[k] * r.t.second - t2[k] * r.t.first;  // n x t_1 = t_2, n x t_2 = -t_1
  }
  return impulse;
}

/// An impulse of a contact in space along x, y and z, and back.
inline std::array<double, 3> along_axes(const Direction<3>& n, const LocalVector<3>& r) {
  const auto [t1, t2] = tangents_of(n);
  std::array<double, 3> p{};
  for (std::size_t k = 0; k < 3; ++k) p[k] = n[k] * r.n + (t1[k] * r.t.first + t2[k] * r.t.second);
  return p;
}
inline LocalVector<3> in_frame(const Direction<3>& n, const std::array<double, 3>& p) {
  const auto [t1, t2] = tangents_of(n);
  const auto along = [&](const Direction<3>& d) { return d[0] * p[0] + d[1] * p[1] + d[2] * p[2]; };
  return {along(n), {along(t1), along(t2)}};
}

/// A tangential vector of a contact in space along x, y and z.
struct AxesTangent {
  double x = 0, y = 0, z = 0;
};
inline AxesTangent operator-(AxesTangent a, AxesTangent b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline double dot(AxesTangent a, AxesTangent b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// LocalVector<3> as a sweep stores it: t is a vector of space, orthogonal to n up to rounding.
struct AxesVector {
  double n = 0;
  AxesTangent t{};
};
inline AxesVector operator-(AxesVector a, AxesVector b) { return {a.n - b.n, a.t - b.t}; }
inline double squared(AxesVector a) { return a.n * a.n + dot(a.t, a.t); }

/// A vector of a contact as a sweep stores it, and back.
template <int D>
using SweptVector = std::conditional_t<D == 2, LocalVector<2>, AxesVector>;
inline LocalVector<2> swept(const Direction<2>& /*n*/, const LocalVector<2>& r) { return r; }
inline AxesVector swept(const Direction<3>& n, const LocalVector<3>& r) {
  const auto [x, y, z] = along_axes(n, {0, r.t});
  return {r.n, {x, y, z}};
}
inline LocalVector<2> in_frame(const Direction<2>& /*n*/, const LocalVector<2>& r) { return r; }
inline LocalVector<3> in_frame(const Direction<3>& n, const AxesVector& r) {
  return {r.n, in_frame(n, std::array{r.t.x, r.t.y, r.t.z}).t};
}

/// A vector of a contact by its directions, (n, t) or (n, t_1, t_2), and back.
inline std::array<double, 2> along_directions(const LocalVector<2>& r) { return {r.n, r.t}; }
inline std::array<double, 3> along_directions(const LocalVector<3>& r) { return {r.n, r.t.first, r.t.second}; }
template <int D>
LocalVector<D> from_directions(const double* r) {
  if constexpr (D == 2)
    return {r[0], r[1]};
  else
    return {r[0], {r[1], r[2]}};
}

/// How a contact moves one of its bodies: the rows of H_c^T on the unknowns of the body, with its sign, so that the
/// relative velocity of the contact is the sum over both bodies. `moves` is 1 for an unknown that impulses move, and 0
/// for one whose velocity is prescribed.
template <int D>
struct Lever {
  using Unknowns = std::array<double, D == 2 ? 3 : 6>;
  std::array<Unknowns, D> rows{};
  Unknowns moves{};

  LocalVector<D> velocity(const Unknowns& v) const {
    std::array<double, D> u{};
    for (std::size_t d = 0; d < D; ++d)
      for (std::size_t k = 0; k < v.size(); ++k) u[d] += rows[d][k] * v[k];
    return from_directions<D>(u.data());
  }
  /// H_c r on the body, N s.
  Unknowns impulse(const LocalVector<D>& r) const {
    const std::array<double, D> along = along_directions(r);
    Unknowns p{};
    for (std::size_t k = 0; k < p.size(); ++k)
      for (std::size_t d = 0; d < D; ++d) p[k] += moves[k] * rows[d][k] * along[d];
    return p;
  }
  /// The lever on spins in place of the speeds of rims of these lengths.
  Lever on_spins(const std::array<double, 3>& rims) const {
    Lever result = *this;
    for (Unknowns& row : result.rows)
      for (std::size_t k = D; k < row.size(); ++k) row[k] *= rims[D == 2 ? k : k - D];
    return result;
  }
};

/// The levers of a contact on both of its bodies.
template <int D>
struct Levers {
  Lever<D> a, b;

  /// Whether tangential impulses move anything.
  bool rubs() const { return a.rows[1] != typename Lever<D>::Unknowns{} || b.rows[1] != typename Lever<D>::Unknowns{}; }
};

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

  /// The bodies must differ. `levers`: of a contact that has them; prescribed unknowns then have no entries.
  void add(const Direction<D>& normal, const BodyRows& a, const BodyRows& b, const LocalVector<D>& direction,
           const Levers<D>* levers = nullptr) {
    h_.startVec(columns_);
    const bool ascending = a.first < b.first;
    for (const bool is_a : {ascending, !ascending}) {
      const BodyRows& body = is_a ? a : b;
      if (body.first < 0) continue;
      if (levers != nullptr)
        put(is_a ? levers->a : levers->b, body, direction);
      else
        put(normal, body, is_a ? -1 : 1, direction);
    }
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
    const auto impulse = impulse_on_grain(normal, sign, direction);
    for (Index k = 0; k < D; ++k) h_.insertBackByOuterInner(columns_, body.first + k) = impulse[at(k)];
    if (squared(LocalVector<D>{0, direction.t}) == 0) return;
    for (Index k = D; k < count(impulse); ++k)
      h_.insertBackByOuterInner(columns_, body.first + k) = body.arm * impulse[at(k)];
  }
  void put(const Lever<D>& lever, const BodyRows& body, const LocalVector<D>& direction) {
    const auto impulse = lever.impulse(direction);
    for (Index k = 0; k < count(impulse); ++k)
      if (lever.moves[at(k)] != 0) h_.insertBackByOuterInner(columns_, body.first + k) = impulse[at(k)];
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
