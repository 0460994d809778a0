// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/lmgc90/fixed_columns.hpp"

namespace nscdd {

/// A body of BODIES.DAT. The first one sets the dimension. Its number is not read: LMGC90 counts bodies.
DatboxBody read_datbox_body(FixedColumns& lines, Index& dimension, bool first);

/// Sets weight and inertia as LMGC90 counts them, each contactor whole.
void weigh(DatboxContactor& one, bool space);

/// Computes, as LMGC90 does, the centre of a body (in the plane only if its node is at 0), and radii and inertia that
/// are 0 in BODIES.DAT. The inertia of a cylinder is its own, also where the file has another.
void complete(DatboxBody& body, Index dimension);

/// Reads the vertices (and faces) behind the line of a contactor POLYG, or in space POLYR, and weighs it. A polyhedron
/// is the union of the tetrahedra from the mean of its vertices to its faces, of any orientation; polygons are
/// counter-clockwise.
void read_solid(FixedColumns& lines, bool space, DatboxContactor& contactor);

/// RBDY2 or RBDY3.
const char* datbox_body_kind(Index dimension);

/// Half of a unit in the seventh digit of the largest coordinate, as LMGC90 writes it: 0.1234567D+01.
double half_digit(const Eigen::Vector3d& place, Index dimension);

/// The axes of a body in space at the beginning, as columns; x, y and z do not replace principal axes that are
/// computed. Throws Error unless they are orthonormal to seven digits.
void set_axes(DatboxBody& body, const Eigen::Matrix3d& axes, const DatboxPlace& place);

/// Reads the keys of a command file that a case has, too.
DatboxCommand read_datbox_command(FixedColumns lines, Index dimension);

}  // namespace nscdd
