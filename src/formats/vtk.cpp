// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "formats/export.hpp"

#include <bit>
#include <set>
#include <type_traits>

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

  std::string text() && {
    xml_ += "<AppendedData encoding=\"raw\">\n_";
    return std::move(xml_) + std::move(appended_) + "\n</AppendedData>\n</VTKFile>\n";
  }

 private:
  std::string xml_, appended_;
};

using Integers = std::vector<std::int64_t>;

// A step as it is drawn. A contact is on a wall if its second body is no grain.
struct Picture {
  const GranularSystem& system;
  const GranularState& state;
  const std::vector<TrajectoryContact>& contacts;
  std::size_t grains = state.x.size();
  std::size_t feet = at(std::ranges::count_if(contacts, [&](const auto& c) { return on_wall(c); }));

  bool on_wall(const TrajectoryContact& contact) const { return contact.geometry.b >= system.disks(); }
};

void check(const Picture& picture) {
  const auto& [system, state, contacts, n, feet] = picture;
  for (const auto& [name, size] : {std::pair("radius", system.radius.size()),
                                   {"driven_by", system.driven_by.size()},
                                   {"y", state.y.size()},
                                   {"angle", state.angle.size()},
                                   {"velocity_x", state.velocity_x.size()},
                                   {"velocity_y", state.velocity_y.size()}})
    if (size != n) fail("VTK: expected {} values of {}, met {}", n, name, size);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (const auto& [a, b] = std::pair(contacts[k].geometry.a, contacts[k].geometry.b);
        a < 0 || a >= system.disks() || b < 0)
      fail("VTK: contact {}: expected two of {} grains, or a grain and a wall, met {} and {}", k, n, a, b);
}

// The values of grains, followed by `value` for each foot.
template <class Value>
std::vector<Value> with_feet(const Picture& picture, std::vector<Value> values, Value value) {
  values.resize(values.size() + picture.feet, value);
  return values;
}

// The values of grains, followed by what `get` finds in each contact.
template <class Value, class Get>
std::vector<Value> with_contacts(const Picture& picture, std::vector<Value> values, Get get) {
  for (const TrajectoryContact& contact : picture.contacts)
    values.push_back(static_cast<Value>(std::invoke(get, contact)));
  return values;
}

Integers counted(std::size_t n, std::int64_t first, std::int64_t step) {
  Integers result(n);
  for (std::size_t i = 0; i < n; ++i) result[i] = first + step * static_cast<std::int64_t>(i);
  return result;
}

// The subdomains that hold each grain are those of its contacts.
std::vector<std::set<Index>> holders(const Picture& picture) {
  std::vector<std::set<Index>> held(picture.grains);
  for (const TrajectoryContact& contact : picture.contacts) {
    held[at(contact.geometry.a)].insert(contact.subdomain);
    if (!picture.on_wall(contact)) held[at(contact.geometry.b)].insert(contact.subdomain);
  }
  return held;
}

void write_points(Writer& writer, const Picture& picture, const Integers& subdomain, const Integers& multiplicity) {
  const GranularState& state = picture.state;
  std::vector<double> points, velocity;
  for (std::size_t i = 0; i < picture.grains; ++i) {
    points.insert(points.end(), {state.x[i], state.y[i], 0.0});
    velocity.insert(velocity.end(), {state.velocity_x[i], state.velocity_y[i], 0.0});
  }
  for (const TrajectoryContact& c : picture.contacts)
    if (picture.on_wall(c)) points.insert(points.end(), {c.geometry.point[0], c.geometry.point[1], 0.0});
  velocity.resize(points.size(), 0.0);
  constexpr std::int64_t none = -1, no_subdomain = 0;
  const auto& driven_by = picture.system.driven_by;
  writer.line(R"(<PointData Scalars="radius" Vectors="velocity">)");
  writer.array("radius", with_feet(picture, picture.system.radius, 0.0));
  writer.array("id", with_feet(picture, counted(picture.grains, 0, 1), none));
  writer.array("boundary", with_feet(picture, Integers(driven_by.begin(), driven_by.end()), none));
  writer.array("subdomain", with_feet(picture, subdomain, none));
  writer.array("multiplicity", with_feet(picture, multiplicity, no_subdomain));
  writer.array("angle", with_feet(picture, state.angle, 0.0));
  writer.array("velocity", velocity, 3);
  writer.line("</PointData>\n<Points>");
  writer.array("Points", points, 3);
  writer.line("</Points>");
}

