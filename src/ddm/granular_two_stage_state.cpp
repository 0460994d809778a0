// SPDX-License-Identifier: GPL-3.0-or-later
// What the iterations of a step begin with, and what they leave: impulses, velocities and gluing of all subdomains.
#include "ddm/granular_two_stage.hpp"
#include "mechanics/contact_solvers/contact_blocks.hpp"

namespace nscdd {
namespace {

// A subdomain as processes send it: its number, how many contacts and bodies it has, the number and the impulse of each
// contact, the number and the velocity of each body.
constexpr Index header = 3;
template <int D>
constexpr Index numbers_per_contact = D == 2 ? 3 : 5;
template <int D>
constexpr Index numbers_per_body = 1 + unknowns_of_grain<D>;
constexpr auto other_steps =
    "processes: expected the same step in all of them, met others: their processors may differ";

template <int D>
void pack(Index number, const GranularSubdomain<D>& subdomain, std::vector<double>& numbers) {
  const auto whole = [](auto n) { return static_cast<double>(n); };
  numbers.insert(numbers.end(), {whole(number), whole(subdomain.numbers.size()), whole(subdomain.bodies.size())});
  for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
    const SweptVector<D> r = subdomain.contacts.impulses[k];
    if constexpr (D == 2)
      numbers.insert(numbers.end(), {whole(subdomain.numbers[k]), r.n, r.t});
    else
      numbers.insert(numbers.end(), {whole(subdomain.numbers[k]), r.n, r.t.x, r.t.y, r.t.z});
  }
  for (std::size_t i = 0; i < subdomain.bodies.size(); ++i) {
    const GrainUnknowns<D> v = unknowns(subdomain.velocities[i]);
    numbers.push_back(whole(subdomain.bodies[i]));
    numbers.insert(numbers.end(), v.begin(), v.end());
  }
}

template <int D>
Index packed_size(const double* packed) {
  return header + numbers_per_contact<D> * static_cast<Index>(packed[1]) +
         numbers_per_body<D> * static_cast<Index>(packed[2]);
}

// Impulses and velocities alone, without rows and masses.
template <int D>
GranularSubdomain<D> unpacked(const double* packed) {
  const auto contacts = static_cast<Index>(packed[1]), bodies = static_cast<Index>(packed[2]);
  GranularSubdomain<D> subdomain;
  const double* next = packed + header;
  for (Index k = 0; k < contacts; ++k, next += numbers_per_contact<D>) {
    subdomain.numbers.push_back(static_cast<Index>(next[0]));
    if constexpr (D == 2)
      subdomain.contacts.impulses.push_back({next[1], next[2]});
    else
      subdomain.contacts.impulses.push_back({next[1], {next[2], next[3], next[4]}});
  }
  for (Index i = 0; i < bodies; ++i, next += numbers_per_body<D>) {
    subdomain.bodies.push_back(static_cast<Index>(next[0]));
    GrainUnknowns<D> v;
    std::copy_n(next + 1, v.size(), v.begin());
    subdomain.velocities.push_back(with_unknowns(v, 0));
  }
  return subdomain;
}

// Adds what a subdomain has found to the solution of the step.
template <int D>
void take_in(const GranularSubdomain<D>& subdomain, const StepProblem<D>& problem, const Interface& interface,
             typename GranularTwoStage<D>::Solution& solution) {
  for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
    GrainContact<D>& contact = solution.contacts[at(subdomain.numbers[k])];
    contact.impulse = in_frame(contact.normal, subdomain.contacts.impulses[k]);
  }
  for (std::size_t i = 0; i < subdomain.bodies.size(); ++i) {
    const Index g = subdomain.bodies[i];
    const double inverse_mass = problem.free[at(g)].inverse_mass;
    if (inverse_mass == 0) continue;
    const GrainUnknowns<D> start = unknowns(problem.free[at(g)]), found = unknowns(subdomain.velocities[i]);
    GrainUnknowns<D> v = unknowns(solution.velocities[at(g)]);
    if (const Index q = interface.multiplicity(g); q == 1) {
      v = found;
    } else {  // V_free + mean of what the copies gained
      const double part = 1 / static_cast<double>(q);
      for (std::size_t k = 0; k < v.size(); ++k) v[k] += part * (found[k] - start[k]);
    }
    solution.velocities[at(g)] = with_unknowns(v, inverse_mass);
  }
}

}  // namespace

