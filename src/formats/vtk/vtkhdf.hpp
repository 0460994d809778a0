// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/output_file.hpp"
#include "formats/vtk/vtk.hpp"

namespace nscdd {

namespace hdf5 {
class File;
class Group;
}  // namespace hdf5

/// ParaView tells the format by these.
inline constexpr std::array<std::string_view, 2> vtkhdf_endings{".vtkhdf", ".hdf"};

/// The pictures of steps in one VTKHDF file (docs/formats.md), written one at a time. The file grows as `path.partial`
/// and takes its name with `finish`; without that it is removed. Throws Error if the system refuses, if another run
/// writes the same file, and for a step without grains or with other arrays than the first one.
class VtkhdfFile {
 public:
  VtkhdfFile(const std::string& path, bool force);
  ~VtkhdfFile();

  void append(const StepPicture& picture);
  void finish();

 private:
  /// Numbers of written entries of one kind of cells: vertices, lines, polygons or strips.
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
