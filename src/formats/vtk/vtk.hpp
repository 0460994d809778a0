// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/trajectory_step.hpp"

/// Pictures of steps for ParaView.
namespace nscdd {

/// Bytes of a .vtp file for ParaView (VTK XML PolyData, appended raw data of this machine's byte order) that shows
/// a step: the points, cells and arrays of its StepPicture, and the time as field data TimeValue. Throws Error as
/// picture_of does.
std::string vtp_text(const GranularSystem& system, const TrajectoryStep& step);

/// A .vtp file and the time it shows.
struct VtkFile {
  double time = 0;   ///< s
  std::string path;  ///< as seen from the .pvd file
};

/// Text of the .pvd collection that lists files by time.
std::string pvd_text(const std::vector<VtkFile>& files);

}  // namespace nscdd
