// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox.hpp"

/// Contact networks of LMGC90 by hand: the input, with the state in DOF.INI, and Vloc_Rloc.
namespace nscdd::testing {

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
