// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/output_file.hpp"
#include "formats/vtk/step_picture.hpp"

namespace nscdd {

namespace hdf5 {
class File;
class Group;
}  // namespace hdf5

/// Throws Error unless the name ends in .vtkhdf or .hdf, by which ParaView tells such a file, and is no device.
void require_vtkhdf_name(const std::string& path);

/// Steps of a run in one VTKHDF file for ParaView: PolyData, version 2.0, temporal, one part per step, with the points,
/// cells and arrays of each StepPicture and the time as field data TimeValue too. Arrays of all steps lie one behind
/// the other, in compressed chunks, and `Steps` says where each begins. A step is written when it is appended, so that
/// memory holds one. The file grows as `path.partial` and takes its name with `finish`; without that it is removed.
/// Every function throws Error if the system refuses, if another run writes the same file, or for a step that has no
/// grains or other arrays than the first one.
class VtkhdfFile {
 public:
  VtkhdfFile(const std::string& path, bool force);
  ~VtkhdfFile();
  VtkhdfFile(const VtkhdfFile&) = delete;
  VtkhdfFile& operator=(const VtkhdfFile&) = delete;

  void append(const StepPicture& picture);
  void finish();

 private:
  /// What is written of one kind of cells: vertices, lines, polygons or strips.
  struct Written {
    std::int64_t cells = 0, ids = 0;
    std::int64_t skipped = 0;  ///< entries of Offsets that no step reads, see put_cells
  };
  void put_steps(const hdf5::Group& root, const StepPicture& picture);
  void put_cells(const hdf5::Group& root, const StepPicture& picture);

  OutputFile output_;
  std::unique_ptr<hdf5::File> file_;  // closed before the output takes its name
  std::int64_t steps_ = 0, points_ = 0;
  std::size_t chunk_ = 0;  // of arrays of points and cells
  std::array<Written, 4> kinds_;
};

}  // namespace nscdd
