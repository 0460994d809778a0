// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/values.hpp"

#include "core/fail.hpp"

namespace nscdd {
namespace {

constexpr std::size_t most_values = 1'000'000;

// Points of one range, both ends exact.
std::vector<double> range(std::string_view item, const std::vector<std::string_view>& parts, std::string_view what) {
  const bool linear = parts.size() == 4 && parts[3] == "linear";
  const bool logarithmic = parts.size() == 3 || (parts.size() == 4 && parts[3] == "log");
  if (!linear && !logarithmic) fail("{}: expected FROM:TO:COUNT or FROM:TO:COUNT:linear, met '{}'", what, item);
  const double from = parse_number(parts[0], what), to = parse_number(parts[1], what);
  const Index points = parse_integer(parts[2], what);
  if (!std::isfinite(from) || !std::isfinite(to)) fail("{}: expected finite ends of a range, met '{}'", what, item);
  if (logarithmic && (from <= 0 || to <= 0))
    fail("{}: expected ends > 0 of a logarithmic range (or :linear), met '{}'", what, item);
  if (points < 1 || points > static_cast<Index>(most_values) || (points == 1 && from != to))
    fail("{}: expected a count from 2 to {} in '{}', or 1 if both ends are equal, met {}", what, most_values, item,
         points);
  std::vector<double> values;
  for (Index i = 0; i < points; ++i) {
    const double t = points == 1 ? 0.0 : static_cast<double>(i) / static_cast<double>(points - 1);
    const double value =
        linear ? std::lerp(from, to, t) : std::pow(10.0, std::lerp(std::log10(from), std::log10(to), t));
    values.push_back(std::clamp(value, std::min(from, to), std::max(from, to)));  // if rounding leaves the range
  }
  values.front() = from;
  values.back() = to;
  return values;
}

void require(const std::vector<double>& values, std::string_view what, std::string_view expected,
             bool (*check)(double)) {
  for (const double value : values)
    if (!check(value)) fail("{}: expected {}, met {}", what, expected, value);
}

void append(auto& all, const std::vector<double>& more, std::string_view what) {
  all.insert(all.end(), more.begin(), more.end());
  if (all.size() > most_values) fail("{}: expected at most {} values, met more", what, most_values);
}

// Removes a W at the end, and the blanks around the rest. Returns whether there was one.
bool take_unit(std::string_view& text) {
  text = trimmed(text);
  const bool relative = text.ends_with('W');
  text = trimmed(text.substr(0, text.size() - (relative ? 1 : 0)));
  return relative;
}

FlexibilityValues flexibilities(std::string_view spec, std::string_view name, std::string_view expected,
                                bool (*check)(double)) {
  std::vector<double> all;
  bool absolute = false, multiples = false;
  for (std::string_view item : split(spec, ',')) {
    const bool relative = take_unit(item);
    if (item.empty() && relative) fail("{}: expected a number before W such as 10W, met '{}'", name, spec);
    const std::vector<double> values = parse_values(item, name);
    for (const double value : values) absolute |= !relative && value != 0 && std::isfinite(value);
    multiples |= relative;
    append(all, values, name);
  }
  require(all, name, expected, check);
  if (multiples && absolute) fail("{}: expected a W after every number or after none, met '{}'", name, spec);
  return {all, multiples};
}

}  // namespace

std::vector<double> parse_values(std::string_view spec, std::string_view what) {
  std::vector<double> values;
  for (const std::string_view item : split(spec, ',')) {
    const auto parts = split(item, ':');
    append(values, parts.size() == 1 ? std::vector{parse_number(item, what)} : range(item, parts, what), what);
  }
  return values;
}

FlexibilityValues parse_epsilon(std::string_view spec) {
  return flexibilities(spec, "epsilon", "a finite number >= 0", [](double v) { return std::isfinite(v) && v >= 0; });
}

FlexibilityValues parse_eta(std::string_view spec) {
  return flexibilities(spec, "eta", "a number > 0 (or inf for the generic algorithm)", [](double v) { return v > 0; });
}

double one_value(const FlexibilityValues& all, double scale, std::string_view option, std::string_view text) {
  const auto& [values, relative] = all;
  if (values.size() != 1) fail("{}: expected one number, met '{}'", option, text);
  return relative ? values.front() * scale : values.front();
}

std::optional<FlexibilityValues> parse_range(std::string_view spec, std::string_view name) {
  std::string_view text = spec;
  const bool relative = take_unit(text);
  const auto parts = split(text, ':');
  if (parts.size() != 2 || text.find(',') != std::string_view::npos) return std::nullopt;
  const double from = parse_number(parts[0], name), to = parse_number(parts[1], name);
  if (!(from > 0 && from < to && std::isfinite(to)))
    fail("{}: expected finite ends 0 < FROM < TO of a range FROM:TO, met '{}'", name, spec);
  return FlexibilityValues{{from, to}, relative};
}

std::vector<std::optional<double>> parse_relaxation(std::string_view spec) {
  std::vector<std::optional<double>> all;
  for (const std::string_view item : split(spec, ',')) {
    if (item == "optimal") {
      all.emplace_back(std::nullopt);
      continue;
    }
    const auto values = parse_values(item, "relaxation");
    require(values, "relaxation", "a finite number > 0 (or 'optimal')",
            [](double v) { return std::isfinite(v) && v > 0; });
    append(all, values, "relaxation");
  }
  return all;
}

std::vector<std::optional<long>> parse_sweeps(std::string_view spec) {
  std::vector<std::optional<long>> all;
  const auto values = parse_values(spec, "gauss_seidel_sweeps");
  require(values, "gauss_seidel_sweeps", "an integer >= 1 (or inf for an exact Stage 1)",
          [](double v) { return v == infinity || (v >= 1 && v <= 1e9 && v == std::floor(v)); });
  for (const double v : values) all.push_back(v == infinity ? std::nullopt : std::optional(static_cast<long>(v)));
  return all;
}

}  // namespace nscdd
