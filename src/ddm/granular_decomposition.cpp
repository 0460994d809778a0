// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/granular_decomposition.hpp"

#include "linalg/random.hpp"
#include "mechanics/connectivity.hpp"

#include <bit>
#include <numeric>

namespace nscdd {
namespace {

// Contacts of a block: enough for out-of-order execution to find independent ones, few enough for the first cache.
constexpr Index interleaved_block = 256;

// Place of a cell of a 2^16 x 2^16 grid along Hilbert's curve.
std::uint32_t hilbert_place(std::uint32_t x, std::uint32_t y) {
  std::uint32_t place = 0;
  for (std::uint32_t side = 1U << 15; side > 0; side /= 2) {
    const bool right = (x & side) != 0, up = (y & side) != 0;
    place += side * side * ((right ? 3U : 0U) ^ (up ? 1U : 0U));
    if (!up) {  // turn the quadrant into the position of the first
      if (right) {
        x = ~x;
        y = ~y;
      }
      std::swap(x, y);
    }
  }
  return place;
}

// Place of a cell of a grid of 2^16 cubes a side along Hilbert's curve in space: the bits of its transposed coordinates
// (J. Skilling, Programming the Hilbert curve, AIP Conf. Proc. 707 (2004) 381-387).
std::uint64_t hilbert_place(std::array<std::uint32_t, 3> cell) {
  constexpr std::uint32_t top = 1U << 15;
  for (std::uint32_t bit = top; bit > 1; bit /= 2)
    for (std::uint32_t& one : cell) {
      if ((one & bit) != 0) {
        cell[0] ^= bit - 1;
      } else {
        const std::uint32_t exchanged = (cell[0] ^ one) & (bit - 1);
        cell[0] ^= exchanged;
        one ^= exchanged;
      }
    }
  cell[1] ^= cell[0];
  cell[2] ^= cell[1];
  std::uint32_t turned = 0;
  for (std::uint32_t bit = top; bit > 1; bit /= 2)
    if ((cell[2] & bit) != 0) turned ^= bit - 1;
  std::uint64_t place = 0;
  for (std::uint32_t bit = top; bit > 0; bit /= 2)
    for (const std::uint32_t one : cell) place = 2 * place + (((one ^ turned) & bit) != 0 ? 1 : 0);
  return place;
}

std::vector<Index> along_curve(std::span<const std::array<double, 3>> points, int dimension) {
  std::array<double, 3> low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (const auto& p : points)
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-300});
  const auto cell = [&](const std::array<double, 3>& p, std::size_t k) {
    return static_cast<std::uint32_t>(std::clamp((p[k] - low[k]) / extent * 65535, 0.0, 65535.0));
  };
  std::vector<std::pair<std::uint64_t, Index>> places;
  places.reserve(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto& p = points[k];
    const std::uint64_t place =
        dimension == 2 ? hilbert_place(cell(p, 0), cell(p, 1)) : hilbert_place({cell(p, 0), cell(p, 1), cell(p, 2)});
    places.emplace_back(place, static_cast<Index>(k));
  }
  std::sort(places.begin(), places.end());
  std::vector<Index> order;
  order.reserve(points.size());
  for (const auto& [place, k] : places) order.push_back(k);
  return order;
}

// The contacts in the given order, by blocks, those of a block by colours. No two of one colour share a free disk.
template <int D>
std::vector<Index> by_colour(std::vector<Index> order, const std::vector<GrainContact<D>>& contacts,
                             const std::vector<GrainVelocity<D>>& bodies, Index block) {
  // Bit c of used[i] says that colour c is taken at disk i within the present block. Disks have few contacts.
  // If one has more than 64, the rest get the last colour, whose contacts may then share this disk.
  constexpr int most = 63;
  std::vector<std::uint64_t> used(bodies.size(), 0);
  std::vector<Index> block_of(bodies.size(), -1);
  std::vector<int> colours(contacts.size());
  for (Index place = 0; place < count(order); ++place) {
    const Index here = place / block;
    const GrainContact<D>& contact = contacts[at(order[at(place)])];
    std::uint64_t taken = 0;
    const std::size_t ends[2] = {at(contact.a), at(contact.b)};
    for (const std::size_t i : ends) {
      if (block_of[i] != here) {
        block_of[i] = here;
        used[i] = 0;
      }
      if (bodies[i].inverse_mass > 0) taken |= used[i];
    }
    const int colour = std::min(most, std::countr_one(taken));
    colours[at(order[at(place)])] = colour;
    for (const std::size_t i : ends) used[i] |= std::uint64_t{1} << colour;
  }
  for (Index first = 0; first < count(order); first += block)
    std::stable_sort(order.begin() + first, order.begin() + std::min(first + block, count(order)),
                     [&](Index p, Index q) { return colours[at(p)] < colours[at(q)]; });
  return order;
}

