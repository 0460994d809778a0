// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace nscdd {

struct GranularSystem;
struct Simulation;
struct SolvedStep;
struct TrajectoryStep;

/// A picture of one step for ParaView: arrays of one entry per grain and per contact, SI units.
struct VtkFrame {
  double time = 0;  ///< s

  struct Grains {
    std::vector<double> x, y, radius, angle;     ///< m, rad
    std::vector<double> velocity_x, velocity_y;  ///< m/s
    std::vector<std::int64_t> boundary;          ///< the one that drives the disk; -1: free
    std::vector<std::int64_t> subdomain;         ///< the lowest that holds it; -1: none, it touches nothing
    std::vector<std::int64_t> multiplicity;      ///< subdomains that hold it
  } grains;

  struct Contacts {
    std::vector<std::int64_t> a;               ///< a grain
    std::vector<std::int64_t> b;               ///< a grain, or -1: a wall
    std::vector<double> foot_x, foot_y;        ///< m, on the wall where b = -1; without meaning else
    std::vector<double> gap;                   ///< m, where contacts were found
    std::vector<double> impulse_n, impulse_t;  ///< N s
    std::vector<std::int64_t> status;          ///< 0 open, 1 stick, 2 slides forward, 3 slides backward
    std::vector<std::int64_t> subdomain;
  } contacts;
};

/// The grains where the state of the simulation has them and the contacts of a step solved from it: before
/// the step is taken or, with a copy kept, after (contacts then join the centres at the end of the step).
/// Grains driven by a boundary belong to no subdomain in particular: multiplicity counts those that touch
/// them.
VtkFrame vtk_frame(const Simulation& simulation, const SolvedStep& step);

/// A step of a trajectory: the grains at its end, the contacts that led there.
VtkFrame vtk_frame(const GranularSystem& system, const TrajectoryStep& step);

/// Bytes of a .vtp file (VTK XML PolyData, appended raw data of this machine's byte order). Points are the
/// grains, then one foot per wall contact (radius 0, id, boundary and subdomain -1). Cells, in the order VTK
/// has them, are one vertex per grain, then one line per contact from centre to centre or foot.
///   PointData: radius, id, boundary, subdomain, multiplicity, angle, velocity (3 components)
///   CellData:  kind (0 grain, 1 contact), subdomain, impulse_n, impulse_t, status (-1 for a grain), gap
/// The time is field data TimeValue. Throws Error if arrays differ in length or a contact names no grain.
std::string vtp_text(const VtkFrame& frame);

/// A .vtp file and the time it shows.
struct VtkFile {
  double time = 0;   ///< s
  std::string path;  ///< as seen from the .pvd file
};

/// Text of the .pvd collection that lists files by time.
std::string pvd_text(const std::vector<VtkFile>& files);

}  // namespace nscdd
