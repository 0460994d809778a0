// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/trajectory_layout.hpp"
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace nscdd {
namespace {

Handle open_trajectory(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored))
    throw Error(fmt::format("{}: expected a trajectory of nscdd simulate, met no such file", path));
  return open_hdf5(path, false,
                   fmt::format("{}: expected a trajectory of nscdd simulate (HDF5), met something else, a "
                               "damaged file or one that is being changed",
                               path));
}

template <class Number, class Target>
void set(Target& target, Number value) {
  target = static_cast<Target>(value);
}

template <class Element, class Columns>
std::vector<Element> get_structs(hid_t parent, const std::string& name, const std::string& file,
                                 Columns&& columns) {
  const Handle group = member_group(parent, name, file);
  std::vector<Element> elements;
  bool first = true;
  columns([&](const char* column, const char*, auto get) {
    Element probe{};
    const auto values = get_array<decltype(layout::stored(get(probe)))>(group, column, file);
    if (first) elements.resize(values.size());
    first = false;
    if (values.size() != elements.size())
      throw Error(fmt::format("{}: {}/{}: expected {} values as in the other columns, met {}", file, name,
                              column, elements.size(), values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) set(get(elements[i]), values[i]);
  });
  return elements;
}

// A number that counts steps.
Index get_count(hid_t group, const std::string& name, Index lowest, const std::string& file) {
  constexpr double highest = 1e15;  // below it every integer is a double
  const double value = get_number(group, name, file);
  if (!(value >= static_cast<double>(lowest) && value <= highest && std::floor(value) == value))
    throw Error(fmt::format("{}: expected an integer from {} to {} in the attribute '{}', met {}", file,
                            lowest, highest, name, value));
  return static_cast<Index>(value);
}

void require_below(Index value, Index bound, const char* array, const std::string& file) {
  if (value < 0 || value >= bound)
    throw Error(fmt::format("{}: {}: expected a number in 0..{}, met {}", file, array, bound - 1, value));
}

// Whether numbers of bodies and subdomains are some.
void check_numbers(const TrajectoryStep& step, Index walls, const std::string& file) {
  constexpr Index most_subdomains = 1'000'000;  // of any partitioner
  const Index disks = count(step.state.x), bodies = disks + walls;
  for (const TrajectoryContact& c : step.contacts) {
    require_below(c.geometry.a, bodies, "contacts/a", file);
    require_below(c.geometry.b, bodies, "contacts/b", file);
    require_below(c.subdomain, most_subdomains, "contacts/subdomain", file);
  }
  for (const RememberedGluing& gluing : step.state.gluing) {
    require_below(gluing.grain, disks, "interface/grain", file);
    require_below(gluing.subdomain, most_subdomains, "interface/subdomain", file);
  }
}

TrajectoryStep get_step(hid_t group, const std::string& file) {
  TrajectoryStep step;
  GranularState& state = step.state;
  state.step = get_count(group, "step", 0, file);
  state.time = get_number(group, "time", file);
  state.decomposed_at = get_count(group, "decomposed_at", -1, file);
  state.eta = get_number(group, "eta", file);
  for (const auto& array : layout::state_arrays)
    state.*(array.values) = get_array<double>(group, array.name, file);
  state.poses = get_structs<Pose>(group, "poses", file, [](auto&& v) { layout::pose_columns(v); });
  step.contacts =
      get_structs<TrajectoryContact>(group, "contacts", file, [](auto&& v) { layout::contact_columns(v); });
  state.gluing =
      get_structs<RememberedGluing>(group, "interface", file, [](auto&& v) { layout::gluing_columns(v); });
  const Handle walls = member_group(member_group(group, "/system", file), "walls", file);
  check_numbers(step, count(get_array<double>(walls, "point_x", file)), file);
  for (const TrajectoryContact& c : step.contacts) {
    state.subdomains.push_back({c.geometry.a, c.geometry.b, c.subdomain});
    if (c.impulse.n != 0 || c.impulse.t != 0)
      state.impulses.push_back({c.geometry.a, c.geometry.b, c.impulse});
  }
  return step;
}

GranularSystem get_system(hid_t file, const std::string& path) {
  const Handle group = member_group(file, "system", path);
  GranularSystem system;
  system.radius = get_array<double>(group, "radius", path);
  system.mass = get_array<double>(group, "mass", path);
  for (const std::int32_t boundary : get_array<std::int32_t>(group, "driven_by", path))
    system.driven_by.push_back(boundary);
  system.walls = get_structs<Wall>(group, "walls", path, [](auto&& v) { layout::wall_columns(v); });
  const std::string names = get_text(group, "boundaries", path);
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find('\n', begin), names.size());
    system.boundaries.push_back({names.substr(begin, end - begin), {}});
    begin = end + 1;
  }
  return system;
}