// Puts the contacts of one subdomain in sweep order and numbers its bodies in the order in which the sweep
// meets them. Neighbours in the sweep are then neighbours in memory, however the packing numbers its grains.
template <int D>
void fill(GranularSubdomain<D>& subdomain, const StepProblem<D>& problem, Choice<ContactOrder> order,
          std::uint64_t seed, std::vector<std::int32_t>& local) {
  std::vector<GrainContact<D>> natural;
  std::vector<std::array<double, 3>> points;
  for (const Index c : subdomain.numbers) {
    natural.push_back(problem.contacts[at(c)]);
    points.push_back(problem.geometry[at(c)].point);
  }
  const std::vector<Index> numbers = std::exchange(subdomain.numbers, {});
  subdomain.bodies.clear();
  ContactRows<D>& rows = subdomain.contacts;
  rows.friction = problem.friction;
  rows.boundary_friction = problem.boundary_friction;
  rows.rows.reserve(natural.size());
  rows.impulses.reserve(natural.size());
  const auto number = [&](std::int32_t body) {
    std::int32_t& known = local[at(body)];
    if (known < 0) {
      known = static_cast<std::int32_t>(subdomain.bodies.size());
      subdomain.bodies.push_back(body);
    }
    return known;
  };
  for (const Index k : contact_order(order, natural, problem.free, seed, points)) {
    const GrainContact<D>& c = natural[at(k)];
    const std::int32_t a = number(c.a), b = number(c.b);
    if constexpr (D == 2)
      rows.rows.push_back({a, b, c.normal[0], c.normal[1], c.bias.n});
    else
      rows.rows.push_back({a, b, c.normal[0], c.normal[1], c.normal[2], c.bias.n});
    rows.impulses.push_back(c.impulse);
    if (problem.tangential_bias) rows.bias_t.push_back(c.bias.t);
    if (problem.pulls) rows.pull.push_back(c.pull);
    subdomain.numbers.push_back(numbers[at(k)]);
  }
  for (const Index i : subdomain.bodies) {
    subdomain.velocities.push_back(problem.free[at(i)]);
    local[at(i)] = -1;  // for the next subdomain
  }
}

// The bodies that contacts touch, in the order in which they are met. `local`: -1 of every body.
template <int D>
std::vector<Index> bodies_of(const std::vector<Index>& contacts, const StepProblem<D>& problem,
                             std::vector<std::int32_t>& local) {
  std::vector<Index> bodies;
  for (const Index c : contacts) {
    const GrainContact<D>& contact = problem.contacts[at(c)];
    for (const std::int32_t body : {contact.a, contact.b})
      if (std::exchange(local[at(body)], 0) < 0) bodies.push_back(body);
  }
  for (const Index body : bodies) local[at(body)] = -1;  // for the next subdomain
  return bodies;
}

template <int D>
Interface interface_of(const GranularDecomposition<D>& parts, const StepProblem<D>& problem) {
  std::vector<std::span<const Index>> held;
  for (const GranularSubdomain<D>& subdomain : parts.subdomains) held.emplace_back(subdomain.bodies);
  std::vector<char> free;
  for (const GrainVelocity<D>& v : problem.free) free.push_back(v.inverse_mass > 0);
  return {unknowns_of_grain<D>, count(problem.free), held, free};
}

template <int D>
const GrainVelocity<D>& copy_of(const GranularDecomposition<D>& parts, const GrainCopy& copy) {
  return parts.subdomains[at(copy.subdomain)].velocities[at(copy.grain)];
}

// Component k of the velocities of copies.
template <int D>
auto components(const GranularDecomposition<D>& parts) {
  return [&](Index e, Index grain, Index k) { return unknowns(copy_of(parts, {e, grain}))[at(k)]; };
}

}  // namespace

