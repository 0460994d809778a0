// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Error bounds of a number or a gap, m.
struct Uncertainty {
  double certain = 0;  ///< a unit in the last place of its double or float, or the reader's bound
  double decimal = 0;  ///< half a unit of its last decimal digit, unless that is exact: "1.5"

  double largest() const { return std::max(certain, decimal); }
};

/// Precision of the numbers of a packing, inferred from them: six decimals reproduce numbers written by "%.6f", six
/// significant digits those by "%g". Numbers that need 17 digits have the precision of a double or a float.
struct Precision {
  /// Common decimals or significant digits; both if either fits numbers of one magnitude; neither for binary formats.
  struct Digits {
    std::optional<int> decimals, significant;
    bool single = false;  ///< the numbers are floats
  };
  Digits coordinates, radii;  ///< radii have no fewer
  double half_digit = 0;      ///< known to the reader, m; see Packing

  Uncertainty of(const Digits& digits, double value) const;  ///< error of a number of that value, m
  std::string text() const;  ///< "6 decimals", "7 significant digits", "single precision", "double precision"
};

/// Infers the precision, in O(1) for numbers of full length, else O(N). One number in twenty may have more digits.
Precision precision_of(const Packing& packing);

/// Error of the gap of a contact: the sum of the errors of its coordinates along the normal and of its radii.
Uncertainty gap_uncertainty(const Precision& precision, const Packing& packing, const Contact& contact);

/// Largest possible error of a gap of the packing, over its smallest radius.
double largest_uncertainty(const Precision& precision, const Packing& packing);

/// Numbers whose last digit is worth less than so many radii are certainly rounded: nobody writes so many by hand.
inline constexpr double surely_rounded = 1e-4;

/// Certain error of coordinates of those values along one axis, m.
double certain_offset(const Packing& packing, std::span<const double> coordinates);

/// Gaps up to so many radii may come from numbers that were rounded and then shifted or scaled, which no digit shows. A
/// note reports such pairs if they are more than a few, and more than a hundredth of the contacts.
inline constexpr double hairline = 1e-4;

/// Notes for the user about contacts that depend on rounding; empty if none does. `name`: of the packing.
std::vector<std::string> rounding_remarks(const ContactNetwork& network, const std::string& name);

}  // namespace nscdd
