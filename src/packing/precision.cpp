// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/precision.hpp"

#include <fmt/format.h>

#include <charconv>

namespace nscdd {
namespace {

// A decimal number: how many significant digits it has, and the power of ten of the first.
struct Decimal {
  int digits = 0, exponent = 0;
  int behind_point() const { return digits - 1 - exponent; }
};

// Parses a text such as "8.66025e-01", without trailing zeros.
Decimal decimal_of(std::string_view text) {
  const std::size_t e = text.find('e');
  std::string_view mantissa = text.substr(text.front() == '-' ? 1 : 0, e - (text.front() == '-' ? 1 : 0));
  while (mantissa.size() > 1 && (mantissa.back() == '0' || mantissa.back() == '.')) mantissa.remove_suffix(1);
  Decimal decimal{.digits = static_cast<int>(mantissa.size()) - (mantissa.find('.') == mantissa.npos ? 0 : 1)};
  const char* first = text.data() + e + (text[e + 1] == '+' ? 2 : 1);
  std::from_chars(first, text.data() + text.size(), decimal.exponent);
  return decimal;
}

template <class... Arguments>
Decimal printed(Arguments... arguments) {
  std::array<char, 40> text{};
  const auto [end, status] = std::to_chars(text.data(), text.data() + text.size(), arguments...);
  return decimal_of({text.data(), end});
}

// The fewest digits that reproduce the double, or its float.
Decimal shortest(double value) { return printed(value, std::chars_format::scientific); }
Decimal shortest_of_float(double value) { return printed(static_cast<float>(value), std::chars_format::scientific); }
// A change of units or a shift leaves noise of a few units in the last place; 15 digits hide it.
Decimal without_noise(double value) { return printed(value, std::chars_format::scientific, 14); }

bool is_float(double value) { return static_cast<double>(static_cast<float>(value)) == value; }

using Digits = Decimal (*)(double);

// Common digits of many numbers.
struct Tally {
  int significant = 0, behind_point = -1000;  // the largest counts
  Index at_significant = 0, at_point = 0;     // numbers with these counts
  Index numbers = 0, longer = 0;              // nonzero numbers; those with too many digits