template <int D>
std::vector<Index> contact_order(Choice<ContactOrder> order, const std::vector<GrainContact<D>>& contacts,
                                 const std::vector<GrainVelocity<D>>& bodies, std::uint64_t seed,
                                 std::span<const std::array<double, 3>> points) {
  std::vector<Index> result(contacts.size());
  std::iota(result.begin(), result.end(), Index{0});
  if (order == ContactOrder::coloured)
    return by_colour(std::move(result), contacts, bodies, std::max<Index>(1, count(contacts)));
  if (order == ContactOrder::interleaved) return by_colour(along_curve(points, D), contacts, bodies, interleaved_block);
  if (order == ContactOrder::random) {
    RandomStream stream(seed);
    for (Index k = count(result) - 1; k > 0; --k) std::swap(result[at(k)], result[at(stream.below(k + 1))]);
  } else if (order == ContactOrder::reverse) {
    std::reverse(result.begin(), result.end());
  }
  return result;
}

template <int D>
GranularDecomposition<D> decompose(const StepProblem<D>& problem, const Partition& partition,
                                   Choice<ContactOrder> order, std::uint64_t seed, const Processes& processes) {
  check(partition, count(problem.contacts));
  GranularDecomposition<D> parts;
  parts.contacts = count(problem.contacts);
  parts.subdomains.resize(at(partition.subdomains));
  for (Index c = 0; c < count(problem.contacts); ++c)
    parts.subdomains[at(partition.subdomain_of_contact[at(c)])].numbers.push_back(c);
  std::vector<std::int32_t> local(problem.free.size(), -1);
  std::vector<Index> process_of(parts.subdomains.size(), 0);
  if (!processes.alone()) {
    for (GranularSubdomain<D>& one : parts.subdomains) one.bodies = bodies_of(one.numbers, problem, local);
    process_of = deal_out(interface_of(parts, problem), partition, processes.size);
  }
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e)
    if (process_of[e] == processes.rank) fill(parts.subdomains[e], problem, order, seed, local);
  parts.interface = interface_of(parts, problem);
  // A grain shared by q subdomains weighs 1/q in each.
  const auto copies = [&](Index body) { return static_cast<double>(parts.interface.multiplicity(body)); };
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
    GranularSubdomain<D>& subdomain = parts.subdomains[e];
    if (process_of[e] != processes.rank) subdomain = GranularSubdomain<D>();
    for (std::size_t i = 0; i < subdomain.bodies.size(); ++i)
      subdomain.velocities[i].inverse_mass *= copies(subdomain.bodies[i]);
  }
  for (const Gluing& row : parts.interface.gluing())
    parts.copy_mass.push_back(1 / (problem.free[at(row.grain)].inverse_mass * copies(row.grain)));
  if (processes.alone()) return parts;
  parts.interface = parts.interface.of_process(process_of, processes);
  parts.interface.meet_neighbours();
  return parts;
}

template <int D>
Vector interface_jumps(const GranularDecomposition<D>& parts) {
  return parts.interface.exchange_with_neighbours(components(parts));
}

template <int D>
Vector all_interface_jumps(const GranularDecomposition<D>& parts) {
  return parts.interface.exchange(components(parts));
}

template <int D>
Vector free_velocities(const GranularDecomposition<D>& parts) {
  std::vector<double> values;
  for (const GranularSubdomain<D>& subdomain : parts.subdomains)
    for (const GrainVelocity<D>& v : subdomain.velocities) {
      if (v.inverse_mass == 0) continue;
      const GrainUnknowns<D> own = unknowns(v);
      values.insert(values.end(), own.begin(), own.end());
    }
  return Vector::Map(values.data(), count(values));
}

template <int D>
double glued_speed_squared(const GranularDecomposition<D>& parts, Index subdomain) {
  double sum = 0;
  Index before = -1;
  for (const Tie& tie : parts.interface.ties(subdomain)) {  // two of them in a row have the same copy
    if (tie.grain == std::exchange(before, tie.grain)) continue;
    const GrainVelocity<D>& v = copy_of(parts, {subdomain, tie.grain});
    sum += squared_velocity(v) + squared_rim(v);
  }
  return sum;
}

template <int D>
Vector generic_interface_solve(const GranularDecomposition<D>& parts, const Vector& g) {
  return parts.interface.solve_generic(
      [&](Index row, Index k) {
        const double mass = parts.copy_mass[at(row)];
        return k < D ? mass : mass / rim_mass_ratio<D>;
      },
      g);
}

