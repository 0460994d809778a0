// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_body.hpp"

namespace nscdd {

DatboxCommand read_datbox_command(FixedColumns lines, Index dimension) {
  DatboxCommand command;
  const std::pair<std::string_view, std::optional<double>*> keys[] = {
      {"TIME STEP", &command.step},
      {"THETA", &command.theta},
      {dimension == 2 ? "PERIODIC CONDITION" : "XPERIODIC CONDITION", &command.period_x},
      {"YPERIODIC CONDITION", &command.period_y}};
  while (lines.next()) {
    const auto before_colon = [&] {
      const std::string_view text = lines.line().substr(0, lines.line().find(':'));
      return text.substr(0, text.find_last_not_of(" \t") + 1);
    };
    const std::string_view key = before_colon();
    const auto* const found = std::ranges::find(keys, key, [](const auto& one) { return one.first; });
    if (found == std::end(keys) || found->second->has_value()) continue;
    lines.require_next(fmt::format("the value of {}", found->first));
    const double value = lines.number_in(before_colon(), found->first);
    const bool theta = found->second == &command.theta;
    if (theta ? !(value >= 0.5 && value <= 1) : !(value > 0))
      lines.refuse(fmt::format("{}: expected a number {}", found->first, theta ? "in 0.5..1" : "> 0"),
                   std::string(before_colon()));
    *found->second = value;
  }
  return command;
}

}  // namespace nscdd
