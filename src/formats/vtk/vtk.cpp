// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/vtk/vtk.hpp"

#include "formats/vtk/step_picture.hpp"

#include <fmt/format.h>

#include <bit>

namespace nscdd {
namespace {

constexpr std::string_view byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

// The XML part and the appended bytes grow together, because the element of an array says where its bytes lie.
class Writer {
 public:
  void line(std::string_view text) { xml_ += fmt::format("{}\n", text); }

  template <class Value>
  void array(std::string_view name, const std::vector<Value>& values, int components = 1) {
    static_assert(std::is_same_v<Value, double> || std::is_same_v<Value, std::int64_t>);
    line(fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)",
                     std::is_same_v<Value, double> ? "Float64" : "Int64", name, components, appended_.size()));
    const std::uint64_t bytes = values.size() * sizeof(Value);
    appended_.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    if (bytes > 0) appended_.append(reinterpret_cast<const char*>(values.data()), bytes);
  }

  void arrays(const std::vector<PictureArray>& all) {
    for (const PictureArray& one : all)
      std::visit([&](const auto& values) { array(one.name, values, one.components); }, one.values);
  }

  std::string text() && {
    xml_ += "<AppendedData encoding=\"raw\">\n_";
    return std::move(xml_) + std::move(appended_) + "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  std::string xml_, appended_;
};

void write_points(Writer& writer, const StepPicture& picture) {
  writer.line(fmt::format(R"(<PointData Scalars="{}" Vectors="{}">)", shown_of_points, shown_vectors));
  writer.arrays(picture.point_arrays);
  writer.line("</PointData>\n<Points>");
  writer.array("Points", picture.points, 3);
  writer.line("</Points>");
}

void write_cells(Writer& writer, const StepPicture& picture) {
  writer.line(fmt::format(R"(<CellData Scalars="{}">)", shown_of_cells));
  writer.arrays(picture.cell_arrays);
  writer.line("</CellData>\n<Verts>");
  writer.array("connectivity", picture.vertices);
  writer.array("offsets", counted(picture.vertices.size(), 1, 1));
  writer.line("</Verts>\n<Lines>");
  writer.array("connectivity", picture.lines);
  writer.array("offsets", counted(picture.line_count(), 2, 2));
  writer.line("</Lines>");
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

}  // namespace

std::string vtp_text(const GranularSystem& system, const TrajectoryStep& step) {
  const StepPicture picture = picture_of(system, step);
  Writer writer;
  writer.line(fmt::format(R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="{}" header_type="UInt64">
<PolyData>
<FieldData>
<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{}</DataArray>
</FieldData>
<Piece NumberOfPoints="{}" NumberOfVerts="{}" NumberOfLines="{}" NumberOfStrips="0" NumberOfPolys="0">)",
                          byte_order, picture.time, picture.point_count(), picture.vertices.size(),
                          picture.line_count()));
  write_points(writer, picture);
  write_cells(writer, picture);
  writer.line("</Piece>\n</PolyData>");
  return std::move(writer).text();
}

std::string pvd_text(const std::vector<VtkFile>& files) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"{}\">\n<Collection>\n",
      byte_order);
  for (const VtkFile& file : files)
    text +=
        fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", file.time, escaped(file.path));
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace nscdd
