// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/sweep_rows.hpp"

#include "contact_solvers/contact_turns.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "mechanics/gauss_seidel.hpp"

namespace nscdd {
namespace {

constexpr double coupling_by_rounding = 1e-15;
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

// Greedy colours, block by block: of contacts that share a body, if sweeps carry velocities, or that W couples.
template <int D>
std::vector<Index> colours_of(const LocalFrictionProblem& problem, Index block) {
  std::vector<Index> colours;
  if (const auto blocks = BodyBlocks<D>::of(problem, natural_order(problem.contacts()))) {
    GreedyColours taken(blocks->bodies());
    for (Index c = 0; c < problem.contacts(); ++c) {
      if (c % block == 0) taken.next_block();
      const std::vector<Index> own = blocks->bodies_of(c);
      colours.push_back(taken.take_least(own, own));
    }
    return colours;
  }
  GreedyColours taken(problem.contacts());
  for (Index c = 0; const std::vector<Index>& coupled : coupled_contacts<D>(problem)) {
    if (c % block == 0) taken.next_block();
    colours.push_back(taken.take_least(coupled, std::array{c}));
    ++c;
  }
  return colours;
}

// W of a contact whose normal and tangential directions do not couple but by rounding, as those of grains.
DiagonalDelassus without_coupling(const FullDelassus<2>& w) {
  return std::abs(w.nt) <= coupling_by_rounding * w.nn ? DiagonalDelassus{1 / w.nn, 1 / w.tt} : DiagonalDelassus{};
}
DiagonalDelassus without_coupling(const FullDelassus<3>& w) {
  const double coupling = std::max({norm(w.nt), std::abs(w.tt.mixed), std::abs(w.tt.first - w.tt.second)});
  return coupling <= coupling_by_rounding * w.nn ? DiagonalDelassus{1 / w.nn, 1 / w.tt.first} : DiagonalDelassus{};
}

// x + momentum (x - before); `before` becomes x.
void move_on(Vector& x, Vector& before, double momentum) {
  for (Index k = 0; k < x.size(); ++k) {
    const double now = x[k];
    x[k] = now + momentum * (now - before[k]);
    before[k] = now;
  }
}

// Impulses by places, and the velocities of the bodies if sweeps carry them.
struct SweepState {
  Vector impulses, velocities;
};

template <bool relaxed, int D, class Coupling>
void take_turns(const SweepRows<D>& rows, const Coupling& coupling, double relaxation, std::array<Index, 3> range,
                SweepState& state) {
  constexpr bool carries_velocities = std::is_same_v<Coupling, BodyBlocks<D>>;
  const Vector& source = carries_velocities ? state.velocities : state.impulses;
  for (Index place = range[0]; place != range[1]; place += range[2]) {
    LocalVector<D> r = component<D>(state.impulses, place), wanted;
    const LocalVector<D> u = coupling.add_row(place, source, component<D>(rows.q, place));
    const DiagonalDelassus uncoupled = rows.uncoupled[at(place)];
    if (uncoupled.inverse_n > 0)
      wanted = Coulomb{}.impulse(r - uncoupled.solve(u), uncoupled, rows.friction[place]);
    else if constexpr (D == 2)
      wanted =
          Coulomb{}.impulse(stopping(rows.diagonal[at(place)], r, u), rows.diagonal[at(place)], rows.friction[place]);
    else
      wanted = rows.cones[at(place)].impulse(u - rows.diagonal[at(place)].apply(r), rows.friction[place]);
    const LocalVector<D> change = take_impulse<relaxed>(r, wanted, relaxation);
    set_component(state.impulses, place, r);
    if constexpr (carries_velocities) coupling.push(place, change, state.velocities);
  }
}

template <int D, class Coupling>
void sweep(const SweepRows<D>& rows, const Coupling& coupling, double relaxation, Index number, SweepState& state) {
  const auto turns = [&](Index first, Index last, Index step) {
    relaxation == 1 ? take_turns<false>(rows, coupling, relaxation, {first, last, step}, state)
                    : take_turns<true>(rows, coupling, relaxation, {first, last, step}, state);
  };
  if (rows.order != SweepOrder::coloured)
    return rows.order == SweepOrder::symmetric && number % 2 == 1 ? turns(rows.size() - 1, -1, -1)
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

}  // namespace

template <int D>
SweepRows<D>::SweepRows(const LocalFrictionProblem& problem, SweepOrder sweep_order, Index seed) : order(sweep_order) {
  const Index contacts = problem.contacts();
  contact = order == SweepOrder::random ? shuffled(natural_order(contacts), static_cast<std::uint64_t>(seed))
                                        : natural_order(contacts);
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
  if (std::optional<BodyBlocks<D>> blocks = BodyBlocks<D>::of(problem, contact))
    w = std::move(*blocks);
  else
    w = ContactBlocks<D>(problem.w, contact);
  q = in_order(problem.q);
  friction = problem.friction(contact);
  for (const Index c : contact) {
    diagonal.push_back(diagonal_block<D>(problem, c));
    uncoupled.push_back(without_coupling(diagonal.back()));
  }
  if constexpr (D == 3)
    for (const FullDelassus<D>& block : diagonal) cones.emplace_back(block);
}

template <int D>
Vector SweepRows<D>::swept(const Vector& r, const SweepTurn& turn, double relaxation) const {
  SweepState state{.impulses = in_order(r), .velocities = {}};
  if (const auto* blocks = std::get_if<BodyBlocks<D>>(&w)) state.velocities = blocks->velocities(state.impulses);
  SweepState before = state;
  for (Index number = turn.first; number < turn.first + turn.many; ++number) {
    std::visit([&](const auto& coupling) { sweep(*this, coupling, relaxation, number, state); }, w);
    if (turn.momentum == 0) continue;
    move_on(state.impulses, before.impulses, turn.momentum);
    move_on(state.velocities, before.velocities, turn.momentum);
  }
  return by_contact(state.impulses);
}

template struct SweepRows<2>;
template struct SweepRows<3>;

}  // namespace nscdd
