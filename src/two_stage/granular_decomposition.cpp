// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/granular_decomposition.hpp"

#include "core/memory.hpp"
#include "linalg/threads.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

// Puts the contacts in sweep order and numbers bodies as the sweep meets them: neighbours are near in memory.
template <int D>
void fill(GranularSubdomain<D>& subdomain, const StepProblem<D>& problem, Choice<ContactOrder> order,
          std::uint64_t seed, GreedyColours& taken, std::vector<std::int32_t>& local) {
  subdomain.numbers = contact_order(order, problem, std::move(subdomain.numbers), seed, taken);
  ContactRows<D>& rows = subdomain.contacts;
  rows.friction = problem.friction;
  rows.boundary_friction = problem.boundary_friction;
  rows.rows.reserve(subdomain.numbers.size());
  rows.impulses.reserve(subdomain.numbers.size());
  const bool others = problem.own_frictions || std::ranges::any_of(subdomain.numbers, [&](Index c) {
                        return problem.contacts[at(c)].levers != nullptr;
                      });
  const auto number = [&](std::int32_t body) {
    std::int32_t& known = local[at(body)];
    if (known < 0) {
      known = static_cast<std::int32_t>(subdomain.bodies.size());
      subdomain.bodies.push_back(body);
    }
    return known;
  };
  for (const Index k : subdomain.numbers) {
    const GrainContact<D>& c = problem.contacts[at(k)];
    const std::int32_t a = number(c.a), b = number(c.b);
    rows.rows.push_back({a, b, c.normal, c.bias.n});
    rows.impulses.push_back(swept(c.normal, c.impulse));
    if (problem.tangential_bias) rows.bias_t.push_back(swept(c.normal, c.bias).t);
    if (problem.pulls) rows.pull.push_back(c.pull);
    if (others) rows.others.push_back({c.levers, c.friction});
  }
  for (const Index i : subdomain.bodies) {
    subdomain.velocities.push_back(problem.free[at(i)]);
    local[at(i)] = -1;  // for the next subdomain
  }
}

// The interface of the free grains of all subdomains.
template <int D>
Interface interface_of(const GranularDecomposition<D>& parts, const StepProblem<D>& problem,
                       const std::vector<Index>& process_of, const Processes& processes) {
  const auto number = [&](Index body) { return static_cast<Index>(problem.numbers[at(body)]); };
  std::vector<std::vector<Index>> held;
  for (const GranularSubdomain<D>& subdomain : parts.subdomains) {
    held.emplace_back();
    for (const Index body : subdomain.bodies) held.back().push_back(number(body));
  }
  const Index grains = problem.numbers.empty() ? 0 : problem.numbers.back() + 1;
  std::vector<char> free(at(grains), 1);
  for (Index body = 0; body < count(problem.free); ++body)
    free[at(number(body))] = problem.free[at(body)].inverse_mass > 0;
  return shared_interface(unknowns_of_grain<D>, grains, std::move(held), free, process_of, processes);
}

template <int D>
const GrainVelocity<D>& copy_of(const GranularDecomposition<D>& parts, const GrainCopy& copy) {
  return parts.subdomains[at(copy.subdomain)].velocities[at(copy.grain)];
}

// Rows of F, and the masses of their copies.
template <int D>
void add_rows(GranularDecomposition<D>& parts, const StepProblem<D>& problem) {
  constexpr Index size = unknowns_of_grain<D>;
  const Interface& interface = parts.interface;
  const auto& gluing = interface.gluing();
  const bool whole = parts.copies == CopyMass::whole;
  std::vector<Index> first_row(gluing.size());  // by the first gluing of a grain
  for (Index k = 0; k < count(gluing); k += interface.multiplicity(gluing[at(k)].grain) - 1) {
    const Index grain = gluing[at(k)].grain, body = body_of(problem, grain), q = interface.multiplicity(grain);
    const Index first = first_row[at(k)] = count(parts.copy_mass), last = first + (whole ? q : q - 1);
    const double part = whole ? 1 : static_cast<double>(q);
    const double mass = body < 0 ? 0 : 1 / (problem.free[at(body)].inverse_mass * part);
    for (Index row = first; row < last; ++row) {
      const GrainCopy copy = interface.copies(grain)[at(row - first)];
      parts.copy_mass.push_back(mass);
      parts.subdomain_of_row.push_back(copy.subdomain);
      if (!whole || interface.process_of(copy.subdomain) != interface.processes().rank) continue;
      GranularSubdomain<D>& subdomain = parts.subdomains[at(copy.subdomain)];
      subdomain.whole_copies.push_back({copy.grain, row, first, last, subdomain.velocities[at(copy.grain)]});
    }
  }
  if (whole)
    parts.sum_of_neighbours = interface.between_neighbours([&](Index k, Index) {
      const Index first = first_row[at(k)];
      return Interface::Entries{size * first, size * (first + interface.multiplicity(gluing[at(k)].grain))};
    });
}

