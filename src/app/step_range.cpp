// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/step_range.hpp"

#include "core/fail.hpp"
#include "core/text.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "study/linear/values.hpp"

namespace nscdd::app {

StepRange parse_step_range(const std::string& text) {
  if (text.empty()) return {};
  std::vector<Index> numbers;
  for (const std::string_view number : split(text, ':')) numbers.push_back(parse_integer(number, "--steps"));
  const StepRange range{numbers[0], numbers.size() > 1 ? numbers[1] : numbers[0], numbers.size() > 2 ? numbers[2] : 1};
  if (numbers.size() > 3 || range.first < 0 || range.last < range.first || range.stride < 1)
    fail("--steps: expected A, A:B or A:B:K with 0 <= A <= B and K >= 1, met '{}'", text);
  return range;
}

std::string step_ranges_text(const std::vector<Index>& steps) {
  std::string text;
  for (std::size_t i = 0; i < steps.size();) {
    // A range ends where the distance of neighbours changes. Two steps are no range.
    std::size_t last = i;
    while (last + 1 < steps.size() && steps[last + 1] - steps[last] == steps[i + 1] - steps[i]) ++last;
    if (last < i + 2) last = i;
    text += fmt::format("{}{}", text.empty() ? "" : ", ", steps[i]);
    if (last > i) text += fmt::format(":{}", steps[last]);
    if (last > i && steps[i + 1] - steps[i] > 1) text += fmt::format(":{}", steps[i + 1] - steps[i]);
    i = last + 1;
  }
  return text;
}

std::vector<Index> chosen_steps(const std::string& trajectory, const StepRange& range) {
  const std::vector<Index> kept = trajectory_steps(trajectory);
  std::vector<Index> steps;
  std::ranges::copy_if(kept, std::back_inserter(steps), [&](Index step) { return range.holds(step); });
  if (steps.empty())
    fail("--steps: expected a range with some of the steps that {} keeps ({}), met none", trajectory,
         step_ranges_text(kept));
  return steps;
}

}  // namespace nscdd::app