  void add(const Decimal& decimal, int longest) {
    ++numbers;
    if (decimal.digits > longest) {
      ++longer;
      return;
    }
    const auto count_most = [](int value, int& most, Index& times) {
      if (value > most) most = value, times = 0;
      times += value == most;
    };
    count_most(decimal.digits, significant, at_significant);
    count_most(decimal.behind_point(), behind_point, at_point);
  }
  bool too_long() const { return 20 * longer > numbers; }
};

// Of the coordinates, every `step`th of them.
Tally tally_of(const Packing& packing, Digits digits, int longest, std::size_t step) {
  Tally tally;
  for (const auto* values : {&packing.x, &packing.y, &packing.z})
    for (std::size_t i = 0; i < values->size(); i += step)
      if ((*values)[i] != 0) tally.add(digits((*values)[i]), longest);
  return tally;
}

std::optional<Precision> decimal_precision(const Packing& packing, Digits digits, int longest) {
  constexpr std::size_t sampled_grains = 100;  // to recognise numbers of full length
  if (tally_of(packing, digits, longest, packing.x.size() / sampled_grains + 1).too_long()) return std::nullopt;
  const Tally tally = tally_of(packing, digits, longest, 1);
  if (tally.too_long()) return std::nullopt;
  // Fixed decimals: numbers with the most significant digits have all decimals; fixed digits: the other way round.
  Precision precision;
  if (tally.at_point >= tally.at_significant) precision.coordinates.decimals = std::max(0, tally.behind_point);
  if (tally.at_point <= tally.at_significant) precision.coordinates.significant = std::max(1, tally.significant);
  precision.radii = precision.coordinates;
  for (const double radius : packing.radius) {
    const Decimal own = digits(radius);
    if (auto& decimals = precision.radii.decimals) decimals = std::max(*decimals, own.behind_point());
    if (auto& significant = precision.radii.significant) significant = std::max(*significant, own.digits);
  }
  return precision;
}

// Whether the numbers are floats: all are representable, and at least one needs fewer digits as a float.
bool were_floats(const Packing& packing) {
  bool longer = false;
  for (const auto* values : {&packing.x, &packing.y, &packing.z})
    for (const double value : *values) {
      if (!is_float(value)) return false;
      longer = longer || shortest(value).digits > shortest_of_float(value).digits;
    }
  return longer;
}

Precision from_numbers(const Packing& packing) {
  if (were_floats(packing)) {
    Precision precision = decimal_precision(packing, shortest_of_float, 7).value_or(Precision{});
    precision.coordinates.single = true;
    precision.radii.single = std::ranges::all_of(packing.radius, is_float);
    return precision;
  }
  if (const auto found = decimal_precision(packing, shortest, 15)) return *found;
  if (const auto found = decimal_precision(packing, without_noise, 14)) return *found;
  return decimal_precision(packing, shortest, 16).value_or(Precision{});
}

// One or two units in the last place: the arithmetic behind a number has rounded, too.
double unit_of(double value, bool single) {
  return std::abs(value) *
         (single ? double{std::numeric_limits<float>::epsilon()} : std::numeric_limits<double>::epsilon());
}

// Half a unit of the last digit; 0 for a number with more digits than the others.
double half_unit(const Precision::Digits& digits, double value) {
  double unit = digits.decimals ? std::pow(10.0, -*digits.decimals) : 0;
  if (digits.significant && value != 0)
    unit = std::max(unit, std::pow(10.0, std::floor(std::log10(std::abs(value))) - *digits.significant + 1));
  if (unit == 0) return 0;
  const double noise = 0.01 * unit + 2 * unit_of(value, digits.single);  // from a change of units
  return std::abs(value - unit * std::round(value / unit)) > noise ? 0 : 0.5 * unit;
}

// "0 and 8, 1 and 9, ...".
std::string named(const PairSample& pairs) {
  std::string text;
  for (const auto& [a, b] : pairs.first) text += fmt::format("{}{} and {}", text.empty() ? "" : ", ", a, b);
  return text + (pairs.size > count(pairs.first) ? ", ..." : "");
}

std::string pairs_of(const PairSample& pairs) {
  return fmt::format("{} pair{} of grains ({})", pairs.size, pairs.size == 1 ? "" : "s", named(pairs));
}

}  // namespace

Uncertainty Precision::of(const Digits& digits, double value) const {
  return {std::max(half_digit, unit_of(value, digits.single)), half_unit(digits, value)};
}

std::string Precision::text() const {
  const auto counted = [](int digits, const char* what) {
    return fmt::format("{} {}{}", digits, what, digits == 1 ? "" : "s");
  };
  if (half_digit > 0) return fmt::format("an error of up to {:.1g} m in their file", half_digit);
  if (coordinates.decimals) return counted(*coordinates.decimals, "decimal");
  if (coordinates.significant) return counted(*coordinates.significant, "significant digit");
  return coordinates.single ? "single precision" : "double precision";
}

Precision precision_of(const Packing& packing) {
  Precision precision = from_numbers(packing);
  precision.half_digit = packing.half_digit;
  return precision;
}

Uncertainty gap_uncertainty(const Precision& precision, const Packing& packing, const Contact& contact) {
  Uncertainty sum;
  const auto add = [&](double weight, const Uncertainty& one) {
    sum.certain += weight * one.certain;
    sum.decimal += weight * (one.decimal + one.certain);
  };
  constexpr double curvature = 1.02;  // the normal is rounded, too
  for (const Index grain : {contact.a, contact.b}) {
    const std::array<double, 3> centre = packing.centre(grain);
    for (std::size_t k = 0; k < at(packing.dimension()); ++k)
      add(curvature * std::abs(contact.normal[k]), precision.of(precision.coordinates, centre[k]));
    add(curvature, precision.of(precision.radii, packing.radius[at(grain)]));
  }
  return sum;
}

double largest_uncertainty(const Precision& precision, const Packing& packing) {
  double coordinates = 0;
  for (const auto* values : {&packing.x, &packing.y, &packing.z})
    if (!values->empty()) {
      const auto [low, high] = std::ranges::minmax(*values);
      coordinates += 2 * precision.of(precision.coordinates, std::max(std::abs(low), std::abs(high))).largest();
    }
  const auto [smallest, largest] = std::ranges::minmax(packing.radius);
  return 1.02 * (coordinates + 2 * precision.of(precision.radii, largest).largest()) / smallest;
}

double certain_offset(const Packing& packing, std::span<const double> coordinates) {
  const Precision precision = precision_of(packing);
  Uncertainty largest;
  const auto [low, high] = std::ranges::minmax(coordinates);
  for (const double value : {low, high}) {
    const Uncertainty one = precision.of(precision.coordinates, value);
    largest = {std::max(largest.certain, one.certain), std::max(largest.decimal, one.decimal)};
  }
  const bool rounded = largest.decimal > 0 && largest.decimal <= surely_rounded * std::ranges::min(packing.radius);
  return rounded ? largest.largest() : largest.certain;
}

std::vector<std::string> rounding_remarks(const ContactNetwork& network, const std::string& name) {
  const RoundingDoubt& doubt = network.rounding;
  const std::string worth =
      fmt::format("coordinates with {} resolve gaps to {:.2g} of the smaller radius", doubt.digits, doubt.uncertainty);
  const char* apart = doubt.open.size == 1 ? "is" : "are";
  std::vector<std::string> remarks;
  if (doubt.decided.size > 0)
    remarks.push_back(fmt::format(
        "{}: {}: {} of {} contacts have a gap or an overlap of that size, beyond the tolerances (grains {})", name,
        worth, doubt.decided.size, network.size(), named(doubt.decided)));
  if (!doubt.used && doubt.open.size > 0)
    remarks.push_back(
        fmt::format("{}{}: {}: {} {} apart by less and count{} as apart: no overlap shows rounding; if numbers were "
                    "rounded, --tolerance {:.1g} (contacts.tolerance) makes contacts of them",
                    doubt.ambiguous() ? "warning: " : "", name, worth, pairs_of(doubt.open), apart,
                    doubt.open.size == 1 ? "s" : "", 1.5 * doubt.uncertainty));
  else if (doubt.ambiguous())
    remarks.push_back(
        fmt::format("warning: {}: the contacts are ambiguous: {}, and {} are apart by at most three times this "
                    "uncertainty: which grains touch depends on digits that are missing; write more digits, or state "
                    "contacts.tolerance (--tolerance)",
                    name, worth, pairs_of(doubt.open)));
  else if (doubt.open.size > 0)
    remarks.push_back(fmt::format("{}: {}: {} {} apart by at most three times this uncertainty and count{} as apart",
                                  name, worth, pairs_of(doubt.open), apart, doubt.open.size == 1 ? "s" : ""));
  if (doubt.one_sided.size > 0) {
    const bool overlaps = doubt.overlap > ContactDetection{}.overlap_tolerance;
    const double apart_by = std::max(doubt.overlap, hairline);
    remarks.push_back(fmt::format(
        "warning: {}: {} are apart by at most {:.2g} of the smaller radius and do not touch{}; if coordinates were "
        "rounded, --tolerance {:.1g} (contacts.tolerance) makes contacts of them{}",
        name, pairs_of(doubt.one_sided), apart_by,
        overlaps ? fmt::format(", although others overlap by up to {:.2g}", doubt.overlap) : "",
        std::min(1.0, apart_by > hairline ? 1.5 * apart_by : hairline),
        overlaps ? ": raise it together with --overlap-tolerance (contacts.overlap_tolerance)" : ""));
  }
  return remarks;
}

}  // namespace nscdd
