// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/contact_colours.hpp"

#include <bit>

namespace nscdd {
namespace {

// The colours that are taken at each grain, 64 of them in a word.
class TakenColours {
 public:
  explicit TakenColours(const GranularSystem& system) : system_(system) {}

  Index take_least(Index a, Index b) {
    for (std::size_t word = 0;; ++word) {
      if (word == words_.size()) words_.emplace_back(at(system_.disks()), 0);
      const std::uint64_t taken = taken_at(a, word) | taken_at(b, word);
      const int least = std::countr_one(taken);
      if (least == 64) continue;
      for (const Index grain : {a, b})
        if (is_free(grain)) words_[word][at(grain)] |= std::uint64_t{1} << least;
      return 64 * static_cast<Index>(word) + least;
    }
  }

 private:
  bool is_free(Index body) const { return body < system_.disks() && system_.free(body); }
  std::uint64_t taken_at(Index body, std::size_t word) const { return is_free(body) ? words_[word][at(body)] : 0; }

  const GranularSystem& system_;
  std::vector<std::vector<std::uint64_t>> words_;
};

}  // namespace

template <int D>
ContactColours contact_colours(const Simulation& simulation, const StepProblem<D>& problem) {
  const auto ends_of = [](const StepContact& contact) { return std::pair(contact.a, contact.b); };
  const auto& own = problem.geometry;  // ascending
  ContactColours colours{std::vector<Index>(own.size()), 0};
  TakenColours taken(simulation.system);
  for_each_step_contact<D>(simulation.system, simulation.state, simulation.dynamics.interaction,
                           simulation.dynamics.time, [&](const StepContact& contact) {
                             const Index colour = taken.take_least(contact.a, contact.b);
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