template <int D>
auto unknowns_of_copies(const GranularDecomposition<D>& parts) {
  return [&](Index e, Index grain) { return unknowns(copy_of(parts, {e, grain})); };
}

}  // namespace

template <int D>
ImpulseScale GranularDecomposition<D>::scale_of(const StepProblem<D>& problem, const Partition& partition,
                                                const Processes& processes) {
  const std::vector<double> speeds = speeds_of<D>(problem.free);
  const Vector sum = sums_over_contacts(partition, 4, processes, [&](Index k, auto&& sums) {
    const ImpulseScale own = impulse_scale<D>(problem.law, problem.contacts[at(k)], problem.free, speeds);
    sums += Eigen::Vector4d(own.alone, own.momenta, own.speeds, own.energies);
  });
  return {.alone = sum[0], .momenta = sum[1], .speeds = sum[2], .energies = sum[3]};
}

template <int D>
GranularDecomposition<D> decompose(const StepProblem<D>& problem, const Partition& partition,
                                   Choice<ContactOrder> order, std::uint64_t seed,
                                   const std::vector<Index>& process_of_subdomain, const Processes& processes,
                                   CopyMass mass) {
  check(partition, count(problem.contacts));
  // Number, row and impulse of each contact.
  constexpr double of_contact = sizeof(Index) + sizeof(ContactRow<D>) + sizeof(SweptVector<D>);
  require_memory(of_contact * static_cast<double>(problem.contacts.size()) +
                     sizeof(GrainVelocity<D>) * static_cast<double>(problem.free.size()),
                 fmt::format("subdomains with {} contacts", problem.contacts.size()), "fewer grains");
  GranularDecomposition<D> parts;
  parts.contacts = count(problem.contacts);
  parts.copies = mass;
  parts.scale = GranularDecomposition<D>::scale_of(problem, partition, processes);
  parts.subdomains.resize(at(partition.subdomains));
  for (Index c = 0; c < count(problem.contacts); ++c)
    parts.subdomains[at(partition.subdomain_of_contact[at(c)])].numbers.push_back(c);
  std::vector<std::int32_t> local(problem.free.size(), -1);
  GreedyColours taken(count(problem.free));
  for (GranularSubdomain<D>& subdomain : parts.subdomains) fill(subdomain, problem, order, seed, taken, local);
  parts.interface = interface_of(parts, problem, process_of_subdomain, processes);
  for (GranularSubdomain<D>& subdomain : parts.subdomains)
    for (std::size_t i = 0; i < subdomain.bodies.size() && mass == CopyMass::shares; ++i)
      subdomain.velocities[i].inverse_mass *=
          static_cast<double>(parts.interface.multiplicity(problem.numbers[at(subdomain.bodies[i])]));
  add_rows(parts, problem);
  parts.interface.meet_neighbours();
  return parts;
}

template <int D>
Vector GranularDecomposition<D>::interface_jumps() const {
  if (copies == CopyMass::shares) return interface.exchange_with_neighbours(unknowns_of_copies(*this));
  constexpr Index size = unknowns_of_grain<D>;
  Vector jumps = Vector::Zero(interface_size());
  for_each_in_parallel(count(subdomains), [&](Index e) {
    for (const WholeCopy<D>& copy : subdomains[at(e)].whole_copies) {
      const GrainUnknowns<D> own = unknowns(copy_of(*this, {e, copy.grain})), common = unknowns(copy.common);
      for (Index k = 0; k < size; ++k) jumps[size * copy.own + k] = own[at(k)] - common[at(k)];
    }
  });
  sum_of_neighbours({jumps.data(), at(jumps.size())});
  return jumps;
}

template <int D>
Vector GranularDecomposition<D>::all_interface_jumps() const {
  return interface.exchange(unknowns_of_copies(*this));
}

template <int D>
Vector GranularDecomposition<D>::free_velocities() const {
  std::vector<double> values;
  const auto append = [&](const GrainVelocity<D>& v) {
    if (v.inverse_mass == 0) return;
    const GrainUnknowns<D> own = unknowns(v);
    values.insert(values.end(), own.begin(), own.end());
  };
  for (const GranularSubdomain<D>& subdomain : subdomains) {
    std::ranges::for_each(subdomain.velocities, append);
    std::ranges::for_each(subdomain.whole_copies, append, &WholeCopy<D>::common);
  }
  return Vector::Map(values.data(), count(values));
}

