// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/general_sweep.hpp"

namespace nscdd {

// In a namespace with a name: in one without, GCC 12 inlines less of a sweep.
namespace spheres {

// Numbers of two contacts, on which a processor works at once (SSE2, NEON). A Number is one of these or a double.
using Pair [[gnu::vector_size(16)]] = double;
template <class Number>
inline constexpr std::size_t lanes = sizeof(Number) / sizeof(double);

// The number get(lane) of each contact.
template <class Number, class Get>
Number each(const Get& get) {
  if constexpr (lanes<Number> == 1)
    return get(std::size_t{0});
  else
    return Number{get(std::size_t{0}), get(std::size_t{1})};
}
inline double lane_of(double a, std::size_t /*lane*/) { return a; }
inline double lane_of(Pair a, std::size_t lane) { return a[lane]; }

// Calls work(lane) for each contact: compilers do not unroll a loop over two.
template <class Number, class Work>
void for_each_lane(const Work& work) {
  work(std::size_t{0});
  if constexpr (lanes<Number> == 2) work(std::size_t{1});
}

// Of a number and what is none, the latter: an impulse that is no number must be seen.
inline double larger(double a, double b) { return b > a ? b : a; }
inline Pair larger(Pair a, Pair b) { return b > a ? b : a; }
inline double smaller(double a, double b) { return a < b ? a : b; }
inline Pair smaller(Pair a, Pair b) { return a < b ? a : b; }
inline double square_root(double a) { return std::sqrt(a); }
inline Pair square_root(Pair a) { return Pair{std::sqrt(a[0]), std::sqrt(a[1])}; }

// The impulse with which two spheres would rest, its normal part and squared tangential one, and what laws may need.
template <class Number>
struct StoppedContact {
  Number n, square_t, inverse_n, inverse_t, friction, pull;
};
// The impulse of a contact whose W is the same in all tangential directions: tangentially a part of the stopping one.
template <class Number>
struct PartialStop {
  Number n, part_t;
};

// The answer of a law that opens, which is Coulomb's at a shifted impulse (see ContactLaw), or of a linear one:
// law.impulse for a W that is not coupled. Contacts open and slide in no order that a processor could foresee, so that
// there is no branch; the root and the quotient do not wait for each other. An impulse is never too short to divide.
template <class Law, class Number>
PartialStop<Number> answer(const Law& law, const StoppedContact<Number>& c) {
  if constexpr (!Law::opens) {
    return {c.n / (1 + law.flexibility() * c.inverse_n), 1 / (1 + law.flexibility() * c.inverse_t)};
  } else {
    const Number zero{}, one = zero + 1, least = zero + 1e-290;
    Number n = c.n;
    if constexpr (Law::pulls) n += c.pull;
    n = larger(n, zero);
    Number part = zero;
    if constexpr (Law::rubs) {
      const Number square = larger(c.square_t, least);
      part = smaller(square_root(square) * (c.friction * n / square), one);
    }
    if constexpr (Law::pulls) n -= c.pull;
    return {n, part};
  }
}

// SweepSums of every lane.
template <class Number>
struct LaneSums {
  Number change{}, impulses{};
};

// Impulses on one sphere of each contact: p over its mass on the velocity, -q over its inertia on the rim. GCC 12 runs
// out of registers where this is inlined, and a sweep then takes a third more time.
template <class Number>
[[gnu::noinline]] void push(const std::array<GrainVelocity<3>*, lanes<Number>>& grains, Number mass, Number px,
                            Number py, Number pz, Number turn, Number qx, Number qy, Number qz) {
  const Number x = mass * px, y = mass * py, z = mass * pz, rim_x = turn * qx, rim_y = turn * qy, rim_z = turn * qz;
  for_each_lane<Number>([&](std::size_t i) {
    GrainVelocity<3>& grain = *grains[i];
    grain.x += lane_of(x, i);
    grain.y += lane_of(y, i);
    grain.z += lane_of(z, i);
    grain.rim_x -= lane_of(rim_x, i);
    grain.rim_y -= lane_of(rim_y, i);
    grain.rim_z -= lane_of(rim_z, i);
  });
}

// Updates the impulse of contact `first`, or of this one and the next, which share no sphere, and the velocities of
// their spheres: written component by component along x, y and z, without tangents.
template <class Number, bool relaxed, bool tangential_bias, class Law>
void take_impulses(const Law& law, ContactRows<3>& contacts, std::size_t first, GrainVelocity<3>* v, double relaxation,
                   LaneSums<Number>& sums) {
  using Grain = GrainVelocity<3>;
  const ContactRow<3>* const row = contacts.rows.data() + first;
  AxesVector* const r = contacts.impulses.data() + first;
  std::array<Grain*, lanes<Number>> a, b;
  for_each_lane<Number>([&](std::size_t i) {
    a[i] = v + row[i].a;
    b[i] = v + row[i].b;
  });
  const auto of_a = [&](double Grain::*number) { return each<Number>([&](std::size_t i) { return a[i]->*number; }); };
  const auto of_b = [&](double Grain::*number) { return each<Number>([&](std::size_t i) { return b[i]->*number; }); };
  const auto normal = [&](std::size_t axis) {
    return each<Number>([&](std::size_t i) { return row[i].normal[axis]; });
  };
  const auto of_r = [&](double AxesTangent::*number) {
    return each<Number>([&](std::size_t i) { return r[i].t.*number; });
  };

  const Number nx = normal(0), ny = normal(1), nz = normal(2);
  const Number mass_a = of_a(&Grain::inverse_mass), mass_b = of_b(&Grain::inverse_mass);  // inverse
  const Number inverse_n = 1 / (mass_a + mass_b), inverse_t = inverse_n * (1 / (1 + rim_mass_ratio<3>));
  const Number dx = of_b(&Grain::x) - of_a(&Grain::x), sx = of_a(&Grain::rim_x) + of_b(&Grain::rim_x);
  const Number dy = of_b(&Grain::y) - of_a(&Grain::y), sy = of_a(&Grain::rim_y) + of_b(&Grain::rim_y);
  const Number dz = of_b(&Grain::z) - of_a(&Grain::z), sz = of_a(&Grain::rim_z) + of_b(&Grain::rim_z);
  const Number d_n = nx * dx + ny * dy + nz * dz;
  Number ux = dx - (sy * nz - sz * ny), uy = dy - (sz * nx - sx * nz), uz = dz - (sx * ny - sy * nx);
  if constexpr (tangential_bias) {
    const AxesTangent* const bias = contacts.bias_t.data() + first;
    ux += each<Number>([&](std::size_t i) { return bias[i].x; });
    uy += each<Number>([&](std::size_t i) { return bias[i].y; });
    uz += each<Number>([&](std::size_t i) { return bias[i].z; });
  }

  // The stopping impulse; of u the part along the normal is taken away.
  const Number r_n = each<Number>([&](std::size_t i) { return r[i].n; });
  const Number rx = of_r(&AxesTangent::x), ry = of_r(&AxesTangent::y), rz = of_r(&AxesTangent::z);
  const Number along = inverse_t * d_n;
  const Number tx = rx + along * nx - inverse_t * ux;
  const Number ty = ry + along * ny - inverse_t * uy;
  const Number tz = rz + along * nz - inverse_t * uz;
  StoppedContact<Number> stopped{
      .n = r_n - inverse_n * (d_n + each<Number>([&](std::size_t i) { return row[i].bias_n; })),
      .square_t = tx * tx + ty * ty + tz * tz,
      .inverse_n = inverse_n,
      .inverse_t = inverse_t,
      .friction = {},
      .pull = {}};
  const double frictions[2] = {contacts.boundary_friction, contacts.friction};
  stopped.friction =
      each<Number>([&](std::size_t i) { return frictions[std::min(a[i]->inverse_mass, b[i]->inverse_mass) > 0]; });
  if constexpr (Law::pulls) stopped.pull = each<Number>([&](std::size_t i) { return contacts.pull[first + i]; });
  const PartialStop<Number> next = answer(law, stopped);

  Number next_n = next.n, next_x = next.part_t * tx, next_y = next.part_t * ty, next_z = next.part_t * tz;
  if constexpr (relaxed) {
    next_n = r_n + relaxation * (next_n - r_n);
    next_x = rx + relaxation * (next_x - rx);
    next_y = ry + relaxation * (next_y - ry);
    next_z = rz + relaxation * (next_z - rz);
  }
  const Number change_n = next_n - r_n, ex = next_x - rx, ey = next_y - ry, ez = next_z - rz;
  const Number px = change_n * nx + ex, py = change_n * ny + ey, pz = change_n * nz + ez;
  const Number qx = ny * ez - nz * ey, qy = nz * ex - nx * ez, qz = nx * ey - ny * ex;
  for_each_lane<Number>([&](std::size_t i) {
    r[i] = {lane_of(next_n, i), {lane_of(next_x, i), lane_of(next_y, i), lane_of(next_z, i)}};
  });
  push<Number>(a, -mass_a, px, py, pz, rim_mass_ratio<3> * mass_a, qx, qy, qz);
  push<Number>(b, mass_b, px, py, pz, rim_mass_ratio<3> * mass_b, qx, qy, qz);
  sums.change += change_n * change_n + ex * ex + ey * ey + ez * ez;
  sums.impulses += next_n * next_n + next_x * next_x + next_y * next_y + next_z * next_z;
}

// A sweep over spheres. Contacts that follow each other and share no sphere take their impulses at once: neither feels
// the other's. Spheres that come soon are asked for: in a coloured order they lie anywhere in memory.
template <bool relaxed, bool tangential_bias, class Law>
SweepSums sweep(const Law& law, ContactRows<3>& contacts, std::span<GrainVelocity<3>> velocities, double relaxation) {
  constexpr std::size_t soon = 12;
  LaneSums<double> single;
  LaneSums<Pair> both;
  GrainVelocity<3>* const v = velocities.data();
  const ContactRow<3>* const rows = contacts.rows.data();
  const std::size_t n = contacts.size();
  const auto ask_for = [&](const ContactRow<3>& row) {
    __builtin_prefetch(v + row.a, 1);
    __builtin_prefetch(v + row.b, 1);
  };
  const auto apart = [](const ContactRow<3>& p, const ContactRow<3>& q) {
    return p.a != q.a && p.b != q.b && p.a != q.b && p.b != q.a;
  };
  for (std::size_t k = 0; k < n;) {
    if (k + soon + 1 < n) {
      ask_for(rows[k + soon]);
      ask_for(rows[k + soon + 1]);
    }
    if (k + 1 < n && apart(rows[k], rows[k + 1])) {
      take_impulses<Pair, relaxed, tangential_bias>(law, contacts, k, v, relaxation, both);
      k += 2;
    } else {
      take_impulses<double, relaxed, tangential_bias>(law, contacts, k, v, relaxation, single);
      k += 1;
    }
  }
  return {single.change + (both.change[0] + both.change[1]), single.impulses + (both.impulses[0] + both.impulses[1])};
}

}  // namespace spheres

namespace {

using spheres::sweep;

// The choices are template parameters, so that the loop does not make them again for every contact.
template <bool relaxed, bool tangential_bias, class Law>
SweepSums sweep(const Law& law, ContactRows<2>& contacts, std::span<GrainVelocity<2>> velocities, double relaxation) {
  SweepSums sums;
  GrainVelocity<2>* const v = velocities.data();
  const double frictions[2] = {contacts.friction, contacts.boundary_friction};
  const std::size_t n = contacts.size();
  for (std::size_t k = 0; k < n; ++k) {
    const ContactRow<2>& c = contacts.rows[k];
    LocalVector<2>& r = contacts.impulses[k];
    GrainVelocity<2>& a = v[c.a];
    GrainVelocity<2>& b = v[c.b];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double v_n = c.normal[0] * dx + c.normal[1] * dy + c.bias_n;
    double v_t = c.normal[0] * dy - c.normal[1] * dx - (a.rim + b.rim);
    if constexpr (tangential_bias) v_t += contacts.bias_t[k];
    const DiagonalDelassus w = grain_delassus<2>(a.inverse_mass, b.inverse_mass);
    const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
    const LocalVector<2> stop{r.n - w.inverse_n * v_n, r.t - w.inverse_t * v_t};
    LocalVector<2> next;
    if constexpr (Law::pulls)
      next = law_at(law, contacts.pull[k]).impulse(stop, w, frictions[driven]);
    else
      next = law.impulse(stop, w, frictions[driven]);
    // What follows is take_impulse and apply_impulse, number by number: GCC 12 packs pairs of numbers into
    // vector registers, and a sweep then takes 1.7 times as long.
    if constexpr (relaxed) {
      next.n = r.n + relaxation * (next.n - r.n);
      next.t = r.t + relaxation * (next.t - r.t);
    }
    const double change_n = next.n - r.n, change_t = next.t - r.t;
    r = next;
    const double px = c.normal[0] * change_n - c.normal[1] * change_t;
    const double py = c.normal[1] * change_n + c.normal[0] * change_t;
    a.x -= a.inverse_mass * px;
    a.y -= a.inverse_mass * py;
    a.rim -= rim_mass_ratio<2> * a.inverse_mass * change_t;
    b.x += b.inverse_mass * px;
    b.y += b.inverse_mass * py;
    b.rim -= rim_mass_ratio<2> * b.inverse_mass * change_t;
    sums.change += change_n * change_n + change_t * change_t;
    sums.impulses += next.n * next.n + next.t * next.t;
  }
  return sums;
}

}  // namespace

template <int D>
GrainContact<D> ContactRows<D>::contact(std::size_t k, std::span<const GrainVelocity<D>> v) const {
  const ContactRow<D>& row = rows[k];
  const double mass_a = v[at(row.a)].inverse_mass, mass_b = v[at(row.b)].inverse_mass;  // inverse
  GrainContact<D> contact{row.a, row.b, row.normal, mass_a, mass_b, {row.bias_n, {}}};
  contact.friction = mass_a == 0 || mass_b == 0 ? boundary_friction : friction;
  contact.pull = pull.empty() ? 0.0 : pull[k];
  contact.impulse = impulse(k);
  if (!bias_t.empty()) contact.bias = in_frame(row.normal, SweptVector<D>{row.bias_n, bias_t[k]});
  if (!others.empty()) contact.friction = others[k].friction, contact.levers = others[k].levers;
  return contact;
}

template <int D>
SweepSums gauss_seidel_sweep(const ContactLaw& law, ContactRows<D>& contacts,
                             std::type_identity_t<std::span<GrainVelocity<D>>> v, double relaxation) {
  return std::visit(
      [&](const auto& one) {
        if (!contacts.others.empty()) return general_sweep(one, contacts, v, relaxation);
        const bool biased = !contacts.bias_t.empty();
        if (relaxation == 1)
          return biased ? sweep<false, true>(one, contacts, v, relaxation)
                        : sweep<false, false>(one, contacts, v, relaxation);
        return biased ? sweep<true, true>(one, contacts, v, relaxation)
                      : sweep<true, false>(one, contacts, v, relaxation);
      },
      law);
}

template struct ContactRows<2>;
template struct ContactRows<3>;
template SweepSums gauss_seidel_sweep(const ContactLaw&, ContactRows<2>&, std::span<GrainVelocity<2>>, double);
template SweepSums gauss_seidel_sweep(const ContactLaw&, ContactRows<3>&, std::span<GrainVelocity<3>>, double);

}  // namespace nscdd
