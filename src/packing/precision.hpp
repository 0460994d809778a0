// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// How far a number may be off, or a gap, m.
struct Uncertainty {
  double certain = 0;  ///< by a unit in the last place of its double or float, or by what a reader knows
  double decimal = 0;  ///< by half a unit of its last decimal digit, unless that is exact: "1.5"

  double largest() const { return std::max(certain, decimal); }
};

/// How finely the numbers of a packing are written, as the numbers themselves tell. A program that prints "%.6f" or
/// rounds to six decimals leaves numbers that six decimals give back, one that prints "%g" six significant digits;
/// trailing zeros do not matter. Numbers that need 17 digits are what a double holds, or what a float holds.
struct Precision {
  /// What numbers have in common: decimals behind the point, significant digits, or where numbers of one magnitude do
  /// not tell which, both; neither where the digits are those of a binary format.
  struct Digits {
    std::optional<int> decimals, significant;
  };
  Digits coordinates, radii;                              ///< radii have no fewer
  bool single_coordinates = false, single_radii = false;  ///< the numbers are floats
  double half_digit = 0;                                  ///< that the reader knows, m; see Packing

  /// How far a coordinate or a radius of that value may be off, m.
  Uncertainty of_coordinate(double value) const;
  Uncertainty of_radius(double value) const;
  std::string text() const;  ///< "6 decimals", "7 significant digits", "single precision", "double precision"
};

/// In O(1) for numbers of full length, in O(N) for others. One number in twenty may have more digits than the others.
Precision precision_of(const Packing& packing);

/// How far the gap of a contact may be off: what its coordinates along the normal and its radii are off by, added up.
Uncertainty gap_uncertainty(const Precision& precision, const Packing& packing, const Contact& contact);

/// The largest uncertainty that a gap of the packing can have, over its smallest radius.
double largest_uncertainty(const Precision& precision, const Packing& packing);

/// Decimal digits worth less than so many radii are rounded for certain: nobody writes so many by hand.
inline constexpr double surely_rounded = 1e-4;

/// How far coordinates of those values, one of the coordinates of the packing, are off for certain, m.
double certain_offset(const Packing& packing, std::span<const double> coordinates);

/// Gaps up to so many radii are small enough to be rounding that no digit shows any more: of numbers that were rounded
/// and then shifted or scaled. Where they are more than a few (pairs, and a hundredth of the contacts), they are worth
/// a word.
inline constexpr double hairline = 1e-4;

/// Sentences about contacts that depend on rounding, for a user: none where no contact does. `name` is that of the
/// packing.
std::vector<std::string> rounding_remarks(const ContactNetwork& network, const std::string& name);

}  // namespace nscdd