std::vector<std::string> members(hid_t group) {
  H5G_info_t content{};
  Handle::require(H5Gget_info(group, &content));
  std::vector<std::string> names;
  for (hsize_t i = 0; i < content.nlinks; ++i) {
    std::string name(64, '\0');
    const ssize_t length =
        H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
    if (length < 0) throw Error("HDF5: a group cannot be read");
    names.push_back(name.substr(0, std::min(name.find('\0'), name.size())));
  }
  return names;
}

}  // namespace

TrajectoryHeader read_trajectory_header(const std::string& path) {
  const Handle file = open_trajectory(path);
  TrajectoryHeader header;
  header.case_text = get_text(file, "case", path);
  const Handle origin = member_group(file, "provenance", path);
  for (const std::string& name : members(origin)) {
    const std::string text = get_text(origin, name, path);
    if (name == "build")
      header.build = text;
    else
      header.provenance.emplace_back(name, text);
  }
  header.system = get_system(file, path);
  return header;
}

std::vector<Index> trajectory_steps(const std::string& path) {
  const Handle file = open_trajectory(path);
  std::vector<Index> steps;
  for (const std::string& name : members(member_group(file, "steps", path)))
    steps.push_back(parse_integer(name, path + ": steps"));
  std::sort(steps.begin(), steps.end());
  return steps;
}

TrajectoryStep read_trajectory_step(const std::string& path, Index step) {
  {
    const Handle file = open_trajectory(path);
    const Handle steps = member_group(file, "steps", path);
    const std::string name = fmt::format("{:06}", step);
    if (step >= 0 && has_link(steps, name)) return get_step(member_group(steps, name, path), path);
  }
  const std::vector<Index> kept = trajectory_steps(path);
  throw Error(fmt::format("{}: expected one of the {} steps it keeps ({} to {}), met step {}", path,
                          kept.size(), kept.empty() ? 0 : kept.front(), kept.empty() ? 0 : kept.back(),
                          step));
}

std::optional<TrajectoryStep> find_trajectory_step(const std::string& path, Index step) {
  const Handle file = open_trajectory(path);
  const Handle steps = member_group(file, "steps", path), last = member_group(file, "last", path);
  const std::string name = fmt::format("{:06}", step);
  if (step >= 0 && has_link(steps, name)) return get_step(member_group(steps, name, path), path);
  if (get_number(last, "step", path) == static_cast<double>(step)) return get_step(last, path);
  return std::nullopt;
}

TrajectoryStep read_last_step(const std::string& path) {
  const Handle file = open_trajectory(path);
  return get_step(member_group(file, "last", path), path);
}

std::string read_end(const std::string& path) {
  const Handle file = open_trajectory(path);
  return get_text_attribute(file, "ended", path);
}

std::vector<double> read_summary(const std::string& path, const std::string& column) {
  const Handle file = open_trajectory(path);
  const Handle group = member_group(file, "summary", path);
  if (!has_link(group, column) && members(group).empty()) return {};
  return get_array<double>(group, column, path);
}

}  // namespace nscdd
