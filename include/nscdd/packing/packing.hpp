// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

namespace nscdd {

/// Disks in the plane, grain i at (x[i], y[i]), or spheres in space, grain i at (x[i], y[i], z[i]). What has a z is in
/// space: the dimension is a property of the packing, never an option.
struct Packing {
  std::vector<double> x, y;    ///< centres, m
  std::vector<double> radius;  ///< m
  std::vector<double> mass;    ///< kg; empty until masses are chosen
  std::vector<double> z = {};  ///< of centres, m; empty in the plane
  /// Half of the last digit of the coordinates, m, where a reader knows it; 0: their numbers tell, see Precision.
  double half_digit = 0;

  Index size() const { return count(x); }
  Index dimension() const { return z.empty() ? 2 : 3; }
  /// The centre of a grain, its third coordinate 0 in the plane, m.
  std::array<double, 3> centre(Index grain) const { return {x[at(grain)], y[at(grain)], z.empty() ? 0 : z[at(grain)]}; }
};

/// Throws Error naming the grain where a coordinate is not finite or a radius (or mass, where given) is not
/// finite and positive, for a packing without grains, and for one that has a z for some of its grains alone.
void check(const Packing& packing);

/// How grains get their mass.
enum class MassModel {
  given,    ///< the masses the packing came with
  unit,     ///< 1 kg each
  density,  ///< density x volume: pi radius^2 of a disk, 4/3 pi radius^3 of a sphere
};
constexpr auto names_of(MassModel) { return std::to_array<std::string_view>({"given", "unit", "density"}); }

struct Masses {
  /// Left open: the masses the packing came with, or unit masses where it came with none.
  std::optional<MassModel> model;
  double density = 0;  ///< for MassModel::density: kg/m^2 in the plane, kg/m^3 in space
};

/// The packing with its masses set. Throws Error where `given` is asked of a packing without masses.
Packing with_masses(Packing packing, const Masses& masses);

/// A pair of touching grains a < b.
struct Contact {
  Index a = 0, b = 0;
  std::array<double, 3> normal{};    ///< unit vector from the centre of a to the centre of b; z = 0 in the plane
  std::array<double, 3> midpoint{};  ///< of the two centres, m: what partitions distribute ([ADI12] section 2)
  double gap = 0;                    ///< m, negative for an overlap
};

/// Pairs of grains a < b: how many there are, and the first few of them by (a, b).
struct PairSample {
  Index size = 0;
  std::vector<std::array<Index, 2>> first = {};
};

/// What the rounding of coordinates leaves open about contacts. The digits of a packing say how far its gaps may be off
/// (packing/precision.hpp); that is the least tolerance of gaps and of overlaps.
struct RoundingDoubt {
  std::string digits;      ///< those of the coordinates: "6 decimals", "7 significant digits", "single precision", ...
  double uncertainty = 0;  ///< of the gaps of near pairs, times the smaller radius: the largest one
  bool used = true;        ///< false: digits so few may be exact, and the tolerances of the detection decide
  PairSample decided;      ///< contacts beyond the tolerances of the detection, within the uncertainty
  /// Pairs that do not touch, although the gap is at most three times the uncertainty (once if it is not used).
  PairSample open;
  PairSample one_sided;  ///< pairs that do not touch, although others overlap by more than their gap
  double overlap = 0;    ///< of two grains, the largest one, times the smaller radius

  /// More than a few contacts depend on digits that are not there.
  bool ambiguous() const { return open.size > 3; }
};

/// Contacts sorted by (a, b).
struct ContactNetwork {
  std::vector<Contact> contacts;
  Index grains = 0;     ///< grains of the packing, those without a contact included
  Index dimension = 2;  ///< of the packing
  RoundingDoubt rounding = {};

  Index size() const { return count(contacts); }
};

struct ContactDetection {
  double tolerance = 1e-7;          ///< a pair touches where gap <= tolerance x the smaller radius
  double overlap_tolerance = 1e-7;  ///< an overlap deeper than this x the smaller radius is an error

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("tolerance", self.tolerance,
          Field{.description = "largest gap of a contact, times the smaller radius", .minimum = 0, .maximum = 1});
    visit("overlap_tolerance", self.overlap_tolerance,
          Field{.description = "largest overlap accepted, times the smaller radius", .minimum = 0, .maximum = 1});
  }
};

/// Every contact, by a cell grid. Coordinates that are rounded more coarsely than the tolerances raise these, see
/// RoundingDoubt. Throws Error naming both grains of a pair that overlaps too much or shares a centre.
ContactNetwork detect_contacts(const Packing& packing, const ContactDetection& detection = {});

/// Number of contacts of each grain.
std::vector<Index> contact_counts(const ContactNetwork& network);

}  // namespace nscdd
