// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/trajectory_step.hpp"

#include <variant>

/// Pictures of the steps of a trajectory for ParaView.
namespace nscdd {

/// Numbers of the points or cells of a picture, `components` for each.
struct PictureArray {
  const char* name = "";
  std::variant<std::vector<double>, std::vector<std::int64_t>> values;
  std::size_t components = 1;
};

/// Points are the grains, then a foot per wall contact (radius 0, id, boundary and subdomain -1). Cells are a vertex
/// per grain, then a line per contact from centre to centre or foot. SI units. docs/formats.md lists the arrays.
struct StepPicture {
  double time = 0;                     ///< s
  std::vector<double> points;          ///< three coordinates each, m
  std::vector<std::int64_t> vertices;  ///< the point of each vertex: 0, 1, ...
  std::vector<std::int64_t> lines;     ///< the two points of each line
  std::vector<PictureArray> point_arrays;
  std::vector<PictureArray> cell_arrays;

  std::size_t point_count() const { return points.size() / 3; }
  std::size_t line_count() const { return lines.size() / 2; }
};

/// The arrays that a viewer shows first.
inline constexpr const char *shown_of_points = "radius", *shown_vectors = "velocity", *shown_of_cells = "impulse_n";

/// The grains at the end of the step, and its contacts. Throws Error for arrays of other lengths and unknown grains.
StepPicture picture_of(const GranularSystem& system, const TrajectoryStep& step);

/// first, first + step, ...: n numbers.
std::vector<std::int64_t> counted(std::size_t n, std::int64_t first, std::int64_t step);

/// Bytes of a .vtp file (VTK XML PolyData, appended raw data in the byte order of this machine): the picture of a step,
/// with the time as field data TimeValue. Throws Error as picture_of.
std::string vtp_text(const GranularSystem& system, const TrajectoryStep& step);

/// A .vtp file and the time it shows.
struct VtkFile {
  double time = 0;   ///< s
  std::string path;  ///< relative to the .pvd file
};

/// Text of the .pvd collection that lists files by time.
std::string pvd_text(const std::vector<VtkFile>& files);

}  // namespace nscdd