template <int D>
void GranularTwoStage<D>::start(const std::vector<RememberedGluing>& gluing) {
  for (GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      if (const LocalVector<D> r = subdomain.contacts.impulse(k); carries(r))
        apply_impulse(subdomain.contacts.contact(k, subdomain.velocities), r, subdomain.velocities);
  if (gluing.empty()) return;
  constexpr Index size = unknowns_of_grain<D>;
  // Along the chain of a grain, F of a row is that of the row before plus the impulse on the copy between.
  Vector f = Vector::Zero(parts_.interface_size());
  auto old = gluing.begin();
  const auto& rows = parts_.interface.gluing();
  for (Index row = 0; row < count(rows);) {
    const Index grain = rows[at(row)].grain, last = row + parts_.interface.multiplicity(grain) - 1;
    while (old != gluing.end() && old->grain < grain) ++old;
    const auto copies = parts_.interface.copies(grain);
    const auto end = std::find_if(old, gluing.end(), [&](const auto& one) { return one.grain != grain; });
    const bool shared_alike =
        std::equal(old, end, copies.begin(), copies.end(),
                   [](const RememberedGluing& one, const GrainCopy& copy) { return one.subdomain == copy.subdomain; });
    for (const Index first = row; row < last; ++row) {
      if (!shared_alike) continue;
      const RememberedGluing& one = old[row - first];
      for (Index k = 0; k < size; ++k) {
        f[size * row + k] = one.impulse[at(k)];
        if (row > first) f[size * row + k] += f[size * (row - 1) + k];
      }
    }
  }
  correct(f);
}

template <int D>
Vector GranularTwoStage<D>::state() const {
  Vector z(D * parts_.contacts + parts_.interface_size());
  for (const GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      set_component<D>(z, subdomain.numbers[k], subdomain.contacts.impulse(k));
  z.tail(parts_.interface_size()) = interface_impulses_;
  return z;
}

template <int D>
void GranularTwoStage<D>::restart(const Vector& z) {
  for (GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k) {
      const LocalVector<D> before = subdomain.contacts.impulse(k), r = component<D>(z, subdomain.numbers[k]);
      subdomain.contacts.set_impulse(k, r);
      apply_impulse(subdomain.contacts.contact(k, subdomain.velocities), r - before, subdomain.velocities);
    }
  correct(z.tail(parts_.interface_size()) - interface_impulses_);
  direction_.resize(0);
}

template <int D>
std::vector<ContactStatus> GranularTwoStage<D>::statuses() const {
  std::vector<double> numbers(at(parts_.contacts), 0);
  for (const GranularSubdomain<D>& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      numbers[at(subdomain.numbers[k])] =
          static_cast<double>(status_of(law_, subdomain.contacts.contact(k, subdomain.velocities)));
  parts_.interface.processes().add_up(numbers);
  std::vector<ContactStatus> result;
  for (const double number : numbers) result.push_back(static_cast<ContactStatus>(static_cast<int>(number)));
  return result;
}

// Each process has the rows whose first copy is its own.
template <int D>
void GranularTwoStage<D>::gather_interface_impulses() {
  const Interface& interface = parts_.interface;
  const Processes& all = interface.processes();
  constexpr Index size = unknowns_of_grain<D>;
  const auto visit = [&](Index process, const auto& each) {
    for (Index row = 0; row < count(interface.gluing()); ++row)
      if (interface.process_of(interface.gluing()[at(row)].first.subdomain) == process)
        for (Index k = 0; k < size; ++k) each(interface_impulses_[size * row + k]);
  };
  std::vector<double> own;
  visit(all.rank, [&](double& number) { own.push_back(number); });
  const std::vector<double> numbers = all.gather(own);
  if (count(numbers) != interface.size()) throw Error(other_steps);
  auto next = numbers.begin();
  for (Index process = 0; process < all.size; ++process) visit(process, [&](double& number) { number = *next++; });
}

template <int D>
typename GranularTwoStage<D>::Solution GranularTwoStage<D>::gather(const StepProblem<D>& problem) {
  const Interface& interface = parts_.interface;
  const Processes& all = interface.processes();
  std::vector<double> sent, received;
  std::vector<const double*> place(parts_.subdomains.size(), nullptr);  // of the subdomains of other processes
  if (!all.alone()) {
    gather_interface_impulses();
    for (Index e = 0; e < count(parts_.subdomains); ++e)
      if (interface.process_of(e) == all.rank) pack<D>(e, parts_.subdomains[at(e)], sent);
    received = all.gather(sent);
    for (const double *next = received.data(), *end = next + received.size(); next != end; next += packed_size<D>(next))
      place[at(static_cast<Index>(next[0]))] = next;
    for (Index e = 0; e < count(place); ++e)
      if (place[at(e)] == nullptr) throw Error(other_steps);
  }
  Solution result{problem.contacts, problem.free};
  for (Index e = 0; e < count(parts_.subdomains); ++e) {  // means of copies add up in this order, whoever has them
    if (all.alone() || interface.process_of(e) == all.rank)
      take_in<D>(parts_.subdomains[at(e)], problem, interface, result);
    else
      take_in<D>(unpacked<D>(place[at(e)]), problem, interface, result);
  }
  return result;
}

template <int D>
std::vector<RememberedGluing> GranularTwoStage<D>::gluing() const {
  constexpr Index size = unknowns_of_grain<D>;
  std::vector<RememberedGluing> result;
  const auto& rows = parts_.interface.gluing();
  for (Index row = 0; row < count(rows);) {  // A_E^T F: along a chain, F of the row after a copy less that before it
    const Index grain = rows[at(row)].grain, first = row, last = row + parts_.interface.multiplicity(grain) - 1;
    for (const GrainCopy& copy : parts_.interface.copies(grain)) {
      RememberedGluing one{grain, copy.subdomain};
      for (Index k = 0; k < size; ++k) {
        if (row > first) one.impulse[at(k)] -= interface_impulses_[size * (row - 1) + k];
        if (row < last) one.impulse[at(k)] += interface_impulses_[size * row + k];
      }
      result.push_back(one);
      ++row;
    }
    row = last;
  }
  return result;
}

template void GranularTwoStage<2>::start(const std::vector<RememberedGluing>&);
template Vector GranularTwoStage<2>::state() const;
template void GranularTwoStage<2>::restart(const Vector&);
template std::vector<ContactStatus> GranularTwoStage<2>::statuses() const;
template GranularTwoStage<2>::Solution GranularTwoStage<2>::gather(const StepProblem<2>&);
template std::vector<RememberedGluing> GranularTwoStage<2>::gluing() const;
template void GranularTwoStage<3>::start(const std::vector<RememberedGluing>&);
template Vector GranularTwoStage<3>::state() const;
template void GranularTwoStage<3>::restart(const Vector&);
template std::vector<ContactStatus> GranularTwoStage<3>::statuses() const;
template GranularTwoStage<3>::Solution GranularTwoStage<3>::gather(const StepProblem<3>&);
template std::vector<RememberedGluing> GranularTwoStage<3>::gluing() const;

}  // namespace nscdd
