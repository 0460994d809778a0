// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/vtk.hpp"

#include "formats/trajectory.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <type_traits>

namespace nscdd {
namespace {

constexpr std::string_view byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

template <class Value>
constexpr std::string_view type_name() {
  static_assert(std::is_same_v<Value, double> || std::is_same_v<Value, std::int64_t>);
  return std::is_same_v<Value, double> ? "Float64" : "Int64";
}

// The XML part and the appended bytes grow together, because the element of an array says where its bytes
// lie.
class Writer {
 public:
  void line(std::string_view text) { xml_ += fmt::format("{}\n", text); }

  template <class Value>
  void array(std::string_view name, const std::vector<Value>& values, int components = 1) {
    line(fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)",
                     type_name<Value>(), name, components, appended_.size()));
    const std::uint64_t bytes = values.size() * sizeof(Value);
    append(&bytes, sizeof bytes);
    append(values.data(), bytes);
  }

  std::string text() && {
    xml_ += "<AppendedData encoding=\"raw\">\n_";
    return std::move(xml_) + std::move(appended_) + "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  void append(const void* data, std::size_t bytes) {
    if (bytes > 0) appended_.append(static_cast<const char*>(data), bytes);
  }
  std::string xml_, appended_;
};

template <class Value>
void require_length(const std::vector<Value>& values, std::size_t expected, std::string_view name) {
  if (values.size() != expected)
    throw Error(fmt::format("VTK frame: expected {} values of {}, met {}", expected, name, values.size()));
}

void check(const VtkFrame& frame) {
  const auto& grains = frame.grains;
  const std::size_t n = grains.x.size();
  require_length(grains.y, n, "y");
  require_length(grains.radius, n, "radius");
  require_length(grains.angle, n, "angle");
  require_length(grains.velocity_x, n, "velocity_x");
  require_length(grains.velocity_y, n, "velocity_y");
  require_length(grains.boundary, n, "boundary");
  require_length(grains.subdomain, n, "subdomain");
  require_length(grains.multiplicity, n, "multiplicity");
  const auto& contacts = frame.contacts;
  const std::size_t c = contacts.a.size();
  require_length(contacts.b, c, "b");
  require_length(contacts.foot_x, c, "foot_x");
  require_length(contacts.foot_y, c, "foot_y");
  require_length(contacts.gap, c, "gap");
  require_length(contacts.impulse_n, c, "impulse_n");
  require_length(contacts.impulse_t, c, "impulse_t");
  require_length(contacts.status, c, "status");
  require_length(contacts.subdomain, c, "subdomain of contacts");
  const auto grain = [n](std::int64_t i) { return i >= 0 && i < static_cast<std::int64_t>(n); };
  for (std::size_t k = 0; k < c; ++k)
    if (!grain(contacts.a[k]) || (contacts.b[k] != -1 && !grain(contacts.b[k])))
      throw Error(fmt::format("VTK frame: contact {}: expected two of {} grains, or a grain and -1, met {} and {}", k,
                              n, contacts.a[k], contacts.b[k]));
}

// The values of grains, followed by `value` for each foot or contact.
template <class Value>
std::vector<Value> followed_by(std::vector<Value> values, std::size_t times, Value value) {
  values.insert(values.end(), times, value);
  return values;
}

// `value` for each grain, followed by the values of contacts.
template <class Value>
std::vector<Value> preceded_by(std::size_t times, Value value, const std::vector<Value>& values) {
  std::vector<Value> result(times, value);
  result.insert(result.end(), values.begin(), values.end());
  return result;
}

std::vector<std::int64_t> counted(std::size_t n, std::int64_t first, std::int64_t step) {
  std::vector<std::int64_t> result(n);
  for (std::size_t i = 0; i < n; ++i) result[i] = first + step * static_cast<std::int64_t>(i);
  return result;
}

std::size_t count_feet(const VtkFrame& frame) {
  return static_cast<std::size_t>(std::count(frame.contacts.b.begin(), frame.contacts.b.end(), -1));
}

void write_points(Writer& writer, const VtkFrame& frame) {
  const auto& grains = frame.grains;
  const auto& contacts = frame.contacts;
  const std::size_t n = grains.x.size(), feet = count_feet(frame);
  std::vector<double> points, velocity;
  for (std::size_t i = 0; i < n; ++i) {
    points.insert(points.end(), {grains.x[i], grains.y[i], 0.0});
    velocity.insert(velocity.end(), {grains.velocity_x[i], grains.velocity_y[i], 0.0});
  }
  for (std::size_t k = 0; k < contacts.a.size(); ++k)
    if (contacts.b[k] == -1) points.insert(points.end(), {contacts.foot_x[k], contacts.foot_y[k], 0.0});
  velocity.resize(points.size(), 0.0);
  constexpr std::int64_t none = -1;
  writer.line(R"(<PointData Scalars="radius" Vectors="velocity">)");
  writer.array("radius", followed_by(grains.radius, feet, 0.0));
  writer.array("id", followed_by(counted(n, 0, 1), feet, none));
  writer.array("boundary", followed_by(grains.boundary, feet, none));
  writer.array("subdomain", followed_by(grains.subdomain, feet, none));
  writer.array("multiplicity", followed_by(grains.multiplicity, feet, std::int64_t{0}));
  writer.array("angle", followed_by(grains.angle, feet, 0.0));
  writer.array("velocity", velocity, 3);
  writer.line("</PointData>");
  writer.line("<Points>");
  writer.array("Points", points, 3);
  writer.line("</Points>");
}

