// SPDX-License-Identifier: GPL-3.0-or-later
// What the iterations of a step begin with, and what they leave: impulses, velocities and gluing of all subdomains.
#include "ddm/granular_two_stage.hpp"

namespace nscdd {

void GranularTwoStage::start(const std::vector<RememberedGluing>& gluing) {
  for (GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      if (const LocalVector r = subdomain.contacts.impulses[k]; r.n != 0 || r.t != 0)
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
  Index contacts = 0;
  for (const GranularSubdomain& subdomain : parts_.subdomains) contacts += count(subdomain.numbers);
  Vector z(2 * contacts + parts_.interface_size());
  for (const GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      z.segment<2>(2 * subdomain.numbers[k]) << subdomain.contacts.impulses[k].n, subdomain.contacts.impulses[k].t;
  z.tail(parts_.interface_size()) = interface_impulses_;
  return z;
}

void GranularTwoStage::restart(const Vector& z) {
  for (GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k) {
      LocalVector& r = subdomain.contacts.impulses[k];
      const Index first = 2 * subdomain.numbers[k];
      const LocalVector before = std::exchange(r, {z[first], z[first + 1]});
      apply_impulse(subdomain.contacts.contact(k, subdomain.velocities), r - before, subdomain.velocities);
    }
  correct(z.tail(parts_.interface_size()) - interface_impulses_);
  direction_.resize(0);
}

void GranularTwoStage::gather() {
  const Interface& interface = parts_.interface;
  const Processes& all = interface.processes();
  if (all.alone()) return;
  const auto visit = [&](Index process, const auto& each) {
    for (Index e = 0; e < count(parts_.subdomains); ++e) {
      if (interface.process_of(e) != process) continue;
      for (DiskVelocity& v : parts_.subdomains[at(e)].velocities) each(v.x), each(v.y), each(v.rim);
      for (LocalVector& r : parts_.subdomains[at(e)].contacts.impulses) each(r.n), each(r.t);
    }
    for (Index row = 0; row < count(interface.gluing()); ++row)
      if (interface.process_of(interface.gluing()[at(row)].first.subdomain) == process)
        for (Index k = 0; k < 3; ++k) each(interface_impulses_[3 * row + k]);
  };
  std::vector<double> own;
  visit(all.rank, [&](double& number) { own.push_back(number); });
  Index expected = 0;
  for (Index process = 0; process < all.size; ++process) visit(process, [&](double&) { ++expected; });
  const std::vector<double> numbers = all.gather(own);
  if (count(numbers) != expected)
    throw Error("processes: expected the same step in all of them, met others: their processors may differ");
  auto next = numbers.begin();
  for (Index process = 0; process < all.size; ++process) visit(process, [&](double& number) { number = *next++; });
}

std::vector<ContactStatus> GranularTwoStage::statuses() const {
  std::size_t contacts = 0;
  for (const GranularSubdomain& subdomain : parts_.subdomains) contacts += subdomain.numbers.size();
  std::vector<double> numbers(contacts, 0);
  for (const GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
      numbers[at(subdomain.numbers[k])] =
          static_cast<double>(status_of(law_, subdomain.contacts.contact(k, subdomain.velocities)));
  parts_.interface.processes().add_up(numbers);
  std::vector<ContactStatus> result;
  for (const double number : numbers) result.push_back(static_cast<ContactStatus>(static_cast<int>(number)));
  return result;
}

std::vector<DiskContact> GranularTwoStage::contacts(const StepProblem& problem) const {
  std::vector<DiskContact> result = problem.contacts;
  for (const GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
      result[at(subdomain.numbers[k])].impulse = subdomain.contacts.impulses[k];
  return result;
}

std::vector<DiskVelocity> GranularTwoStage::velocities(const StepProblem& problem) const {
  std::vector<DiskVelocity> result = problem.free;
  for (const GranularSubdomain& subdomain : parts_.subdomains)
    for (std::size_t i = 0; i < subdomain.bodies.size(); ++i) {
      const Index g = subdomain.bodies[i];
      DiskVelocity& v = result[at(g)];
      const Index q = parts_.interface.multiplicity(g);
      if (v.inverse_mass == 0) continue;
      if (q == 1) {
        v = subdomain.velocities[i];
      } else {  // V_free + mean of what the copies gained
        const double part = 1 / static_cast<double>(q);
        v.x += part * (subdomain.velocities[i].x - problem.free[at(g)].x);
        v.y += part * (subdomain.velocities[i].y - problem.free[at(g)].y);
        v.rim += part * (subdomain.velocities[i].rim - problem.free[at(g)].rim);
      }
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
