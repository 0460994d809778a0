// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/divided_contacts.hpp"

#include "contact_solvers/solve_contacts.hpp"

namespace nscdd {
namespace {

constexpr Index contacts_for_threads = 4096;  // fewer are done before a thread wakes

template <int D>
void append(const ContactRows<D>& from, std::size_t k, ContactRows<D>& to) {
  to.friction = from.friction;
  to.boundary_friction = from.boundary_friction;
  to.rows.push_back(from.rows[k]);
  to.impulses.push_back(from.impulses[k]);
  if (!from.bias_t.empty()) to.bias_t.push_back(from.bias_t[k]);
  if (!from.pull.empty()) to.pull.push_back(from.pull[k]);
  if (!from.others.empty()) to.others.push_back(from.others[k]);
}

SweptVector<2> moved_on(const SweptVector<2>& x, const SweptVector<2>& before, double momentum) {
  return x + momentum * (x - before);
}
SweptVector<3> moved_on(const SweptVector<3>& x, const SweptVector<3>& before, double momentum) {
  const auto [n, t] = x - before;
  return {x.n + momentum * n, {x.t.x + momentum * t.x, x.t.y + momentum * t.y, x.t.z + momentum * t.z}};
}
template <int D>
GrainVelocity<D> moved_on(const GrainVelocity<D>& x, const GrainVelocity<D>& before, double momentum) {
  const GrainUnknowns<D> now = unknowns(x), last = unknowns(before);
  GrainVelocity<D> result = x;
  add(result, [&](std::size_t k) { return momentum * (now[k] - last[k]); });
  return result;
}

// x + momentum (x - before); `before` becomes x.
template <class Item>
void move_on(std::vector<Item>& x, std::vector<Item>& before, double momentum) {
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Item now = x[k];
    x[k] = moved_on(now, before[k], momentum);
    before[k] = now;
  }
}

}  // namespace

template <int D>
DividedContacts<D>::DividedContacts(const StepProblem<D>& problem, const Partition& partition,
                                    GranularDecomposition<D> parts, const ContactColours& colours,
                                    std::optional<CutContacts<D>> cut, Refinement refinement)
    : problem_(problem),
      processes_(parts.interface.processes()),
      coloured_(parts.subdomains.size()),
      changed_(at(colours.number)),
      shared_(parts.interface),
      pull_(Vector::Zero(D * count(problem.contacts))),
      cut_(std::move(cut)),
      refinement_(refinement) {
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
    GranularSubdomain<D>& subdomain = parts.subdomains[e];
    coloured_[e].resize(at(colours.number));
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k) {
      Coloured& own = coloured_[e][at(colours.of_contact[at(subdomain.numbers[k])])];
      own.numbers.push_back(subdomain.numbers[k]);
      append(subdomain.contacts, k, own.contacts);
    }
    bodies_.push_back(std::move(subdomain.bodies));
    subdomain = {};
    for (Coloured& own : coloured_[e]) own = Coloured(own);  // a copy frees the spare capacity
  }
  std::vector<std::vector<Index>> copy_of;  // of each body of a subdomain, -1 for the only copy
  for (const auto& bodies : bodies_) copy_of.emplace_back(bodies.size(), -1);
  for (Index k = 0; k < count(shared_.own()); ++k)
    copy_of[at(shared_.own()[at(k)].subdomain)][at(shared_.own()[at(k)].grain)] = k;
  for (std::size_t e = 0; e < coloured_.size(); ++e)
    for (std::size_t colour = 0; colour < changed_.size(); ++colour)
      for (const ContactRow<D>& row : coloured_[e][colour].contacts.rows)
        for (const std::int32_t body : {row.a, row.b})
          if (const Index k = copy_of[e][at(body)]; k >= 0) changed_[colour].push_back(k);
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) pull_[D * static_cast<Index>(c)] = problem.contacts[c].pull;
  set_data(partition);
}

template <int D>
void DividedContacts<D>::set_data(const Partition& partition) {
  const std::vector<GrainContact<D>>& contacts = problem_.contacts;
  const Index number = count(contacts);
  data.q = relative_velocities(moved(-pull_));
  data.friction.resize(number);
  data.normal.resize(D * number);
  const std::vector<double> of_bodies = speeds_of<D>(problem_.free);
  Vector speeds(number);
  for (Index c = 0; c < number; ++c) {
    const GrainContact<D>& contact = contacts[at(c)];
    set_component(data.q, c, component<D>(data.q, c) + contact.bias);
    data.friction[c] = contact.friction;
    data.normal.template segment<D>(D * c).setConstant(1 / inverse_normal_delassus(contact));
    speeds[c] = of_bodies[at(contact.a)] + of_bodies[at(contact.b)];
  }
  // Per contact H has 2 x 5 entries in the plane, 2 x 15 in space; H^T and H each take two operations per entry.
  data.product_operations = 2.0 * 2 * (D == 2 ? 10 : 30) * processes_.sum(static_cast<double>(number));
  data.sums = {partition.subdomain_of_contact, partition.subdomains, processes_};
  const auto diagonal = [&](Index c) -> FullDelassus<D> {
    const GrainContact<D>& contact = contacts[at(c)];
    if (contact.levers) return lever_delassus(*contact.levers, contact.inverse_mass_a, contact.inverse_mass_b);
    const DiagonalDelassus w = contact.inverse_w();
    if constexpr (D == 2)
      return {.nn = 1 / w.inverse_n, .tt = 1 / w.inverse_t};
    else
      return {.nn = 1 / w.inverse_n, .tt = {1 / w.inverse_t, 0, 1 / w.inverse_t}};
  };
  data.set_sums<D>(diagonal, speeds);
}

