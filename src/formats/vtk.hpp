// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/trajectory.hpp"

#include <string>
#include <vector>

namespace nscdd {

/// Bytes of a .vtp file for ParaView (VTK XML PolyData, appended raw data of this machine's byte order) that shows
/// a step: the grains at its end, the contacts that led there. Points are the grains, then one foot per wall contact
/// (radius 0, id, boundary and subdomain -1). Cells, in the order VTK has them, are one vertex per grain, then one
/// line per contact from centre to centre or foot. All in SI units.
///   PointData: radius, id, boundary (that drives the grain; -1: free), subdomain (the lowest whose contacts touch
///              the grain; -1: none), multiplicity (how many do), angle, velocity (3 components)
///   CellData:  kind (0 grain, 1 contact), subdomain, impulse_n, impulse_t, gap (when contacts were found),
///              status (0 open, 1 stick, 2 slides forward, 3 slides backward; -1 for a grain)
/// The time is field data TimeValue. Throws Error if arrays differ in length or a contact names no grain.
std::string vtp_text(const GranularSystem& system, const TrajectoryStep& step);

/// A .vtp file and the time it shows.
struct VtkFile {
  double time = 0;   ///< s
  std::string path;  ///< as seen from the .pvd file
};

/// Text of the .pvd collection that lists files by time.
std::string pvd_text(const std::vector<VtkFile>& files);

}  // namespace nscdd
