// SPDX-License-Identifier: GPL-3.0-or-later
// What the iterations of a step begin with, and what they leave: impulses, velocities and gluing of all subdomains.
#include "ddm/granular_two_stage.hpp"

namespace nscdd {
namespace {

// A subdomain as processes send it: its number, how many contacts and bodies it has, the number and the impulse of each
// contact, the number and the velocity of each body.
constexpr Index header = 3, numbers_per_contact = 3, numbers_per_body = 4;
constexpr auto other_steps =
    "processes: expected the same step in all of them, met others: their processors may differ";

void pack(Index number, const GranularSubdomain& subdomain, std::vector<double>& numbers) {
  const auto whole = [](auto n) { return static_cast<double>(n); };
  numbers.insert(numbers.end(), {whole(number), whole(subdomain.numbers.size()), whole(subdomain.bodies.size())});
  for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
    const LocalVector<2> r = subdomain.contacts.impulses[k];
    numbers.insert(numbers.end(), {whole(subdomain.numbers[k]), r.n, r.t});
  }
  for (std::size_t i = 0; i < subdomain.bodies.size(); ++i) {
    const DiskVelocity& v = subdomain.velocities[i];
    numbers.insert(numbers.end(), {whole(subdomain.bodies[i]), v.x, v.y, v.rim});
  }
}

Index packed_size(const double* packed) {
  return header + numbers_per_contact * static_cast<Index>(packed[1]) +
         numbers_per_body * static_cast<Index>(packed[2]);
}

// Impulses and velocities alone, without rows and masses.
GranularSubdomain unpacked(const double* packed) {
  const auto contacts = static_cast<Index>(packed[1]), bodies = static_cast<Index>(packed[2]);
  GranularSubdomain subdomain;
  const double* next = packed + header;
  for (Index k = 0; k < contacts; ++k, next += numbers_per_contact) {
    subdomain.numbers.push_back(static_cast<Index>(next[0]));
    subdomain.contacts.impulses.push_back({next[1], next[2]});
  }
  for (Index i = 0; i < bodies; ++i, next += numbers_per_body) {
    subdomain.bodies.push_back(static_cast<Index>(next[0]));
    subdomain.velocities.push_back({next[1], next[2], next[3], 0});
  }
  return subdomain;
}

// Adds what a subdomain has found to the solution of the step.
void take_in(const GranularSubdomain& subdomain, const StepProblem& problem, const Interface& interface,
             GranularTwoStage::Solution& solution) {
  for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
    solution.contacts[at(subdomain.numbers[k])].impulse = subdomain.contacts.impulses[k];
  for (std::size_t i = 0; i < subdomain.bodies.size(); ++i) {
    const Index g = subdomain.bodies[i];
    const DiskVelocity &start = problem.free[at(g)], &found = subdomain.velocities[i];
    DiskVelocity& v = solution.velocities[at(g)];
    if (start.inverse_mass == 0) continue;
    if (const Index q = interface.multiplicity(g); q == 1) {
      v = {found.x, found.y, found.rim, start.inverse_mass};
    } else {  // V_free + mean of what the copies gained
      const double part = 1 / static_cast<double>(q);
      v.x += part * (found.x - start.x);
      v.y += part * (found.y - start.y);
      v.rim += part * (found.rim - start.rim);
    }
  }
}

}  // namespace

void GranularTwoStage::start(const std::vector<RememberedGluing>& gluing) {
  for (GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      if (const LocalVector<2> r = subdomain.contacts.impulses[k]; r.n != 0 || r.t != 0)
        apply_impulse(subdomain.contacts.contact(k, subdomain.velocities), r, subdomain.velocities);
  if (gluing.empty()) return;
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
      f.segment<3>(3 * row) << one.x, one.y, one.rim;
      if (row > first) f.segment<3>(3 * row) += f.segment<3>(3 * (row - 1));
    }
  }
  correct(f);
}

