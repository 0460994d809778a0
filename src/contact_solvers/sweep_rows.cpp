// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/sweep_rows.hpp"

#include "linalg/random.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "mechanics/gauss_seidel.hpp"

#include <numeric>

namespace nscdd {
namespace {

// Places of a block: enough for out-of-order execution to find independent ones, few enough for the first cache.
constexpr Index interleaved_block = 256;
// Contacts of a colour that a thread takes at a time.
constexpr Index places_at_a_time = 256;

// Contacts that W couples, in either direction and each with itself.
template <int D>
std::vector<std::vector<Index>> coupled_contacts(const LocalFrictionProblem& problem) {
  std::vector<std::vector<Index>> coupled(at(problem.contacts()));
  for_entries(problem.w, [&](Index i, Index j, double) {
    coupled[at(i / D)].push_back(j / D);
    coupled[at(j / D)].push_back(i / D);
  });
  for (std::vector<Index>& others : coupled) {
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
  }
  return coupled;
}

// Each contact takes the least colour that no coupled contact of its block before it has.
template <int D>
std::vector<Index> colours_of(const LocalFrictionProblem& problem, Index block) {
  const std::vector<std::vector<Index>> coupled = coupled_contacts<D>(problem);
  std::vector<Index> colours(coupled.size()), taken;
  for (Index c = 0; c < problem.contacts(); ++c) {
    taken.clear();
    for (const Index other : coupled[at(c)])
      if (other < c && other / block == c / block) taken.push_back(colours[at(other)]);
    std::sort(taken.begin(), taken.end());
    for (const Index colour : taken)
      if (colour == colours[at(c)]) ++colours[at(c)];
  }
  return colours;
}

// The contacts by blocks, those of a block by colours, those of a colour as they are numbered.
std::vector<Index> by_colour(const std::vector<Index>& colours, Index block) {
  std::vector<Index> order(colours.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::pair(a / block, colours[at(a)]) < std::pair(b / block, colours[at(b)]);
  });
  return order;
}

std::vector<Index> shuffled(Index contacts, Index seed) {
  std::vector<Index> order(at(contacts));
  std::iota(order.begin(), order.end(), Index{0});
  RandomStream stream(static_cast<std::uint64_t>(seed));
  for (Index k = contacts - 1; k > 0; --k) std::swap(order[at(k)], order[at(stream.below(k + 1))]);
  return order;
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
Vector SweepRows<D>::in_order(const Vector& impulses) const {
  Vector result(impulses.size());
  for (Index place = 0; place < size(); ++place)
    result.segment<D>(D * place) = impulses.segment<D>(D * contact[at(place)]);
  return result;
}

template <int D>
Vector SweepRows<D>::by_contact(const Vector& impulses) const {
  Vector result(impulses.size());
  for (Index place = 0; place < size(); ++place)
    result.segment<D>(D * contact[at(place)]) = impulses.segment<D>(D * place);
  return result;
}

template <int D>
SweepRows<D> sweep_rows(const LocalFrictionProblem& problem, SweepOrder order, Index seed) {
  const Index contacts = problem.contacts();
  SweepRows<D> rows;
  if (order == SweepOrder::coloured || order == SweepOrder::interleaved) {
    const Index block = order == SweepOrder::coloured ? std::max<Index>(1, contacts) : interleaved_block;
    const std::vector<Index> colours = colours_of<D>(problem, block);
    rows.contact = by_colour(colours, block);
    if (order == SweepOrder::coloured)
      for (Index place = 0; place <= contacts; ++place)
        if (place == 0 || place == contacts ||
            colours[at(rows.contact[at(place)])] != colours[at(rows.contact[at(place - 1)])])
          rows.first_of_colour.push_back(place);
  } else if (order == SweepOrder::random) {
    rows.contact = shuffled(contacts, seed);
  } else {
    rows.contact.resize(at(contacts));
    std::iota(rows.contact.begin(), rows.contact.end(), Index{0});
    if (order == SweepOrder::reverse) std::reverse(rows.contact.begin(), rows.contact.end());
  }
  rows.w = ContactBlocks<D>(problem.w, rows.contact);
  rows.q = rows.in_order(problem.q);
  rows.friction = problem.friction(rows.contact);
  for (const Index c : rows.contact) rows.diagonal.push_back(diagonal_block<D>(problem, c));
  if constexpr (D == 3)
    for (const FullDelassus<D>& w : rows.diagonal) rows.cones.emplace_back(w);
  return rows;
}

template <int D>
void sweep_once(const SweepRows<D>& rows, SweepOrder order, double relaxation, Index number, Vector& impulses) {
  const auto turns = [&](Index first, Index last, Index step) {
    relaxation == 1 ? take_turns<false>(rows, relaxation, first, last, step, impulses)
                    : take_turns<true>(rows, relaxation, first, last, step, impulses);
  };
  if (order != SweepOrder::coloured)
    return order == SweepOrder::symmetric && number % 2 == 1 ? turns(rows.size() - 1, -1, -1)
                                                             : turns(0, rows.size(), 1);
  for (std::size_t k = 0; k + 1 < rows.first_of_colour.size(); ++k) {
    const Index first = rows.first_of_colour[k], last = rows.first_of_colour[k + 1];
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
template SweepRows<2> sweep_rows<2>(const LocalFrictionProblem&, SweepOrder, Index);
template SweepRows<3> sweep_rows<3>(const LocalFrictionProblem&, SweepOrder, Index);
template void sweep_once(const SweepRows<2>&, SweepOrder, double, Index, Vector&);
template void sweep_once(const SweepRows<3>&, SweepOrder, double, Index, Vector&);

}  // namespace nscdd
