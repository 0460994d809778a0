// SPDX-License-Identifier: GPL-3.0-or-later
// Any text is a list of values or an Error; what is returned keeps to the bounds of the quantity.
// The first character of an input chooses the parser, the rest is the SPEC.
#include "require.hpp"
#include "study/linear/values.hpp"
#include <nscdd/core/fields.hpp>

namespace {

using namespace nscdd;
using fuzzing::require;

constexpr std::size_t most_values = 1'000'000;

template <class Values>
void require_amount(const Values& values) {
  require(!values.empty(), "a SPEC has a value");
  require(values.size() <= most_values, "a SPEC has at most 10^6 values");
}

// A single FROM:TO:COUNT[:linear]: both ends exactly, COUNT values, none outside, none out of order.
void require_range(std::string_view spec, const std::vector<double>& values) {
  if (spec.find(',') != std::string_view::npos || spec.find(':') == std::string_view::npos) return;
  const auto first = spec.find(':'), second = spec.find(':', first + 1), third = spec.find(':', second + 1);
  const double from = parse_number(spec.substr(0, first), "from");
  const double to = parse_number(spec.substr(first + 1, second - first - 1), "to");
  const auto length = third == std::string_view::npos ? third : third - second - 1;
  require(count(values) == parse_integer(spec.substr(second + 1, length), "count"), "a range has COUNT values");
  require(values.front() == from && values.back() == to, "both ends of a range are met exactly");
  for (const double value : values)
    require(value >= std::min(from, to) && value <= std::max(from, to), "a range stays between its ends");
  require(from <= to ? std::is_sorted(values.begin(), values.end()) : std::is_sorted(values.rbegin(), values.rend()),
          "a range is monotone");
}

void values(std::string_view spec) {
  const auto all = parse_values(spec, "values");
  require_amount(all);
  require_range(spec, all);
}

void epsilon(std::string_view spec) {
  const auto all = parse_epsilon(spec).first;
  require_amount(all);
  for (const double value : all) require(std::isfinite(value) && value >= 0, "epsilon is finite and >= 0");
}

void eta(std::string_view spec) {
  const auto all = parse_eta(spec).first;
  require_amount(all);
  for (const double value : all) require(value > 0, "eta is > 0");
}

void relaxation(std::string_view spec) {
  const auto all = parse_relaxation(spec);
  require_amount(all);
  for (const auto& value : all)
    require(!value || (std::isfinite(*value) && *value > 0), "relaxation is finite and > 0");
}

void sweeps(std::string_view spec) {
  const auto all = parse_sweeps(spec);
  require_amount(all);
  for (const auto& value : all) require(!value || *value >= 1, "sweeps are >= 1");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr std::array parsers{values, epsilon, eta, relaxation, sweeps};
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    parsers[data[0] % parsers.size()](text.substr(1));
  } catch (const Error&) {
  }
  return 0;
}
