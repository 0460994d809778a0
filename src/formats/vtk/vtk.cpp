// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/vtk/vtk.hpp"

#include "core/fail.hpp"
#include "formats/trajectory/trajectory_layout.hpp"

#include <bit>

namespace nscdd {
namespace {

using Integers = std::vector<std::int64_t>;

// A step to draw. `feet`: the number of contacts whose second end is no grain, but a point of a wall or, across the end
// of a periodic cell, the image of a grain.
struct Scene {
  const GranularSystem& system;
  const GranularState& state;
  const std::vector<TrajectoryContact>& contacts;
  std::size_t grains = state.x.size();
  std::size_t feet = at(std::ranges::count_if(contacts, [&](const auto& c) { return has_foot(c); }));

  bool in_space() const { return system.dimension == 3; }
  bool on_wall(const TrajectoryContact& contact) const { return contact.geometry.b >= system.grains(); }
  Place image(const StepContact& c) const {
    const Place from = centre_of(state, at(c.a)), to = centre_of(state, at(c.b));
    return moved_along(to, 1, difference(system.apart(from, to), difference(to, from)));
  }
  bool has_foot(const TrajectoryContact& contact) const {
    if (on_wall(contact) || !system.period.any()) return on_wall(contact);
    const auto b = at(contact.geometry.b);
    return system.length(difference(image(contact.geometry), centre_of(state, b))) > system.radius[b];
  }
  Place foot(const TrajectoryContact& c) const { return on_wall(c) ? c.geometry.point : image(c.geometry); }
};

void check(const Scene& scene) {
  const auto& [system, state, contacts, n, feet] = scene;
  if (system.radius.size() != n) fail("VTK: expected {} values of radius, met {}", n, system.radius.size());
  if (system.driven_by.size() != n) fail("VTK: expected {} values of driven_by, met {}", n, system.driven_by.size());
  const bool in_space = scene.in_space();  // spins of disks are not drawn
  const auto spin = &GranularState::spin;
  for (const auto& array : layout::state_arrays(system.dimension))
    if (const std::size_t size = (state.*(array.values)).size(); size != n && (in_space || array.values != spin))
      fail("VTK: expected {} values of {}, met {}", n, array.name, size);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (const auto& [a, b] = std::pair(contacts[k].geometry.a, contacts[k].geometry.b);
        a < 0 || a >= system.grains() || b < 0)
      fail("VTK: contact {}: expected two of {} grains, or a grain and a wall, met {} and {}", k, n, a, b);
}

// The values of grains, then `value` for each component of each foot.
template <class Value>
std::vector<Value> with_feet(const Scene& scene, std::vector<Value> values, Value value, std::size_t components = 1) {
  values.resize(values.size() + components * scene.feet, value);
  return values;
}

// The values of grains, then `get` of each contact.
template <class Value, class Get>
std::vector<Value> with_contacts(const Scene& scene, std::vector<Value> values, Get get) {
  for (const TrajectoryContact& contact : scene.contacts)
    values.push_back(static_cast<Value>(std::invoke(get, contact)));
  return values;
}

// The numbers of each grain in these arrays, one after the other; 0 for arrays that exist only in space.
std::vector<double> together(const Scene& scene, std::initializer_list<std::vector<double> GranularState::*> arrays) {
  std::vector<double> all;
  for (std::size_t i = 0; i < scene.grains; ++i)
    for (const auto array : arrays) all.push_back((scene.state.*array).empty() ? 0.0 : (scene.state.*array)[i]);
  return all;
}

std::vector<double> points_of(const Scene& scene) {
  using State = GranularState;
  std::vector<double> points = together(scene, {&State::x, &State::y, &State::z});
  for (const TrajectoryContact& c : scene.contacts)
    if (scene.has_foot(c))
      for (const double x : scene.foot(c)) points.push_back(x);
  return points;
}

std::vector<PictureArray> point_arrays_of(const Scene& scene, const Integers& subdomain, const Integers& multiplicity) {
  using State = GranularState;
  const auto with_zeros = [&](std::initializer_list<std::vector<double> State::*> of_grains) {
    return with_feet(scene, together(scene, of_grains), 0.0, of_grains.size());
  };
  constexpr std::int64_t none = -1, no_subdomain = 0;
  const auto& driven_by = scene.system.driven_by;
  std::vector<PictureArray> arrays{{"radius", with_feet(scene, scene.system.radius, 0.0)},
                                   {"id", with_feet(scene, counted(scene.grains, 0, 1), none)},
                                   {"boundary", with_feet(scene, Integers(driven_by.begin(), driven_by.end()), none)},
                                   {"subdomain", with_feet(scene, subdomain, none)},
                                   {"multiplicity", with_feet(scene, multiplicity, no_subdomain)}};
  if (scene.in_space()) {
    arrays.push_back({"turn", with_zeros({&State::turn_w, &State::turn_x, &State::turn_y, &State::turn_z}), 4});
    arrays.push_back({"spin", with_zeros({&State::spin_x, &State::spin_y, &State::spin}), 3});
  } else {
    arrays.push_back({"angle", with_feet(scene, scene.state.angle, 0.0)});
  }
  arrays.push_back({"velocity", with_zeros({&State::velocity_x, &State::velocity_y, &State::velocity_z}), 3});
  return arrays;
}

// The model of the subdomain of each contact; -1 for grains.
void add_models(const Scene& scene, std::vector<PictureArray>& arrays) {
  const std::vector<RememberedModel>& models = scene.state.models;
  layout::model_columns([&](const char* name, const char*, auto get) {
    if (name == std::string_view("standing")) return;
    using Value = std::remove_cvref_t<decltype(*get(models[0]))>;
    arrays.push_back({name, with_contacts(scene, std::vector<Value>(scene.grains, Value{-1}),
                                          [&](const TrajectoryContact& c) { return *get(models[at(c.subdomain)]); })});
  });
}

std::vector<PictureArray> cell_arrays_of(const Scene& scene, const Integers& subdomain) {
  const std::size_t n = scene.grains;
  const std::vector<double> zero(n);
  std::vector<PictureArray> arrays{
      {"kind", with_contacts(scene, Integers(n, 0), [](const auto&) { return 1; })},
      {"subdomain", with_contacts(scene, subdomain, &TrajectoryContact::subdomain)},
      {"impulse_n", with_contacts(scene, zero, [](const auto& c) { return c.impulse.n; })},
      {"impulse_t",
       with_contacts(scene, zero, [&](const auto& c) { return scene.in_space() ? c.tangential() : c.impulse.t; })},
      {"status", with_contacts(scene, Integers(n, -1), &TrajectoryContact::status)},
      {"gap", with_contacts(scene, zero, [](const auto& c) { return c.geometry.gap; })},
      {"self_stress", with_contacts(scene, zero, &TrajectoryContact::self_stress)}};
  if (!scene.state.models.empty()) add_models(scene, arrays);
  return arrays;
}

Integers lines_of(const Scene& scene) {
  Integers ends;
  auto foot = static_cast<std::int64_t>(scene.grains);
  for (const TrajectoryContact& c : scene.contacts)
    ends.insert(ends.end(), {c.geometry.a, scene.has_foot(c) ? foot++ : c.geometry.b});
  return ends;
}

constexpr std::string_view byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

// The XML part and the appended bytes grow together: the element of an array holds the offset of its bytes.
class Writer {
 public:
  void line(std::string_view text) { xml_ += fmt::format("{}\n", text); }

