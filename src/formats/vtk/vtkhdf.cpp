// SPDX-License-Identifier: GPL-3.0-or-later
// Layout: "VTKHDF format specification" of VTK, sections "Poly data" and "Temporal data".
#include "formats/vtk/vtkhdf.hpp"

#include "core/fail.hpp"
#include "files/hdf5_file.hpp"

namespace nscdd {
namespace {

using hdf5::Group;
using Integers = std::vector<std::int64_t>;

// All four are required, even if empty, in this order.
constexpr std::array<const char*, 4> kinds{"Vertices", "Lines", "Polygons", "Strips"};

// A step has thousands of numbers in an array of points or cells, and one or four in an array of `Steps`.
constexpr std::size_t short_chunk = 256, smallest_chunk = 1024, largest_chunk = 65536;

// `components` > 1: to a two-dimensional array.
template <class Value>
void append(const Group& group, const char* name, const std::vector<Value>& values, std::size_t chunk,
            std::size_t components = 1) {
  hdf5::ArrayForm form{.chunk = chunk * components, .append = true, .compressed = true};
  if (components > 1) form.rows = values.size() / components;
  group.put<Value>(name, values, form);
}

template <class Value>
void append_one(const Group& group, const char* name, Value value) {
  group.put<Value>(name, std::span<const Value>(&value, 1), {.chunk = short_chunk, .append = true});
}

void append_row(const Group& group, const char* name, const Integers& row) {
  group.put<std::int64_t>(name, row, {.chunk = short_chunk * row.size(), .append = true, .rows = 1});
}

// Appends the offsets of the arrays of the step.
void put_array_offsets(const Group& offsets, const std::vector<PictureArray>& arrays, std::int64_t begin, bool first) {
  if (!first && offsets.members().size() != arrays.size())
    fail("{}: expected the {} arrays of the first step, met {}", offsets.path(), offsets.members().size(),
         arrays.size());
  for (const PictureArray& array : arrays) append_one(offsets, array.name, begin);
}

void put_arrays(const Group& group, const std::vector<PictureArray>& arrays, std::size_t chunk) {
  for (const PictureArray& array : arrays)
    std::visit([&](const auto& values) { append(group, array.name, values, chunk, array.components); }, array.values);
}

}  // namespace

VtkhdfFile::VtkhdfFile(const std::string& path, bool force) : output_(path, force) {
  const std::string growing = partial_path(path).string();
  file_ = std::make_unique<hdf5::File>(growing, hdf5::Access::fill, fmt::format("{}: cannot be written", growing));
  const Group root = file_->root().make_group("VTKHDF");
  root.put_attribute("Version", Integers{2, 0});
  root.put_attribute("Type", "PolyData", H5T_CSET_ASCII);
  const Group points = root.make_group("PointData");
  points.put_attribute("Scalars", shown_of_points, H5T_CSET_ASCII);
  points.put_attribute("Vectors", shown_vectors, H5T_CSET_ASCII);
  root.make_group("CellData").put_attribute("Scalars", shown_of_cells, H5T_CSET_ASCII);
}

VtkhdfFile::~VtkhdfFile() = default;

// Must be called before the other data of the step are written: it stores their offsets.
void VtkhdfFile::put_steps(const Group& root, const StepPicture& picture) {
  const Group steps = root.make_group("Steps");
  append_one(steps, "Values", picture.time);
  append_one(steps, "PartOffsets", steps_);
  append_one(steps, "NumberOfParts", std::int64_t{1});
  append_one(steps, "PointOffsets", points_);
  Integers cells, ids;
  std::int64_t all_cells = 0;
  for (const Written& kind : kinds_) {
    cells.push_back(kind.cells + kind.skipped);
    ids.push_back(kind.ids);
    all_cells += kind.cells;
  }
  append_row(steps, "CellOffsets", cells);
  append_row(steps, "ConnectivityIdOffsets", ids);
  const bool first = steps_ == 0;
  put_array_offsets(steps.make_group("PointDataOffsets"), picture.point_arrays, points_, first);
  put_array_offsets(steps.make_group("CellDataOffsets"), picture.cell_arrays, all_cells, first);
  append_one(steps.make_group("FieldDataOffsets"), "TimeValue", steps_);
}

// One unused entry in Offsets, counted in CellOffsets from the first step without cells on, makes all readers of VTK
// agree where a step begins (docs/formats.md).
void VtkhdfFile::put_cells(const Group& root, const StepPicture& picture) {
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const Group group = root.make_group(kinds[k]);
    const Integers ids = k == 0 ? picture.vertices : k == 1 ? picture.lines : Integers{};
    const std::int64_t each = k == 1 ? 2 : 1;
    const std::int64_t cells = count(ids) / each;
    Written& written = kinds_[k];
    append_one(group, "NumberOfCells", cells);
    append_one(group, "NumberOfConnectivityIds", std::int64_t{count(ids)});
    nscdd::append(group, "Connectivity", ids, chunk_);
    nscdd::append(group, "Offsets", counted(static_cast<std::size_t>(cells) + 1, 0, each), chunk_);
    if (cells == 0 && written.skipped == 0) {
      nscdd::append(group, "Offsets", Integers{0}, chunk_);
      written.skipped = 1;
    }
    written.cells += cells;
    written.ids += count(ids);
  }
}

void VtkhdfFile::append(const StepPicture& picture) {
  if (picture.points.empty()) fail("VTKHDF: expected a step with grains, met none");
  if (steps_ == 0) chunk_ = std::clamp(picture.point_count(), smallest_chunk, largest_chunk);
  const Group root = file_->root().group("VTKHDF");
  const auto points = static_cast<std::int64_t>(picture.point_count());
  put_steps(root, picture);
  append_one(root, "NumberOfPoints", points);
  nscdd::append(root, "Points", picture.points, chunk_, 3);
  put_cells(root, picture);
  put_arrays(root.group("PointData"), picture.point_arrays, chunk_);
  put_arrays(root.group("CellData"), picture.cell_arrays, chunk_);
  append_one(root.make_group("FieldData"), "TimeValue", picture.time);
  points_ += points;
  ++steps_;
}

void VtkhdfFile::finish() {
  file_->root().group("VTKHDF").make_group("Steps").put_attribute("NSteps", steps_);
  file_->flush();
  file_.reset();
  output_.finish();
}

}  // namespace nscdd