// Of each contact what its subdomain was in this step; -1 for grains.
void write_models(Writer& writer, const Picture& picture) {
  const auto of = [&](auto RememberedModel::*value) {
    return [&picture, value](const TrajectoryContact& c) { return picture.state.models[at(c.subdomain)].*value; };
  };
  const Integers none(picture.grains, -1);
  const std::vector<double> unknown(picture.grains, -1.0);
  writer.array("switched", with_contacts(picture, none, of(&RememberedModel::switched)));
  writer.array("switched_iterations", with_contacts(picture, none, of(&RememberedModel::switched_iterations)));
  writer.array("switch_backs", with_contacts(picture, none, of(&RememberedModel::switch_backs)));
  writer.array("velocity_distance", with_contacts(picture, unknown, of(&RememberedModel::velocity_distance)));
  writer.array("impulse_distance", with_contacts(picture, unknown, of(&RememberedModel::impulse_distance)));
}

void write_cells(Writer& writer, const Picture& picture, const Integers& subdomain) {
  const std::size_t n = picture.grains;
  const std::vector<double> zero(n);
  Integers ends;
  auto foot = static_cast<std::int64_t>(n);
  for (const TrajectoryContact& c : picture.contacts)
    ends.insert(ends.end(), {c.geometry.a, picture.on_wall(c) ? foot++ : c.geometry.b});
  writer.line(R"(<CellData Scalars="impulse_n">)");
  writer.array("kind", with_contacts(picture, Integers(n, 0), [](const auto&) { return 1; }));
  writer.array("subdomain", with_contacts(picture, subdomain, &TrajectoryContact::subdomain));
  writer.array("impulse_n", with_contacts(picture, zero, [](const auto& c) { return c.impulse.n; }));
  writer.array("impulse_t", with_contacts(picture, zero, [](const auto& c) { return c.impulse.t; }));
  writer.array("status", with_contacts(picture, Integers(n, -1), &TrajectoryContact::status));
  writer.array("gap", with_contacts(picture, zero, [](const auto& c) { return c.geometry.gap; }));
  if (!picture.state.models.empty()) write_models(writer, picture);
  writer.line("</CellData>\n<Verts>");
  writer.array("connectivity", counted(n, 0, 1));
  writer.array("offsets", counted(n, 1, 1));
  writer.line("</Verts>\n<Lines>");
  writer.array("connectivity", ends);
  writer.array("offsets", counted(picture.contacts.size(), 2, 2));
  writer.line("</Lines>");
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

}  // namespace

std::string vtp_text(const GranularSystem& system, const TrajectoryStep& step) {
  const Picture picture{system, step.state, step.contacts};
  check(picture);
  Integers subdomain, multiplicity;
  for (const std::set<Index>& held : holders(picture)) {
    subdomain.push_back(held.empty() ? -1 : *held.begin());
    multiplicity.push_back(count(held));
  }
  Writer writer;
  writer.line(fmt::format(R"(<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="{}" header_type="UInt64">
<PolyData>
<FieldData>
<DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">{}</DataArray>
</FieldData>
<Piece NumberOfPoints="{}" NumberOfVerts="{}" NumberOfLines="{}" NumberOfStrips="0" NumberOfPolys="0">)",
                          byte_order, step.state.time, picture.grains + picture.feet, picture.grains,
                          picture.contacts.size()));
  write_points(writer, picture, subdomain, multiplicity);
  write_cells(writer, picture, subdomain);
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
