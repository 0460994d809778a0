// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/core/types.hpp>
#include <nscdd/packing/packing.hpp>

#include <array>
#include <vector>

namespace nscdd {

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

/// Every contact of a packing, by a cell grid. Throws Error naming both grains of a pair that overlaps more
/// than allowed, or that shares one centre.
ContactNetwork detect_contacts(const Packing& packing, const ContactDetection& detection = {});

/// Number of contacts of each grain.
std::vector<Index> contact_counts(const ContactNetwork& network);

}  // namespace nscdd
