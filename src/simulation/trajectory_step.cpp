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
  if (processes.alone()) return own;
  std::vector<double> numbers;
  const auto put = [&](auto number) { numbers.push_back(static_cast<double>(number)); };
  for (const TrajectoryContact& c : own) {
    put(c.geometry.a);
    put(c.geometry.b);
    numbers.insert(numbers.end(), c.geometry.normal.begin(), c.geometry.normal.end());
    numbers.insert(numbers.end(), c.geometry.point.begin(), c.geometry.point.end());
    numbers.insert(numbers.end(), {c.geometry.gap, c.impulse.n, c.impulse.t, c.second_tangential});
    put(c.status);
    put(c.subdomain);
  }
  const double all = processes.sum(static_cast<double>(own.size()));
  own = {};
  if (processes.first()) own.reserve(static_cast<std::size_t>(all));
  for (Index process = 0; process < processes.size; ++process) {  // in turn: none needs memory for all at once
    const bool turn = process == processes.rank;
    const std::vector<double> given =
        processes.gather_at_first(turn ? std::span<const double>(numbers) : std::span<const double>());
    if (turn) numbers = {};
    for (const double* next = given.data(); next != given.data() + given.size();) {
      TrajectoryContact& c = own.emplace_back();
      c.geometry.a = static_cast<Index>(*next++);
      c.geometry.b = static_cast<Index>(*next++);
      for (double& one : c.geometry.normal) one = *next++;
      for (double& one : c.geometry.point) one = *next++;
      for (double* one : {&c.geometry.gap, &c.impulse.n, &c.impulse.t, &c.second_tangential}) *one = *next++;
      c.status = static_cast<ContactStatus>(static_cast<int>(*next++));
      c.subdomain = static_cast<Index>(*next++);
    }
  }
  std::ranges::sort(own, {}, [](const TrajectoryContact& c) { return std::pair(c.geometry.a, c.geometry.b); });
  return own;
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
