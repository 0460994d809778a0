// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/text.hpp"
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// Values of a sweep: a comma-separated list whose items are numbers ("1e-3", "inf") or ranges
///     FROM:TO:COUNT          logarithmic, FROM and TO > 0
///     FROM:TO:COUNT:linear
/// both ends included, COUNT >= 1 (1 only if FROM = TO), at most 10^6 values in all. Throws Error naming `what` and the
/// item that cannot be read. Never returns an empty list.
std::vector<double> parse_values(std::string_view spec, std::string_view what);

/// The values of a flexibility, in 1/kg or, with true, in multiples of the scale W of the packing (see Flexibility):
/// then a W follows every item ("0.1W,1:10:5 W") except 0 and inf.
using FlexibilityValues = std::pair<std::vector<double>, bool>;
FlexibilityValues parse_epsilon(std::string_view spec);  ///< finite, >= 0
FlexibilityValues parse_eta(std::string_view spec);      ///< > 0, inf allowed
/// The single value in 1/kg. `scale`: W. Throws Error naming `option` and its `text` if there are several.
double one_value(const FlexibilityValues& all, double scale, std::string_view option, std::string_view text);

/// The finite ends 0 < FROM < TO of a range FROM:TO without a count, for points that the program places; W as above.
/// None for other texts. Throws Error naming `name` for other ends.
std::optional<FlexibilityValues> parse_range(std::string_view spec, std::string_view name);
/// Relaxation: finite, > 0; "optimal" (an empty value here) is 2 / (lambda_min + lambda_max).
std::vector<std::optional<double>> parse_relaxation(std::string_view spec);
/// Gauss-Seidel sweeps of Stage 1: integers >= 1; "inf" (an empty value here) is an exact Stage 1.
std::vector<std::optional<long>> parse_sweeps(std::string_view spec);

/// A comma-separated list of names, without any twice. Throws Error naming `what`.
template <Named Enum>
std::vector<Enum> parse_names(std::string_view spec, std::string_view what) {
  std::vector<Enum> all;
  for (const std::string_view item : split(spec, ',')) {
    const Enum one = Choice<Enum>::parse(item, what);
    if (std::ranges::find(all, one) != all.end())
      throw Error(std::string(what), "expected each name once, met '" + std::string(item) + "' again");
    all.push_back(one);
  }
  return all;
}

}  // namespace nscdd
