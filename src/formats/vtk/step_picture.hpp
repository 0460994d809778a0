// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/trajectory_step.hpp"

#include <variant>

/// A step of a trajectory as ParaView draws it, whatever the file format.
namespace nscdd {

/// Numbers of the points or cells of a picture, `components` for each.
struct PictureArray {
  const char* name = "";
  std::variant<std::vector<double>, std::vector<std::int64_t>> values;
  int components = 1;
};

/// Points are the grains, then one foot per wall contact (radius 0, id, boundary and subdomain -1). Cells are one
/// vertex per grain, then one line per contact from centre to centre or foot. All in SI units.
///   of points: radius, id, boundary (that drives the grain; -1: free), subdomain (the lowest whose contacts touch
///              the grain; -1: none), multiplicity (how many do), angle (in space turn, the quaternion w, x, y, z, and
///              spin, 3 components), velocity (3 components)
///   of cells:  kind (0 grain, 1 contact), subdomain, impulse_n, impulse_t (in space its size), gap (when contacts
///              were found), status (0 open, 1 stick, 2 slides forward, 3 slides backward, 4 slides in space; -1 for
///              a grain), and in a run that switches models what became of the subdomain of a contact (-1 for a grain)
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

/// The grains at the end of the step, and the contacts that led there. Throws Error if arrays differ in length or a
/// contact names no grain.
StepPicture picture_of(const GranularSystem& system, const TrajectoryStep& step);

/// first, first + step, ...: n numbers.
std::vector<std::int64_t> counted(std::size_t n, std::int64_t first, std::int64_t step);

}  // namespace nscdd