Vector GranularTwoStage::state() const {
  Vector z(2 * parts_.contacts + parts_.interface_size());
  for (const GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      z.segment<2>(2 * subdomain.numbers[k]) << subdomain.contacts.impulses[k].n, subdomain.contacts.impulses[k].t;
  z.tail(parts_.interface_size()) = interface_impulses_;
  return z;
}

void GranularTwoStage::restart(const Vector& z) {
  for (GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k) {
      LocalVector<2>& r = subdomain.contacts.impulses[k];
      const Index first = 2 * subdomain.numbers[k];
      const LocalVector<2> before = std::exchange(r, {z[first], z[first + 1]});
      apply_impulse(subdomain.contacts.contact(k, subdomain.velocities), r - before, subdomain.velocities);
    }
  correct(z.tail(parts_.interface_size()) - interface_impulses_);
  direction_.resize(0);
}

std::vector<ContactStatus> GranularTwoStage::statuses() const {
  std::vector<double> numbers(at(parts_.contacts), 0);
  for (const GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      numbers[at(subdomain.numbers[k])] =
          static_cast<double>(status_of(law_, subdomain.contacts.contact(k, subdomain.velocities)));
  parts_.interface.processes().add_up(numbers);
  std::vector<ContactStatus> result;
  for (const double number : numbers) result.push_back(static_cast<ContactStatus>(static_cast<int>(number)));
  return result;
}

// Each process has the rows whose first copy is its own.
void GranularTwoStage::gather_interface_impulses() {
  const Interface& interface = parts_.interface;
  const Processes& all = interface.processes();
  const auto visit = [&](Index process, const auto& each) {
    for (Index row = 0; row < count(interface.gluing()); ++row)
      if (interface.process_of(interface.gluing()[at(row)].first.subdomain) == process)
        for (Index k = 0; k < 3; ++k) each(interface_impulses_[3 * row + k]);
  };
  std::vector<double> own;
  visit(all.rank, [&](double& number) { own.push_back(number); });
  const std::vector<double> numbers = all.gather(own);
  if (count(numbers) != interface.size()) throw Error(other_steps);
  auto next = numbers.begin();
  for (Index process = 0; process < all.size; ++process) visit(process, [&](double& number) { number = *next++; });
}

GranularTwoStage::Solution GranularTwoStage::gather(const StepProblem& problem) {
  const Interface& interface = parts_.interface;
  const Processes& all = interface.processes();
  std::vector<double> sent, received;
  std::vector<const double*> place(parts_.subdomains.size(), nullptr);  // of the subdomains of other processes
  if (!all.alone()) {
    gather_interface_impulses();
    for (Index e = 0; e < count(parts_.subdomains); ++e)
      if (interface.process_of(e) == all.rank) pack(e, parts_.subdomains[at(e)], sent);
    received = all.gather(sent);
    for (const double *next = received.data(), *end = next + received.size(); next != end; next += packed_size(next))
      place[at(static_cast<Index>(next[0]))] = next;
    for (Index e = 0; e < count(place); ++e)
      if (place[at(e)] == nullptr) throw Error(other_steps);
  }
  Solution result{problem.contacts, problem.free};
  for (Index e = 0; e < count(parts_.subdomains); ++e) {  // means of copies add up in this order, whoever has them
    if (all.alone() || interface.process_of(e) == all.rank)
      take_in(parts_.subdomains[at(e)], problem, interface, result);
    else
      take_in(unpacked(place[at(e)]), problem, interface, result);
  }
  return result;
}

std::vector<RememberedGluing> GranularTwoStage::gluing() const {
  std::vector<RememberedGluing> result;
  const auto& rows = parts_.interface.gluing();
  for (Index row = 0; row < count(rows);) {  // A_E^T F: along a chain, F of the row after a copy less that before it
    const Index grain = rows[at(row)].grain, first = row, last = row + parts_.interface.multiplicity(grain) - 1;
    for (const GrainCopy& copy : parts_.interface.copies(grain)) {
      Eigen::Vector3d f = Eigen::Vector3d::Zero();
      if (row > first) f -= interface_impulses_.segment<3>(3 * (row - 1));
      if (row < last) f += interface_impulses_.segment<3>(3 * row);
      result.push_back({grain, copy.subdomain, f[0], f[1], f[2]});
      ++row;
    }
    row = last;
  }
  return result;
}

}  // namespace nscdd
