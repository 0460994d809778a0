// SPDX-License-Identifier: GPL-3.0-or-later
// Results of the iterations of a step: impulses, velocities and gluing of all subdomains.
#include "two_stage/granular_two_stage.hpp"

namespace nscdd {
namespace {

constexpr auto other_steps =
    "processes: expected the same step on all ranks, met different ones: their processors may differ";

// The copy of a shared grain in messages.
template <int D>
struct SentCopy {
  Index subdomain, grain;
  GrainUnknowns<D> velocity;
};

}  // namespace

// Each rank sends the rows of which it has the first copy.
template <int D>
void GranularTwoStage<D>::gather_interface_impulses() {
  const Interface& interface = parts_.interface;
  const Processes& all = interface.processes();
  constexpr Index size = unknowns_of_grain<D>;
  const auto visit = [&](Index process, const auto& each) {
    for (Index row = 0; row < count(parts_.subdomain_of_row); ++row)
      if (interface.process_of(parts_.subdomain_of_row[at(row)]) == process)
        for (Index k = 0; k < size; ++k) each(interface_impulses_[size * row + k]);
  };
  std::vector<double> own;
  visit(all.rank, [&](double& number) { own.push_back(number); });
  const std::vector<double> numbers = all.gather(own);
  if (count(numbers) != parts_.interface_size()) throw Error(other_steps);
  auto next = numbers.begin();
  for (Index process = 0; process < all.size; ++process) visit(process, [&](double& number) { number = *next++; });
}

template <int D>
typename GranularTwoStage<D>::Solution GranularTwoStage<D>::gather(const StepProblem<D>& problem) {
  const Interface& interface = parts_.interface;
  const Processes& all = interface.processes();
  if (parts_.copies == CopyMass::whole) exchange_resultants();
  gather_interface_impulses();
  Solution result{problem.contacts, problem.free};
  std::vector<SentCopy<D>> copies;
  for (Index e = 0; e < count(parts_.subdomains); ++e) {
    const GranularSubdomain<D>& subdomain = parts_.subdomains[at(e)];
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
      result.contacts[at(subdomain.numbers[k])].impulse = subdomain.contacts.impulse(k);
    for (std::size_t i = 0; i < subdomain.bodies.size(); ++i) {
      const std::size_t body = at(subdomain.bodies[i]);
      const Index number = problem.numbers[body];
      const double inverse_mass = problem.free[body].inverse_mass;
      const GrainUnknowns<D> v = unknowns(subdomain.velocities[i]);
      if (inverse_mass > 0 && interface.multiplicity(number) > 1) copies.push_back({e, number, v});
      if (inverse_mass > 0 && interface.multiplicity(number) == 1)
        result.velocities[body] = with_unknowns(v, inverse_mass);
    }
  }
  copies = all.gather(copies);
  // In the order of subdomains: no bit depends on the ranks.
  std::ranges::stable_sort(copies, {}, &SentCopy<D>::subdomain);
  for (const SentCopy<D>& copy : copies) {  // a shared grain, at first at V_free, takes a share of the change of each
    const Index body = body_of(problem, copy.grain);
    if (body < 0) continue;  // a grain of other ranks
    const double part = 1 / static_cast<double>(interface.multiplicity(copy.grain));
    const GrainUnknowns<D> start = unknowns(problem.free[at(body)]);
    add(result.velocities[at(body)], [&](std::size_t k) { return part * (copy.velocity[k] - start[k]); });
  }
  return result;
}

template <int D>
std::vector<RememberedGluing> GranularTwoStage<D>::gluing() const {
  constexpr Index size = unknowns_of_grain<D>;
  std::vector<RememberedGluing> result;
  Index before = 0;  // shared grains
  // A_E^T F: along a chain, F of the row after a copy minus that before it.
  parts_.interface.for_glued_grains([&](Index grain, Index first, Index last) {
    Index row = first;
    for (const GrainCopy& copy : parts_.interface.copies(grain)) {
      RememberedGluing one{grain, copy.subdomain};
      if (parts_.copies == CopyMass::whole)
        std::ranges::transform(load_of_others<D>(interface_impulses_, first + before, last + before + 1, row + before),
                               one.impulse.begin(), std::negate<>{});
      for (Index k = 0; k < size && parts_.copies == CopyMass::shares; ++k) {
        if (row > first) one.impulse[at(k)] -= interface_impulses_[size * (row - 1) + k];
        if (row < last) one.impulse[at(k)] += interface_impulses_[size * row + k];
      }
      result.push_back(one);
      ++row;
    }
    ++before;
  });
  return result;
}

template GranularTwoStage<2>::Solution GranularTwoStage<2>::gather(const StepProblem<2>&);
template std::vector<RememberedGluing> GranularTwoStage<2>::gluing() const;
template GranularTwoStage<3>::Solution GranularTwoStage<3>::gather(const StepProblem<3>&);
template std::vector<RememberedGluing> GranularTwoStage<3>::gluing() const;

}  // namespace nscdd
