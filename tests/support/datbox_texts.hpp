// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox.hpp"

/// Input of LMGC90 by hand, in the folders of tests/data/lmgc90.
namespace nscdd::testing {

/// A disk above a plank that lies askew, and a driven pair of disks about the point (10, 20), turned by a right angle.
DatboxTexts small_datbox();

/// A sphere in front of a plank whose third axis points to -x, and one that is driven.
DatboxTexts small_datbox_in_space();

/// A contact network: the input, with the state in DOF.INI, and Vloc_Rloc.
struct NetworkTexts {
  DatboxTexts datbox;
  std::string contacts;
};

/// A square of side 2 about (1, 1) with five corners, whose mass follows from its corners, over a plank that is driven,
/// and a triangle about (2, 3) that is driven along x and pushed along y.
NetworkTexts square_on_plank();

/// A box of 2 x 4 x 6 about (5, 6, 7), turned a quarter about z, on a plane that sinks.
NetworkTexts box_on_plane();

}  // namespace nscdd::testing
