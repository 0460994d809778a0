// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/trajectory_layout.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace nscdd {
namespace {

using hdf5::Group;

// A trajectory that is read. Its last step and every other part are found from `root`.
struct OpenTrajectory {
  hdf5::File file;
  Group root;

  explicit OpenTrajectory(const std::string& path)
      : file(existing(path), hdf5::Access::read,
             fmt::format("{}: expected a trajectory of nscdd simulate (HDF5), met something else, a "
                         "damaged file or one that is being changed",
                         path)),
        root(file.root()) {}

  static const std::string& existing(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored))
      throw Error(fmt::format("{}: expected a trajectory of nscdd simulate, met no such file", path));
    return path;
  }
};

template <class Number, class Target>
void set(Target& target, Number value) {
  target = static_cast<Target>(value);
}

template <class Element, class Columns>
std::vector<Element> get_structs(const Group& parent, const std::string& name, Columns&& columns) {
  const Group group = parent.group(name);
  std::vector<Element> elements;
  bool first = true;
  columns([&](const char* column, const char*, auto get) {
    Element probe{};
    const auto values = group.numbers<decltype(layout::stored(std::invoke(get, probe)))>(column);
    if (first) elements.resize(values.size());
    first = false;
    if (values.size() != elements.size())
      throw Error(fmt::format("{}: expected {} values as in the other columns, met {}", group.of(column),
                              elements.size(), values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) set(std::invoke(get, elements[i]), values[i]);
  });
  return elements;
}

// A number that counts steps.
Index get_count(const Group& group, const std::string& name, Index lowest) {
  constexpr double highest = 1e15;  // below it every integer is a double
  const double value = group.number_attribute(name);
  if (!(value >= static_cast<double>(lowest) && value <= highest && std::floor(value) == value))
    throw Error(fmt::format("{}: expected an integer from {} to {} in the attribute '{}', met {}", group.path(), lowest,
                            highest, name, value));
  return static_cast<Index>(value);
}

void require_below(Index value, Index bound, const char* array, const Group& step) {
  if (value < 0 || value >= bound)
    throw Error(fmt::format("{}: expected a number in 0..{}, met {}", step.of(array), bound - 1, value));
}

// Throws unless the numbers of bodies and subdomains are within their ranges.
void check_numbers(const TrajectoryStep& step, Index walls, const Group& group) {
  constexpr Index most_subdomains = 1'000'000;  // of any partitioner
  const Index disks = count(step.state.x), bodies = disks + walls;
  for (const TrajectoryContact& c : step.contacts) {
    require_below(c.geometry.a, bodies, "contacts/a", group);
    require_below(c.geometry.b, bodies, "contacts/b", group);
    require_below(c.subdomain, most_subdomains, "contacts/subdomain", group);
  }
  for (const RememberedGluing& gluing : step.state.gluing) {
    require_below(gluing.grain, disks, "interface/grain", group);
    require_below(gluing.subdomain, most_subdomains, "interface/subdomain", group);
  }
}

TrajectoryStep get_step(const Group& group, const Group& root) {
  TrajectoryStep step;
  GranularState& state = step.state;
  state.step = get_count(group, "step", 0);
  state.time = group.number_attribute("time");
  state.decomposed_at = get_count(group, "decomposed_at", -1);
  state.eta = group.number_attribute("eta");
  for (const auto& array : layout::state_arrays) state.*(array.values) = group.numbers<double>(array.name);
  state.poses = get_structs<Pose>(group, "poses", layout::pose_columns);
  step.contacts = get_structs<TrajectoryContact>(group, "contacts", layout::contact_columns);
  state.gluing = get_structs<RememberedGluing>(group, "interface", layout::gluing_columns);
  const Index walls = count(root.group("system").group("walls").numbers<double>("point_x"));
  check_numbers(step, walls, group);
  for (const TrajectoryContact& c : step.contacts) {
    state.subdomains.push_back({c.geometry.a, c.geometry.b, c.subdomain});
    if (c.impulse.n != 0 || c.impulse.t != 0) state.impulses.push_back({c.geometry.a, c.geometry.b, c.impulse});
  }
  return step;
}

GranularSystem get_system(const Group& root) {
  const Group group = root.group("system");
  GranularSystem system;
  system.radius = group.numbers<double>("radius");
  system.mass = group.numbers<double>("mass");
  for (const std::int32_t boundary : group.numbers<std::int32_t>("driven_by")) system.driven_by.push_back(boundary);
  system.walls = get_structs<Wall>(group, "walls", layout::wall_columns);
  const std::string names = group.text("boundaries");
  for (std::size_t begin = 0; begin < names.size();) {
    const std::size_t end = std::min(names.find('\n', begin), names.size());
    system.boundaries.push_back({names.substr(begin, end - begin), {}});
    begin = end + 1;
  }
  return system;
}

// A step that is kept, or that is the newest if `newest_too`.
std::optional<TrajectoryStep> find_step(const std::string& path, Index step, bool newest_too) {
  const OpenTrajectory trajectory(path);
  const Group steps = trajectory.root.group("steps");
  const std::string name = layout::step_name(step);
  if (step >= 0 && steps.has(name)) return get_step(steps.group(name), trajectory.root);
  if (!newest_too) return std::nullopt;
  const Group last = trajectory.root.group("last");
  if (last.number_attribute("step") != static_cast<double>(step)) return std::nullopt;
  return get_step(last, trajectory.root);
}

}  // namespace

TrajectoryHeader read_trajectory_header(const std::string& path) {
  const OpenTrajectory trajectory(path);
  TrajectoryHeader header;
  header.case_text = trajectory.root.text("case");
  header.provenance = hdf5::provenance_of(trajectory.root);
  const auto build = std::find_if(header.provenance.begin(), header.provenance.end(),
                                  [](const auto& entry) { return entry.first == "build"; });
  if (build != header.provenance.end()) {
    header.build = build->second;
    header.provenance.erase(build);
  }
  header.system = get_system(trajectory.root);
  return header;
}

std::vector<Index> trajectory_steps(const std::string& path) {
  const OpenTrajectory trajectory(path);
  std::vector<Index> steps;
  for (const std::string& name : trajectory.root.group("steps").members())
    steps.push_back(parse_integer(name, path + ": steps"));
  std::sort(steps.begin(), steps.end());
  return steps;
}

TrajectoryStep read_trajectory_step(const std::string& path, Index step) {
  if (auto found = find_step(path, step, false)) return *std::move(found);
  const std::vector<Index> kept = trajectory_steps(path);
  throw Error(fmt::format("{}: expected one of the {} steps it keeps ({} to {}), met step {}", path, kept.size(),
                          kept.empty() ? 0 : kept.front(), kept.empty() ? 0 : kept.back(), step));
}

std::optional<TrajectoryStep> find_trajectory_step(const std::string& path, Index step) {
  return find_step(path, step, true);
}

TrajectoryStep read_last_step(const std::string& path) {
  const OpenTrajectory trajectory(path);
  return get_step(trajectory.root.group("last"), trajectory.root);
}

std::string read_end(const std::string& path) { return OpenTrajectory(path).root.text_attribute("ended"); }

std::vector<double> read_summary(const std::string& path, const std::string& column) {
  const OpenTrajectory trajectory(path);
  const Group group = trajectory.root.group("summary");
  if (!group.has(column) && group.members().empty()) return {};
  return group.numbers<double>(column);
}

}  // namespace nscdd