  template <class Value>
  void array(std::string_view name, const std::vector<Value>& values, std::size_t components = 1) {
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

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '"' ? "&quot;" : std::string(1, c);
  return result;
}

}  // namespace

Integers counted(std::size_t n, std::int64_t first, std::int64_t step) {
  Integers result(n);
  for (std::size_t i = 0; i < n; ++i) result[i] = first + step * static_cast<std::int64_t>(i);
  return result;
}

StepPicture picture_of(const GranularSystem& system, const TrajectoryStep& step) {
  const Scene scene{system, step.state, step.contacts};
  check(scene);
  Integers subdomain, multiplicity;
  for (const std::set<Index>& held : subdomains_of_grains(step.contacts, system.grains())) {
    subdomain.push_back(held.empty() ? -1 : *held.begin());
    multiplicity.push_back(count(held));
  }
  return {.time = step.state.time,
          .points = points_of(scene),
          .vertices = counted(scene.grains, 0, 1),
          .lines = lines_of(scene),
          .point_arrays = point_arrays_of(scene, subdomain, multiplicity),
          .cell_arrays = cell_arrays_of(scene, subdomain)};
}

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
  writer.line(fmt::format(R"(<PointData Scalars="{}" Vectors="{}">)", shown_of_points, shown_vectors));
  writer.arrays(picture.point_arrays);
  writer.line("</PointData>\n<Points>");
  writer.array("Points", picture.points, 3);
  writer.line(fmt::format("</Points>\n<CellData Scalars=\"{}\">", shown_of_cells));
  writer.arrays(picture.cell_arrays);
  writer.line("</CellData>\n<Verts>");
  writer.array("connectivity", picture.vertices);
  writer.array("offsets", counted(picture.vertices.size(), 1, 1));
  writer.line("</Verts>\n<Lines>");
  writer.array("connectivity", picture.lines);
  writer.array("offsets", counted(picture.line_count(), 2, 2));
  writer.line("</Lines>\n</Piece>\n</PolyData>");
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
