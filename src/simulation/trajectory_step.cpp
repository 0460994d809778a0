// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/trajectory_step.hpp"

namespace nscdd {

template <int D>
std::vector<TrajectoryContact> trajectory_contacts(const SolvedStep<D>& solved) {
  std::vector<TrajectoryContact> contacts;
  contacts.reserve(solved.contacts.size());
  for (std::size_t k = 0; k < solved.contacts.size(); ++k) {
    const GrainContact<D>& c = solved.contacts[k];
    contacts.push_back(
        {solved.problem.geometry[k], {}, status_of(solved.problem.law, c), solved.partition.subdomain_of_contact[k]});
    contacts.back().set(c.impulse);
  }
  return contacts;
}

std::vector<TrajectoryContact> contacts_at_first(std::vector<TrajectoryContact> own, const Processes& processes) {
  std::vector<TrajectoryContact> all = processes.gather_at_first(own);
  std::ranges::sort(all, {}, [](const TrajectoryContact& c) { return std::pair(c.geometry.a, c.geometry.b); });
  return all;
}

template <int D>
TrajectoryStep trajectory_step(const Simulation& after, const SolvedStep<D>& solved) {
  return {after.state, trajectory_contacts(solved)};
}

template std::vector<TrajectoryContact> trajectory_contacts(const SolvedStep<2>&);
template std::vector<TrajectoryContact> trajectory_contacts(const SolvedStep<3>&);
template TrajectoryStep trajectory_step(const Simulation&, const SolvedStep<2>&);
template TrajectoryStep trajectory_step(const Simulation&, const SolvedStep<3>&);

}  // namespace nscdd