template <int D>
double GranularDecomposition<D>::part_of_dot(Index subdomain, const Vector& f, const Vector& g) const {
  if (copies == CopyMass::shares) return interface.part_of_dot(subdomain, f, g);
  constexpr Index size = unknowns_of_grain<D>;
  double sum = 0;
  for (const WholeCopy<D>& copy : subdomains[at(subdomain)].whole_copies)
    sum += f.segment(size * copy.own, size).dot(g.segment(size * copy.own, size));
  return sum;
}

template <int D>
double GranularDecomposition<D>::squared_jumps(Index subdomain, const Vector& g) const {
  if (copies == CopyMass::shares) return part_of_dot(subdomain, g, g);
  constexpr Index size = unknowns_of_grain<D>;
  double sum = 0;
  for (const WholeCopy<D>& copy : subdomains[at(subdomain)].whole_copies)
    if (copy.own + 1 < copy.last)
      sum += (g.segment(size * copy.own, size) - g.segment(size * (copy.own + 1), size)).squaredNorm();
  return sum;
}

template <int D>
double GranularDecomposition<D>::glued_speed_squared(Index subdomain) const {
  double sum = 0;
  Index before = -1;
  for (const Tie& tie : interface.ties(subdomain)) {  // two successive ties may have the same copy
    if (tie.grain == std::exchange(before, tie.grain)) continue;
    const GrainVelocity<D>& v = copy_of(*this, {subdomain, tie.grain});
    sum += squared_velocity(v) + squared_rim(v);
  }
  return sum;
}

template <int D>
Vector GranularDecomposition<D>::generic_interface_solve(const Vector& g) const {
  const auto inertia = [&](Index row, Index k) { return copy_mass[at(row)] * inertia_ratio<D>(k); };
  if (copies == CopyMass::shares) return interface.solve_generic(inertia, g);
  Vector f(g.size());
  for (Index i = 0; i < f.size(); ++i) f[i] = inertia(i / unknowns_of_grain<D>, i % unknowns_of_grain<D>) * g[i];
  return f;
}

template <int D>
void GranularDecomposition<D>::apply_interface_impulses(const Vector& change) {
  for_each_in_parallel(count(subdomains), [&](Index e) {
    for (WholeCopy<D>& copy : subdomains[at(e)].whole_copies) {
      push(subdomains[at(e)].velocities[at(copy.grain)], load_of_others<D>(change, copy.first, copy.last, copy.own));
      push(copy.common, load_of_others<D>(change, copy.first, copy.last, -1));
    }
    if (copies == CopyMass::whole) return;
    for (const Tie& tie : interface.ties(e)) {
      GrainUnknowns<D> impulse;
      for (Index k = 0; k < unknowns_of_grain<D>; ++k)
        impulse[at(k)] = -tie.sign * change[unknowns_of_grain<D> * tie.row + k];
      push(subdomains[at(e)].velocities[at(tie.grain)], impulse);
    }
  });
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
      result.inertia[rows_of_grain * i + k] = mass * inertia_ratio<D>(k);
      result.arriving_velocity[rows_of_grain * i + k] = own[at(k)];
    }
  }
  ConnectivityBuilder<D> h(rows_of_grain * grains, D * problem.contacts.size());
  const auto rows = [&](Index body) {
    return problem.free[at(body)].inverse_mass == 0 ? BodyRows{} : BodyRows{rows_of_grain * body};
  };
  for (const GrainContact<D>& c : problem.contacts)
    for (const LocalVector<D>& direction : contact_directions<D>())
      h.add(c.normal, rows(c.a), rows(c.b), direction, c.levers.get());
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

template struct GranularDecomposition<2>;
template struct GranularDecomposition<3>;
template GranularDecomposition<2> decompose(const StepProblem<2>&, const Partition&, Choice<ContactOrder>,
                                            std::uint64_t, const std::vector<Index>&, const Processes&, CopyMass);
template GranularDecomposition<3> decompose(const StepProblem<3>&, const Partition&, Choice<ContactOrder>,
                                            std::uint64_t, const std::vector<Index>&, const Processes&, CopyMass);
template ReferenceProblem reference_problem(const StepProblem<2>&, Index);
template ReferenceProblem reference_problem(const StepProblem<3>&, Index);

}  // namespace nscdd
