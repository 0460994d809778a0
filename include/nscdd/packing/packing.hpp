// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

namespace nscdd {

/// Disks in the plane, grain i at (x[i], y[i]).
struct Packing {
  std::vector<double> x, y;    ///< centres, m
  std::vector<double> radius;  ///< m
  std::vector<double> mass;    ///< kg; empty until masses are chosen

  Index size() const { return count(x); }
};

/// Throws Error naming the grain where a coordinate is not finite or a radius (or mass, where given) is not
/// finite and positive, and for a packing without grains.
void check(const Packing& packing);

/// How grains get their mass.
enum class MassModel {
  given,    ///< the masses the packing came with
  unit,     ///< 1 kg each
  density,  ///< surface density x pi radius^2
};
constexpr auto names_of(MassModel) { return std::to_array<std::string_view>({"given", "unit", "density"}); }

struct Masses {
  /// Left open: the masses the packing came with, or unit masses where it came with none.
  std::optional<MassModel> model;
  double density = 0;  ///< kg/m^2, for MassModel::density
};

/// The packing with its masses set. Throws Error where `given` is asked of a packing without masses.
Packing with_masses(Packing packing, const Masses& masses);

/// A pair of touching grains a < b.
struct Contact {
  Index a = 0, b = 0;
  std::array<double, 2> normal{};    ///< unit vector from the centre of a to the centre of b
  std::array<double, 2> midpoint{};  ///< of the two centres, m: what partitions distribute ([ADI12] section 2)
  double gap = 0;                    ///< m, negative for an overlap
};

/// Contacts sorted by (a, b).
struct ContactNetwork {
  std::vector<Contact> contacts;
  Index grains = 0;  ///< grains of the packing, those without a contact included

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

/// Every contact, by a cell grid. Throws Error naming both grains of a pair that overlaps too much or shares a centre.
ContactNetwork detect_contacts(const Packing& packing, const ContactDetection& detection = {});

/// Number of contacts of each grain.
std::vector<Index> contact_counts(const ContactNetwork& network);

}  // namespace nscdd
