// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_body.hpp"

namespace nscdd {
namespace {

// The part of a line before a colon.
std::string_view before_colon(const FixedColumns& lines) {
  const std::string_view text = lines.line().substr(0, lines.line().find(':'));
  return text.substr(0, text.find_last_not_of(" \t") + 1);
}

// The three lines of a source point: a body, the distance that it must have gone before the next, and the point.
DatboxSource read_source(FixedColumns& lines, Index dimension) {
  DatboxSource source{.first = 1, .at = {}, .place = lines.place()};
  lines.require_next("the first body of a source point");
  const double first = lines.number_in(before_colon(lines), "the number of a body");
  if (!(first >= 1 && first < 1e9 && first == std::floor(first)))
    lines.refuse("expected the number of a body", before_colon(lines));
  source.first = static_cast<Index>(first);
  lines.require_next("the distance of a source point");
  source.at.distance = lines.number_in(before_colon(lines), "a distance");
  if (!(source.at.distance > 0)) lines.refuse("expected a distance > 0", before_colon(lines));
  lines.require_next("the coordinates of a source point");
  std::vector<std::string_view> words;
  for (const std::string_view word : split(before_colon(lines), ' '))
    if (!word.empty()) words.push_back(word);
  if (words.size() < at(dimension))
    lines.refuse(fmt::format("expected {} coordinates", dimension), before_colon(lines));
  for (std::size_t k = 0; k < at(dimension); ++k) source.at.point[k] = lines.number_in(words[k], "a coordinate");
  return source;
}

}  // namespace

DatboxCommand read_datbox_command(FixedColumns lines, Index dimension) {
  DatboxCommand command;
  const struct {
    std::string_view name;
    std::optional<double>* value;
    const char* key;  // of a case
  } keys[] = {{"TIME STEP", &command.step, "dynamics.step"},
              {"THETA", &command.theta, "dynamics.theta"},
              {dimension == 2 ? "PERIODIC CONDITION" : "XPERIODIC CONDITION", &command.period_x, "contacts.period_x"},
              {"YPERIODIC CONDITION", &command.period_y, "contacts.period_y"}};
  while (lines.next()) {
    const std::string_view key = before_colon(lines);
    if (!command.source && (key == "INIT SOURCE POINT" || key == "FD INIT SOURCE POINT")) {
      command.source = read_source(lines, dimension);
      continue;
    }
    const auto* const found = std::ranges::find(keys, key, [](const auto& one) { return one.name; });
    if (found == std::end(keys) || found->value->has_value()) continue;
    lines.require_next(fmt::format("the value of {}", found->name));
    const double value = lines.number_in(before_colon(lines), found->name);
    const bool theta = found->value == &command.theta;
    if (theta ? !(value >= 0.5 && value <= 1) : !(value > 0))
      lines.refuse(fmt::format("{}: expected a number {}", found->name, theta ? "in 0.5..1" : "> 0"),
                   before_colon(lines));
    *found->value = value;
    command.places[found->key] = fmt::format("{}:{}", lines.place().file, lines.place().line);
  }
  return command;
}

}  // namespace nscdd
