// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

namespace nscdd {

/// Grains: disks at (x[i], y[i]), or spheres at (x[i], y[i], z[i]). A packing with z is in space.
struct Packing {
  std::vector<double> x, y;    ///< centres, m
  std::vector<double> radius;  ///< m
  std::vector<double> mass;    ///< kg; empty until masses are chosen
  std::vector<double> z = {};  ///< of centres, m; empty in the plane
  /// Half of the last digit of the coordinates, m, if the reader knows it; 0: inferred from the numbers, see Precision.
  double half_digit = 0;
  /// Number of the clump of a grain, a rigid body of all grains with that number; -1: none. Empty: there are no clumps.
  std::vector<Index> clump = {};

  Index size() const { return count(x); }
  Index dimension() const { return z.empty() ? 2 : 3; }
  /// The centre of a grain, its third coordinate 0 in the plane, m.
  std::array<double, 3> centre(Index grain) const { return {x[at(grain)], y[at(grain)], z.empty() ? 0 : z[at(grain)]}; }
};

/// Throws Error for a packing without grains or with z or clumps for some grains only, and, naming the grain, for a
/// coordinate that is not finite, and a radius or given mass that is not finite and positive.
void check(const Packing& packing);

/// Model of the masses of grains.
enum class MassModel {
  given,    ///< the packing's own masses
  unit,     ///< 1 kg each
  density,  ///< density x volume: pi radius^2 of a disk, 4/3 pi radius^3 of a sphere
};
constexpr auto names_of(MassModel) { return std::to_array<std::string_view>({"given", "unit", "density"}); }

struct Masses {
  /// Empty: the packing's own masses, or unit masses if it has none.
  std::optional<MassModel> model;
  double density = 0;  ///< for MassModel::density: kg/m^2 in the plane, kg/m^3 in space

  static void fields(auto& self, auto&& visit) {
    visit("density", self.density, Field{.description = "surface density", .unit = "kg/m^2", .above = 0});
  }
};

/// The packing with its masses set. Throws Error for `given` and a packing without masses.
Packing with_masses(Packing packing, const Masses& masses);

/// A pair of touching grains.
struct Contact {
  Index a = 0, b = 0;                ///< a < b
  std::array<double, 3> normal{};    ///< unit vector from the centre of a to the centre of b; z = 0 in the plane
  std::array<double, 3> midpoint{};  ///< of the two centres, m: what partitions distribute ([ADI12] section 2)
  double gap = 0;                    ///< m, negative for an overlap
};

/// The number of some pairs of grains a < b, and the first few by (a, b).
struct PairSample {
  Index size = 0;
  std::vector<std::array<Index, 2>> first = {};
};

/// Contacts in doubt because coordinates are rounded. The digits of a packing bound the error of its gaps
/// (packing/precision.hpp); tolerances of gaps and overlaps are never below this bound.
struct RoundingDoubt {
  std::string digits;      ///< of the coordinates: "6 decimals", "7 significant digits", "single precision", ...
  double uncertainty = 0;  ///< largest uncertainty of the gaps of near pairs, times the smaller radius
  bool used = true;        ///< false: so few digits may be exact, and the tolerances of the detection decide
  PairSample decided;      ///< contacts beyond the tolerances of the detection, within the uncertainty
  /// Pairs that do not touch, although the gap is at most three times the uncertainty (once if it is not used).
  PairSample open;
  PairSample one_sided;  ///< pairs that do not touch, although others overlap by more than their gap
  double overlap = 0;    ///< largest overlap, times the smaller radius

  bool ambiguous() const { return open.size > 3; }  ///< more than a few contacts depend on missing digits
};

/// A cell that repeats itself along x and y: 0 <= x < x-period, 0 <= y < y-period.
struct Period {
  double x = 0, y = 0;  ///< m; 0: it does not repeat

  bool any() const { return x > 0 || y > 0; }
  /// The shortest of the vectors that differ from one by periods, m.
  std::array<double, 3> shortest(std::array<double, 3> d) const {
    if (x > 0) d[0] -= x * std::round(d[0] / x);
    if (y > 0) d[1] -= y * std::round(d[1] / y);
    return d;
  }
  /// The steps, multiples of periods, from a place to its image in the cell, m.
  std::array<double, 3> into_cell(const std::array<double, 3>& p) const {
    return {x > 0 ? -x * std::floor(p[0] / x) : 0, y > 0 ? -y * std::floor(p[1] / y) : 0, 0};
  }
};

/// The contact network of a packing, sorted by (a, b).
struct ContactNetwork {
  std::vector<Contact> contacts;
  Index grains = 0;     ///< of the packing, including those without contacts
  Index dimension = 2;  ///< of the packing
  RoundingDoubt rounding = {};
  Period period = {};  ///< of the cell in which contacts were found

  Index size() const { return count(contacts); }
};

struct ContactDetection {
  double tolerance = 1e-7;            ///< a pair touches where gap <= tolerance x the smaller radius
  double overlap_tolerance = 1e-7;    ///< an overlap deeper than this x the smaller radius is an error
  double period_x = 0, period_y = 0;  ///< of a cell that repeats itself, m, see Period

  Period period() const { return {period_x, period_y}; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("tolerance", self.tolerance,
          Field{.description = "largest gap of a contact, times the smaller radius", .minimum = 0, .maximum = 1});
    visit("overlap_tolerance", self.overlap_tolerance,
          Field{.description = "largest overlap accepted, times the smaller radius", .minimum = 0, .maximum = 1});
    visit("period_x", self.period_x,
          Field{.description = "length along x of a cell that repeats itself, 0 for none", .unit = "m", .minimum = 0});
    visit("period_y", self.period_y,
          Field{.description = "length along y of a cell that repeats itself, 0 for none", .unit = "m", .minimum = 0});
  }
};

/// Throws Error with the key of a period that is not longer than two diameters of the largest grain, and the gap of
/// `reach` radii across which grains still touch: no grain touches another one twice.
void check(const Period& period, const std::vector<double>& radius, double reach = 0);

/// Detects all contacts by a cell grid, in O(N), in a periodic cell also across its ends. Coordinates rounded more
/// coarsely than the tolerances raise them, see RoundingDoubt. Throws Error naming both grains of a pair that overlaps
/// too much or shares a centre, for tolerances and periods out of their bounds, and for clumps.
ContactNetwork detect_contacts(const Packing& packing, const ContactDetection& detection = {});

/// Number of contacts of each grain.
std::vector<Index> contact_counts(const ContactNetwork& network);

}  // namespace nscdd