void write_cells(Writer& writer, const VtkFrame& frame) {
  const auto& contacts = frame.contacts;
  const std::size_t n = frame.grains.x.size(), c = contacts.a.size();
  std::vector<std::int64_t> ends;
  auto foot = static_cast<std::int64_t>(n);
  for (std::size_t k = 0; k < c; ++k)
    ends.insert(ends.end(), {contacts.a[k], contacts.b[k] == -1 ? foot++ : contacts.b[k]});
  writer.line("<CellData Scalars=\"impulse_n\">");
  writer.array("kind", preceded_by(n, std::int64_t{0}, std::vector<std::int64_t>(c, 1)));
  std::vector<std::int64_t> subdomain = frame.grains.subdomain;
  subdomain.insert(subdomain.end(), contacts.subdomain.begin(), contacts.subdomain.end());
  writer.array("subdomain", subdomain);
  writer.array("impulse_n", preceded_by(n, 0.0, contacts.impulse_n));
  writer.array("impulse_t", preceded_by(n, 0.0, contacts.impulse_t));
  writer.array("status", preceded_by(n, std::int64_t{-1}, contacts.status));
  writer.array("gap", preceded_by(n, 0.0, contacts.gap));
  writer.line("</CellData>");
  writer.line("<Verts>");
  writer.array("connectivity", counted(n, 0, 1));
  writer.array("offsets", counted(n, 1, 1));
  writer.line("</Verts>");
  writer.line("<Lines>");
  writer.array("connectivity", ends);
  writer.array("offsets", counted(c, 2, 2));
  writer.line("</Lines>");
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

void fill_contacts(VtkFrame& frame, const TrajectoryStep& step, Index disks) {
  auto& contacts = frame.contacts;
  for (const TrajectoryContact& contact : step.contacts) {
    const StepContact& geometry = contact.geometry;
    const bool on_wall = geometry.b >= disks;
    contacts.a.push_back(geometry.a);
    contacts.b.push_back(on_wall ? -1 : geometry.b);
    contacts.foot_x.push_back(on_wall ? geometry.point[0] : 0.0);
    contacts.foot_y.push_back(on_wall ? geometry.point[1] : 0.0);
    contacts.gap.push_back(geometry.gap);
    contacts.impulse_n.push_back(contact.impulse.n);
    contacts.impulse_t.push_back(contact.impulse.t);
    contacts.status.push_back(static_cast<std::int64_t>(contact.status));
    contacts.subdomain.push_back(contact.subdomain);
  }
}

// The subdomains that hold a grain are those of its contacts.
void fill_subdomains(VtkFrame& frame, const std::vector<double>& radius) {
  std::vector<std::vector<std::int64_t>> held(radius.size());
  const auto& contacts = frame.contacts;
  for (std::size_t k = 0; k < contacts.a.size(); ++k)
    for (const std::int64_t i : {contacts.a[k], contacts.b[k]}) {
      if (i < 0) continue;
      auto& of_grain = held[static_cast<std::size_t>(i)];
      if (std::find(of_grain.begin(), of_grain.end(), contacts.subdomain[k]) == of_grain.end())
        of_grain.push_back(contacts.subdomain[k]);
    }
  for (const auto& of_grain : held) {
    frame.grains.multiplicity.push_back(static_cast<std::int64_t>(of_grain.size()));
    frame.grains.subdomain.push_back(of_grain.empty() ? -1 : *std::min_element(of_grain.begin(), of_grain.end()));
  }
}

}  // namespace

VtkFrame vtk_frame(const GranularSystem& system, const TrajectoryStep& step) {
  const GranularState& state = step.state;
  VtkFrame frame;
  frame.time = state.time;
  frame.grains.x = state.x;
  frame.grains.y = state.y;
  frame.grains.radius = system.radius;
  frame.grains.angle = state.angle;
  frame.grains.velocity_x = state.velocity_x;
  frame.grains.velocity_y = state.velocity_y;
  frame.grains.boundary.assign(system.driven_by.begin(), system.driven_by.end());
  fill_contacts(frame, step, system.disks());
  fill_subdomains(frame, system.radius);
  return frame;
}

VtkFrame vtk_frame(const Simulation& simulation, const SolvedStep& step) {
  return vtk_frame(simulation.system, trajectory_step(simulation, step));
}

std::string vtp_text(const VtkFrame& frame) {
  check(frame);
  const std::size_t n = frame.grains.x.size();
  Writer writer;
  writer.line(R"(<?xml version="1.0"?>)");
  writer.line(
      fmt::format(R"(<VTKFile type="PolyData" version="1.0" byte_order="{}" header_type="UInt64">)", byte_order));
  writer.line("<PolyData>");
  writer.line("<FieldData>");
  writer.line(fmt::format(
      R"(<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{}</DataArray>)", frame.time));
  writer.line("</FieldData>");
  writer.line(fmt::format(
      R"(<Piece NumberOfPoints="{}" NumberOfVerts="{}" NumberOfLines="{}" NumberOfStrips="0" NumberOfPolys="0">)",
      n + count_feet(frame), n, frame.contacts.a.size()));
  write_points(writer, frame);
  write_cells(writer, frame);
  writer.line("</Piece>");
  writer.line("</PolyData>");
  return std::move(writer).text();
}

std::string pvd_text(const std::vector<VtkFile>& files) {
  std::string text = fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"{}\">\n<Collection>\n",
      byte_order);
  for (const VtkFile& file : files)
    text +=
        fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", file.time, escaped(file.path));
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace nscdd
