// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/fixed_columns.hpp"

namespace nscdd {

/// A body of BODIES.DAT. The first one says the dimension. LMGC90 does not read the number of a body here: it counts.
DatboxBody read_datbox_body(FixedColumns& lines, Index& dimension, bool first);

/// RBDY2 or RBDY3.
const char* datbox_body_kind(Index dimension);

/// The largest half of a unit of the seventh digit, in the notation of LMGC90, 0.1234567D+01, of coordinates.
double half_digit(const Eigen::Vector3d& place, Index dimension);

/// Throws Error unless the axes of a body are askew by their seven digits at most.
void require_frame(const DatboxBody& body, const DatboxPlace& place);

}  // namespace nscdd
