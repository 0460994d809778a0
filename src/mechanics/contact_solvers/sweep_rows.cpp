// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/contact_solvers/sweep_rows.hpp"

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
std::vector<std::vector<Index>> coupled_contacts(const LocalFrictionProblem& problem) {
  std::vector<std::vector<Index>> coupled(at(problem.contacts()));
  for_entries(problem.w, [&](Index i, Index j, double) {
    coupled[at(i / 2)].push_back(j / 2);
    coupled[at(j / 2)].push_back(i / 2);
  });
  for (std::vector<Index>& others : coupled) {
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
  }
  return coupled;
}

// Each contact takes the least colour that no coupled contact of its block before it has.
std::vector<Index> colours_of(const LocalFrictionProblem& problem, Index block) {
  const std::vector<std::vector<Index>> coupled = coupled_contacts(problem);
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

template <bool relaxed>
void take_turns(const SweepRows& rows, double relaxation, Index first, Index last, Index step, Vector& impulses) {
  for (Index place = first; place != last; place += step) {
    const FullDelassus& w = rows.diagonal[at(place)];
    LocalVector<2> r = component(impulses, place);
    const LocalVector<2> stop = stopping(w, r, rows.w.add_row(place, impulses, component(rows.q, place)));
    take_impulse<relaxed>(r, Coulomb{}.impulse(stop, w, rows.friction[place]), relaxation);
    impulses[2 * place] = r.n;
    impulses[2 * place + 1] = r.t;
  }
}

}  // namespace

Vector SweepRows::in_order(const Vector& impulses) const {
  Vector result(impulses.size());
  for (Index place = 0; place < size(); ++place)
    result.segment<2>(2 * place) = impulses.segment<2>(2 * contact[at(place)]);
  return result;
}

Vector SweepRows::by_contact(const Vector& impulses) const {
  Vector result(impulses.size());
  for (Index place = 0; place < size(); ++place)
    result.segment<2>(2 * contact[at(place)]) = impulses.segment<2>(2 * place);
  return result;
}

SweepRows sweep_rows(const LocalFrictionProblem& problem, SweepOrder order, Index seed) {
  const Index contacts = problem.contacts();
  SweepRows rows;
  if (order == SweepOrder::coloured || order == SweepOrder::interleaved) {
    const Index block = order == SweepOrder::coloured ? std::max<Index>(1, contacts) : interleaved_block;
    const std::vector<Index> colours = colours_of(problem, block);
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
  rows.w = ContactBlocks(problem.w, rows.contact);
  rows.q = rows.in_order(problem.q);
  rows.friction = problem.friction(rows.contact);
  for (const Index c : rows.contact) rows.diagonal.push_back(diagonal_block(problem, c));
  return rows;
}

void sweep_once(const SweepRows& rows, SweepOrder order, double relaxation, Index number, Vector& impulses) {
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

}  // namespace nscdd
