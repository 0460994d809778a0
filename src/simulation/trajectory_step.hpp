// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"

#include <set>

namespace nscdd {

/// A contact as a step left it.
struct TrajectoryContact {
  StepContact geometry;
  LocalVector<2> impulse =
      {};  ///< N s; in space the tangential part along t_1 of the frame of the normal, see tangents_of
  ContactStatus status = ContactStatus::open;
  Index subdomain = 0;
  double second_tangential = 0;  ///< in space along t_2, N s
  double self_stress = 0;        ///< of the chain that jams, see add_chain

  bool carries() const { return nscdd::carries(local<3>()); }
  double tangential() const { return std::hypot(impulse.t, second_tangential); }  ///< its size
  template <int D>
  LocalVector<D> local() const {
    if constexpr (D == 2)
      return impulse;
    else
      return {impulse.n, {impulse.t, second_tangential}};
  }
  void set(const LocalVector<2>& r) { impulse = r; }
  void set(const LocalVector<3>& r) {
    impulse = {r.n, r.t.first};
    second_tangential = r.t.second;
  }
};

/// A step of a trajectory: the state after it, and the contacts that led there (none at time 0).
struct TrajectoryStep {
  GranularState state;
  std::vector<TrajectoryContact> contacts;  ///< ascending by (a, b), those without an impulse included
};

/// The contacts of a solved step on this rank.
template <int D>
std::vector<TrajectoryContact> trajectory_contacts(const GranularStep<D>& solved) {
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

/// The subdomains of each grain: those of its contacts.
inline std::vector<std::set<Index>> subdomains_of_grains(const std::vector<TrajectoryContact>& contacts, Index grains) {
  std::vector<std::set<Index>> held(at(grains));
  for (const TrajectoryContact& contact : contacts)
    for (const Index body : {contact.geometry.a, contact.geometry.b})
      if (body < grains) held[at(body)].insert(contact.subdomain);
  return held;
}

}  // namespace nscdd
