// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/datbox.hpp"

/// Input of LMGC90 by hand.
namespace nscdd::testing {

/// A disk above a plank that lies askew, and a driven pair of disks about the point (10, 20), turned by a right angle.
DatboxTexts small_datbox();

/// A sphere in front of a plank whose third axis points to -x, and one that is driven.
DatboxTexts small_datbox_in_space();

}  // namespace nscdd::testing
