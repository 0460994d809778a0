// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/solved_step.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

// The text of the process with the largest merit; of equal ones that with the lowest pair of bodies (a, b). Empty if no
// process has a text. A process without one has the merit -infinity.
std::optional<std::string> words_of_first(const Processes& all, double merit, const StepContact& contact,
                                          const std::string& words) {
  struct Claim {
    double merit;
    Index a, b;
  };
  const std::vector<Claim> claims = all.gather_each(Claim{merit, contact.a, contact.b});
  const auto first =
      std::ranges::min_element(claims, {}, [](const Claim& one) { return std::tuple(-one.merit, one.a, one.b); });
  if (first->merit == -infinity) return std::nullopt;
  const std::vector<char> text = all.gather(first - claims.begin() == all.rank ? words : std::string());
  return std::string(text.begin(), text.end());
}

}  // namespace

template <int D>
std::string describe_breakdown(const Simulation& before, const SolvedStep<D>& step) {
  const Processes& all = before.processes;
  const auto place = [](const auto& point) { return fmt::format("({:.6g}) m", fmt::join(point, ", ")); };
  const auto name = [&](const StepContact& c) {
    return fmt::format("contact of {} and {} at {}", body_name(before.system, c.a), body_name(before.system, c.b),
                       place(std::span(c.point).first(D)));
  };
  const auto impulse = [](const GrainContact<D>& c) { return std::hypot(c.impulse.n, norm(c.impulse.t)); };
  // The words about a contact of this process, if it has one.
  const auto said = [&](auto contact, double merit, const std::string& what) {
    if (contact == step.contacts.end()) return words_of_first(all, -infinity, {}, "");
    const StepContact& c = step.problem.geometry[at(contact - step.contacts.begin())];
    return words_of_first(all, merit, c, name(c) + what);
  };
  const auto wrong = std::ranges::find_if_not(
      step.contacts, [](double size) { return std::isfinite(size); }, impulse);
  if (const auto words = said(wrong, 1, ": the impulse is not finite")) return *words;
  for (std::size_t i = 0; i < step.all_grains.size(); ++i) {
    const Place centre = centre_of(before.state, i);
    if (!std::ranges::all_of(step.all_grains[i], [](double one) { return std::isfinite(one); }))
      return fmt::format("{} at {}: the velocity is not finite", body_name(before.system, static_cast<Index>(i)),
                         place(std::span(centre).first(D)));
  }
  const auto largest = std::ranges::max_element(step.contacts, {}, impulse);
  const double size = largest == step.contacts.end() ? -infinity : impulse(*largest);
  return said(largest, size, fmt::format(": largest impulse, {:.6g} N s", size)).value_or("no contact");
}

template std::string describe_breakdown(const Simulation&, const SolvedStep<2>&);
template std::string describe_breakdown(const Simulation&, const SolvedStep<3>&);

}  // namespace nscdd