template <int D>
void DividedContacts<D>::for_each_subdomain(const std::function<void(Index)>& work) const {
  if (count(bodies_) > 1 && count(problem_.contacts) >= contacts_for_threads)
    return for_each_in_parallel(count(bodies_), work);
  for (Index e = 0; e < count(bodies_); ++e) work(e);
}

template <int D>
template <class Self, class Visit>
void DividedContacts<D>::for_each_contact(Self& self, const Visit& visit) {
  self.for_each_subdomain([&](Index e) {
    for (auto& colour : self.coloured_[at(e)])
      for (std::size_t k = 0; k < colour.numbers.size(); ++k) visit(e, colour, k);
  });
}

template <int D>
CopiesOfGrains<D> DividedContacts<D>::caused(const Vector& r) const {
  CopiesOfGrains<D> velocities(bodies_.size());
  for_each_subdomain([&](Index e) {
    std::vector<GrainVelocity<D>>& own = velocities[at(e)];
    for (const Index body : bodies_[at(e)]) own.push_back({.inverse_mass = problem_.free[at(body)].inverse_mass});
    for (const Coloured& colour : coloured_[at(e)])
      for (std::size_t k = 0; k < colour.numbers.size(); ++k)
        colour.contacts.push_bodies(k, component<D>(r, colour.numbers[k]), own);
  });
  shared_.add_up(velocities);
  return velocities;
}

template <int D>
CopiesOfGrains<D> DividedContacts<D>::moved(const Vector& r) const {
  CopiesOfGrains<D> velocities = caused(r);
  for_each_subdomain([&](Index e) {
    for (std::size_t i = 0; i < velocities[at(e)].size(); ++i) {
      const GrainUnknowns<D> free = unknowns(problem_.free[at(bodies_[at(e)][i])]);
      add(velocities[at(e)][i], [&](std::size_t k) { return free[k]; });
    }
  });
  return velocities;
}

template <int D>
Vector DividedContacts<D>::relative_velocities(const CopiesOfGrains<D>& velocities) const {
  Vector u(D * count(problem_.contacts));
  for_each_contact(*this, [&](Index e, const Coloured& colour, std::size_t k) {
    set_component(u, colour.numbers[k], colour.contacts.relative_velocity_at(k, velocities[at(e)]));
  });
  return u;
}

template <int D>
Vector DividedContacts<D>::product(const Vector& r) const {
  return relative_velocities(caused(r));
}

template <int D>
Vector DividedContacts<D>::solve(const Vector& b) {
  Vector r = cut_->solve(b);
  if (refinement_ == Refinement::one_step)
    r += cut_->solve(ContactRelation<D>::rest(cut_->relations(), b, r, product(r)));
  return r;
}

template <int D>
Vector DividedContacts<D>::swept(const Vector& r, const SweepTurn& turn, double omega) {
  const Vector pulled = r - pull_;
  CopiesOfGrains<D> velocities = moved(pulled);
  for_each_contact(*this, [&](Index, Coloured& colour, std::size_t k) {
    colour.contacts.set_impulse(k, component<D>(pulled, colour.numbers[k]));
  });
  std::vector<std::vector<std::vector<SweptVector<D>>>> before(bodies_.size());  // impulses, if there is momentum
  CopiesOfGrains<D> slower;                                                      // velocities
  if (turn.momentum > 0) {
    slower = velocities;
    for (std::size_t e = 0; e < before.size(); ++e)
      for (const Coloured& colour : coloured_[e]) before[e].push_back(colour.contacts.impulses);
  }
  for (Index sweep = 0; sweep < turn.many; ++sweep) {
    for (std::size_t colour = 0; colour < changed_.size(); ++colour) {
      for_each_subdomain([&](Index e) {
        gauss_seidel_sweep(problem_.law, coloured_[at(e)][colour].contacts, velocities[at(e)], omega);
      });
      shared_.follow(changed_[colour], velocities);
    }
    if (turn.momentum > 0)
      for_each_subdomain([&](Index e) {
        for (std::size_t colour = 0; colour < changed_.size(); ++colour)
          move_on(coloured_[at(e)][colour].contacts.impulses, before[at(e)][colour], turn.momentum);
        move_on(velocities[at(e)], slower[at(e)], turn.momentum);
      });
  }
  Vector result(r.size());
  for_each_contact(*this, [&](Index, const Coloured& colour, std::size_t k) {
    set_component(result, colour.numbers[k], colour.contacts.impulse(k));
  });
  return result + pull_;
}

template <int D>
std::vector<GrainVelocity<D>> DividedContacts<D>::velocities(const Vector& r) const {
  const CopiesOfGrains<D> copies = moved(r - pull_);
  std::vector<GrainVelocity<D>> result = problem_.free;
  for (std::size_t e = 0; e < bodies_.size(); ++e)
    for (std::size_t i = 0; i < bodies_[e].size(); ++i) result[at(bodies_[e][i])] = copies[e][i];
  return result;
}

template class DividedContacts<2>;
template class DividedContacts<3>;
template FrictionSolution solve_contacts(DividedContacts<2>&, const FrictionSolverOptions&, const Vector&,
                                         const FrictionObserver&);
template FrictionSolution solve_contacts(DividedContacts<3>&, const FrictionSolverOptions&, const Vector&,
                                         const FrictionObserver&);

}  // namespace nscdd
