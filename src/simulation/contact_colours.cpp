// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/contact_colours.hpp"

#include "contact_solvers/contact_turns.hpp"

namespace nscdd {

template <int D>
ContactColours contact_colours(const Simulation& simulation, const StepProblem<D>& problem) {
  const auto ends_of = [](const StepContact& contact) { return std::pair(contact.a, contact.b); };
  const auto& own = problem.geometry;  // ascending
  ContactColours colours{std::vector<Index>(own.size()), 0};
  const GranularSystem& system = simulation.system;
  GreedyColours taken(system.grains());
  std::vector<Index> ends;
  for_each_step_contact(start_of(simulation), [&](const StepContact& contact) {
    ends.clear();
    for (const Index end : {contact.a, contact.b})
      if (end < system.grains() && system.free(end)) ends.push_back(end);
    const Index colour = taken.take_least(ends, ends);
    colours.number = std::max(colours.number, colour + 1);
    const auto found = std::ranges::lower_bound(own, ends_of(contact), {}, ends_of);
    if (found != own.end() && ends_of(*found) == ends_of(contact))
      colours.of_contact[static_cast<std::size_t>(found - own.begin())] = colour;
  });
  return colours;
}

template ContactColours contact_colours(const Simulation&, const StepProblem<2>&);
template ContactColours contact_colours(const Simulation&, const StepProblem<3>&);

}  // namespace nscdd