template <int D>
void apply_interface_impulses(GranularDecomposition<D>& parts, const Vector& change) {
  for (Index e = 0; e < count(parts.subdomains); ++e)
    for (const Tie& tie : parts.interface.ties(e)) {
      GrainUnknowns<D> impulse;
      for (Index k = 0; k < unknowns_of_grain<D>; ++k)
        impulse[at(k)] = -tie.sign * change[unknowns_of_grain<D> * tie.row + k];
      push(parts.subdomains[at(e)].velocities[at(tie.grain)], impulse);
    }
}

template <int D>
ReferenceProblem reference_problem(const StepProblem<D>& problem, Index grains) {
  constexpr Index rows_of_grain = unknowns_of_grain<D>;
  ReferenceProblem result;
  result.dimension = D;
  result.dofs_per_grain = rows_of_grain;
  result.inertia = Vector::Ones(rows_of_grain * grains);
  result.arriving_velocity = Vector::Zero(rows_of_grain * grains);
  for (Index i = 0; i < grains; ++i) {
    const GrainVelocity<D>& v = problem.free[at(i)];
    if (v.inverse_mass == 0) continue;
    const GrainUnknowns<D> own = unknowns(v);
    const double mass = 1 / v.inverse_mass;
    for (Index k = 0; k < rows_of_grain; ++k) {
      result.inertia[rows_of_grain * i + k] = k < D ? mass : mass / rim_mass_ratio<D>;
      result.arriving_velocity[rows_of_grain * i + k] = own[at(k)];
    }
  }
  ConnectivityBuilder<D> h(rows_of_grain * grains, D * problem.contacts.size());
  const auto rows = [&](Index body) {
    return problem.free[at(body)].inverse_mass == 0 ? BodyRows{} : BodyRows{rows_of_grain * body};
  };
  for (const GrainContact<D>& c : problem.contacts)
    for (const LocalVector<D>& direction : contact_directions<D>()) h.add(c.normal, rows(c.a), rows(c.b), direction);
  result.h = h.matrix();
  return result;
}

Partition partition_of_columns(const Partition& of_contacts, Index dimension) {
  Partition result{.subdomains = of_contacts.subdomains, .subdomain_of_contact = {}};
  result.subdomain_of_contact.reserve(at(dimension) * of_contacts.subdomain_of_contact.size());
  for (const Index e : of_contacts.subdomain_of_contact)
    result.subdomain_of_contact.insert(result.subdomain_of_contact.end(), at(dimension), e);
  return result;
}

template std::vector<Index> contact_order(Choice<ContactOrder>, const std::vector<GrainContact<2>>&,
                                          const std::vector<GrainVelocity<2>>&, std::uint64_t,
                                          std::span<const std::array<double, 3>>);
template GranularDecomposition<2> decompose(const StepProblem<2>&, const Partition&, Choice<ContactOrder>,
                                            std::uint64_t, const Processes&);
template Vector interface_jumps(const GranularDecomposition<2>&);
template Vector all_interface_jumps(const GranularDecomposition<2>&);
template Vector free_velocities(const GranularDecomposition<2>&);
template double glued_speed_squared(const GranularDecomposition<2>&, Index);
template Vector generic_interface_solve(const GranularDecomposition<2>&, const Vector&);
template void apply_interface_impulses(GranularDecomposition<2>&, const Vector&);
template ReferenceProblem reference_problem(const StepProblem<2>&, Index);

template std::vector<Index> contact_order(Choice<ContactOrder>, const std::vector<GrainContact<3>>&,
                                          const std::vector<GrainVelocity<3>>&, std::uint64_t,
                                          std::span<const std::array<double, 3>>);
template GranularDecomposition<3> decompose(const StepProblem<3>&, const Partition&, Choice<ContactOrder>,
                                            std::uint64_t, const Processes&);
template Vector interface_jumps(const GranularDecomposition<3>&);
template Vector all_interface_jumps(const GranularDecomposition<3>&);
template Vector free_velocities(const GranularDecomposition<3>&);
template double glued_speed_squared(const GranularDecomposition<3>&, Index);
template Vector generic_interface_solve(const GranularDecomposition<3>&, const Vector&);
template void apply_interface_impulses(GranularDecomposition<3>&, const Vector&);
template ReferenceProblem reference_problem(const StepProblem<3>&, Index);

}  // namespace nscdd
