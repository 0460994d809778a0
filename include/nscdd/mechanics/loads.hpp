// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>

#include <array>

namespace nscdd {

/// A load on a whole packing: every grain arrives with the velocity of a homogeneous deformation about the
/// centre of mass x_c,
///     V^-_i = D (x_i - x_c),   D = [ -compression_x  shear ; shear  -compression_y ],  1/s.
/// D symmetric is no restriction: a rotation opens and closes no contact. Nor does a uniform velocity or
/// acceleration (gravity): without walls the packing just moves. No net momentum is brought in.
struct Loads {
  std::array<double, 2> compression{0, 0};
  double shear = 0;

  bool none() const { return compression[0] == 0 && compression[1] == 0 && shear == 0; }

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("compression", self.compression,
          Field{.description = "rates of compression along x and y of the arriving velocities", .unit = "1/s"});
    visit("shear", self.shear, Field{.description = "rate of shear of the arriving velocities", .unit = "1/s"});
  }
};

}  // namespace nscdd
