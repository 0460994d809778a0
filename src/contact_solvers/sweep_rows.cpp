// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/sweep_rows.hpp"

#include "contact_solvers/contact_turns.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "mechanics/gauss_seidel.hpp"

namespace nscdd {
namespace {

constexpr Index places_at_a_time = 256;  // contacts of a colour that a thread takes at a time

// Contacts that W couples with each, in either direction, itself included.
template <int D>
std::vector<std::vector<Index>> coupled_contacts(const LocalFrictionProblem& problem) {
  std::vector<std::vector<Index>> coupled(at(problem.contacts()));
  for_entries(problem.w, [&](Index i, Index j, double) {
    coupled[at(i / D)].push_back(j / D);
    coupled[at(j / D)].push_back(i / D);
  });
  for (std::vector<Index>& others : coupled) sort_unique(others);
  return coupled;
}

// Greedy colours of contacts that W couples, block by block.
template <int D>
std::vector<Index> colours_of(const LocalFrictionProblem& problem, Index block) {
  const std::vector<std::vector<Index>> coupled = coupled_contacts<D>(problem);
  GreedyColours taken(problem.contacts());
  std::vector<Index> colours;
  for (Index c = 0; c < problem.contacts(); ++c)
    colours.push_back(taken.take_least(coupled[at(c)], {&c, 1}, c / block));
  return colours;
}

template <bool relaxed, int D>
void take_turns(const SweepRows<D>& rows, double relaxation, Index first, Index last, Index step, Vector& impulses) {
  for (Index place = first; place != last; place += step) {
    const FullDelassus<D>& w = rows.diagonal[at(place)];
    LocalVector<D> r = component<D>(impulses, place), wanted;
    const LocalVector<D> u = rows.w.add_row(place, impulses, component<D>(rows.q, place));
    if constexpr (D == 2)
      wanted = Coulomb{}.impulse(stopping(w, r, u), w, rows.friction[place]);
    else
      wanted = rows.cones[at(place)].impulse(u - w.apply(r), rows.friction[place]);
    take_impulse<relaxed>(r, wanted, relaxation);
    set_component(impulses, place, r);
  }
}

}  // namespace

template <int D>
SweepRows<D>::SweepRows(const LocalFrictionProblem& problem, SweepOrder sweep_order, Index seed) : order(sweep_order) {
  const Index contacts = problem.contacts();
  contact =
      order == SweepOrder::random ? random_order(contacts, static_cast<std::uint64_t>(seed)) : natural_order(contacts);
  if (order == SweepOrder::reverse) std::ranges::reverse(contact);
  if (order == SweepOrder::interleaved)
    sort_by_colour(contact, colours_of<D>(problem, interleaved_block), interleaved_block);
  if (order == SweepOrder::coloured) {
    const Index one_block = std::max<Index>(1, contacts);
    const std::vector<Index> colours = colours_of<D>(problem, one_block);
    sort_by_colour(contact, colours, one_block);
    for (Index place = 0; place <= contacts; ++place)
      if (place == 0 || place == contacts || colours[at(contact[at(place)])] != colours[at(contact[at(place - 1)])])
        first_of_colour.push_back(place);
  }
  w = ContactBlocks<D>(problem.w, contact);
  q = in_order(problem.q);
  friction = problem.friction(contact);
  for (const Index c : contact) diagonal.push_back(diagonal_block<D>(problem, c));
  if constexpr (D == 3)
    for (const FullDelassus<D>& block : diagonal) cones.emplace_back(block);
}

template <int D>
void SweepRows<D>::sweep(double relaxation, Index number, Vector& impulses) const {
  const auto turns = [&](Index first, Index last, Index step) {
    relaxation == 1 ? take_turns<false>(*this, relaxation, first, last, step, impulses)
                    : take_turns<true>(*this, relaxation, first, last, step, impulses);
  };
  if (order != SweepOrder::coloured)
    return order == SweepOrder::symmetric && number % 2 == 1 ? turns(size() - 1, -1, -1) : turns(0, size(), 1);
  for (std::size_t k = 0; k + 1 < first_of_colour.size(); ++k) {
    const Index first = first_of_colour[k], last = first_of_colour[k + 1];
    const Index parts = (last - first + places_at_a_time - 1) / places_at_a_time;
    if (parts == 1)
      turns(first, last, 1);
    else
      for_each_in_parallel(parts, [&](Index part) {
        const Index from = first + part * places_at_a_time;
        turns(from, std::min(from + places_at_a_time, last), 1);
      });
  }
}

template struct SweepRows<2>;
template struct SweepRows<3>;

}  // namespace nscdd
