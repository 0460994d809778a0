// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/fixed_columns.hpp"

namespace nscdd {

/// A body of BODIES.DAT. The first one says the dimension. LMGC90 does not read the number of a body here: it counts.
DatboxBody read_datbox_body(FixedColumns& lines, Index& dimension, bool first);

/// RBDY2 or RBDY3.
const char* datbox_body_kind(Index dimension);

/// A number above 0.
double positive_number(const FixedColumns& lines, std::size_t first, std::string_view what);

/// Three numbers of a line, called such as coo1, coo2, coo3.
Eigen::Vector3d three_numbers(const FixedColumns& lines, const char* name, bool blank = false);

/// Half a unit of the seventh digit of a number in the notation of LMGC90, 0.1234567D+01.
double half_digit(double value);

/// Throws Error unless the axes of a body are askew by their seven digits at most.
void require_frame(const DatboxBody& body, const DatboxPlace& place);

}  // namespace nscdd
