// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "formats/case/case_file.hpp"
#include "formats/trajectory/trajectory_layout.hpp"

#include <filesystem>

namespace nscdd {
namespace {

using hdf5::Group;
using hdf5::Rows;

hdf5::File open_trajectory(const std::string& path) {
  if (!is_file(path)) fail("{}: expected a trajectory of nscdd simulate, met no such file", path);
  return {path, hdf5::Access::read,
          fmt::format("{}: expected a trajectory of nscdd simulate (HDF5), met something else, a damaged file or one "
                      "that is being changed",
                      path)};
}

template <class Element, class Columns>
std::vector<Element> get_structs(const Group& group, Columns&& columns, std::optional<Rows> rows = std::nullopt) {
  std::vector<Element> elements;
  bool first = true;
  columns([&](const char* column, const char*, auto get) {
    Element probe{};
    using Number = std::remove_reference_t<decltype(*get(probe))>;
    const auto values = group.numbers<decltype(layout::stored(Number{}))>(column, rows);
    if (first) elements.resize(values.size());
    first = false;
    if (values.size() != elements.size())
      fail("{}: expected {} values as in the other columns, met {}", group.of(column), elements.size(), values.size());
    for (std::size_t i = 0; i < values.size(); ++i) *get(elements[i]) = static_cast<Number>(values[i]);
  });
  return elements;
}

// The structs of one step, if their number changes from step to step.
template <class Element, class Columns>
std::vector<Element> get_list(const Group& group, Columns&& columns, Rows step) {
  const auto rows = group.numbers<std::int64_t>("rows", step);
  if (rows.size() != 2 || rows[0] < 0 || rows[1] < rows[0])
    fail("{}: expected the first row of each step and the one behind its last, met other numbers", group.of("rows"));
  return get_structs<Element>(group, columns, Rows{rows[0], rows[1] - rows[0]});
}

void require_within(Index value, Index lowest, Index bound, const char* array, const Group& group) {
  if (value < lowest || value >= bound)
    fail("{}: expected a number in {}..{}, met {}", group.of(array), lowest, bound - 1, value);
}

// Throws Error unless the numbers of steps, bodies and subdomains are in range.
void check_numbers(const TrajectoryStep& step, Index walls, const Group& group) {
  constexpr Index most_steps = 1'000'000'001, most_subdomains = 1'000'000;  // of any run, of any partitioner
  const Index disks = count(step.state.x), bodies = disks + walls, models = count(step.state.models);
  require_within(step.state.step, 0, most_steps, "step", group);
  require_within(step.state.decomposed_at, -1, most_steps, "decomposed_at", group);
  for (const TrajectoryContact& c : step.contacts) {
    require_within(c.geometry.a, 0, bodies, "contacts/a", group);
    require_within(c.geometry.b, 0, bodies, "contacts/b", group);
    require_within(c.subdomain, 0, models > 0 ? models : most_subdomains, "contacts/subdomain", group);
  }
  for (const RememberedBond& one : step.state.bonds)
    for (const Index body : {one.a, one.b}) require_within(body, 0, bodies, "bonds/a or b", group);
  for (const Index grain : step.state.released) require_within(grain, 0, disks, "released/grain", group);
  for (const RememberedModel& model : step.state.models) require_within(model.switched, 0, 2, "models/switched", group);
  for (const RememberedGluing& gluing : step.state.gluing) {
    require_within(gluing.grain, 0, disks + count(step.state.body_velocities), "interface/grain", group);
    require_within(gluing.subdomain, 0, most_subdomains, "interface/subdomain", group);
  }
}

Index dimension_of(const Group& steps) { return steps.has("z") ? 3 : 2; }

// The step in one row of a group, /steps or /last.
TrajectoryStep get_step(const Group& root, const char* name, Index row) {
  const Group group = root.group(name);
  const Rows here{row, 1};
  const auto states = get_structs<GranularState>(group, layout::state_columns, here);
  if (states.size() != 1) fail("{}: expected one number per step, met others", group.of("step"));
  TrajectoryStep step{states[0], {}};
  GranularState& state = step.state;
  const Index dimension = dimension_of(group);
  for (const auto& array : layout::state_arrays(dimension))
    state.*(array.values) = group.numbers<double>(array.name, here);
  state.poses = get_structs<Pose>(group.group("poses"), layout::pose_columns(dimension), here);
  if (group.has("bodies"))
    state.body_velocities =
        get_structs<RigidVelocity>(group.group("bodies"), layout::velocity_columns(dimension), here);
  step.contacts = get_list<TrajectoryContact>(group.group("contacts"), layout::contact_columns(dimension), here);
  state.gluing = get_list<RememberedGluing>(group.group("interface"), layout::gluing_columns(dimension), here);
  if (group.has("bonds")) state.bonds = get_list<RememberedBond>(group.group("bonds"), layout::bond_columns, here);
  if (group.has("released")) state.released = get_list<Index>(group.group("released"), layout::released_columns, here);
  if (group.has("models")) state.models = get_list<RememberedModel>(group.group("models"), layout::model_columns, here);
  const Index walls = root.group("system").group("walls").rows("point_x");
  check_numbers(step, walls, group);
  if (state.step == 0 && root.has("start")) {
    state.impulses = get_structs<RememberedImpulse>(root.group("start"), layout::start_columns);
    for (const RememberedImpulse& one : state.impulses)
      for (const Index body : {one.a, one.b})
        require_within(body, 0, count(state.x) + walls, "a or b", root.group("start"));
    if (!std::ranges::is_sorted(state.impulses, {}, body_pair))
      fail("{}: expected contacts ascending by (a, b), met others", root.group("start").path());
  }
  for (const TrajectoryContact& c : step.contacts) {
    state.subdomains.push_back({c.geometry.a, c.geometry.b, c.subdomain});
    if (!c.carries()) continue;
    const auto& n = c.geometry.normal;
    state.impulses.push_back(
        {c.geometry.a, c.geometry.b,
         dimension == 2 ? to_remember<2>(c.impulse, {n[0], n[1]}) : to_remember<3>(c.local<3>(), n), slides(c.status)});
  }
  return step;
}

GranularSystem get_system(const Group& root) {
  const Group group = root.group("system");
  GranularSystem system;
  system.dimension = dimension_of(root.group("last"));
  system.radius = group.numbers<double>("radius");
  system.mass = group.numbers<double>("mass");
  for (const std::int32_t boundary : group.numbers<std::int32_t>("driven_by")) system.driven_by.push_back(boundary);
  const Group walls = group.group("walls");
  system.walls =
      get_structs<Wall>(walls, layout::wall_columns(system.dimension, walls.has("radius"), walls.has("half_length")));
  for (Wall& wall : system.walls)
    if (system.dimension == 2 && wall.round()) wall.normal = {0, 0, 1};
  if (group.has("period")) {
    const std::vector<double> lengths = group.numbers<double>("period");
    if (lengths.size() != 2) fail("{}: expected two lengths, met {}", group.path() + "/period", lengths.size());
    system.period = {lengths[0], lengths[1]};
  }
  std::istringstream names(group.text("boundaries"));
  for (std::string name; std::getline(names, name);) system.boundaries.push_back({name, {}});
  for (const Index k : system.driven_by) require_within(k, -1, count(system.boundaries), "driven_by", group);
  for (const Wall& wall : system.walls) require_within(wall.boundary, 0, count(system.boundaries), "boundary", walls);
  return system;
}

// A step in one of the groups.
std::optional<TrajectoryStep> find_step(const std::string& path, Index step,
                                        std::initializer_list<const char*> groups) {
  const hdf5::File file = open_trajectory(path);
  for (const char* name : groups) {
    const auto steps = file.root().group(name).numbers<std::int64_t>("step");
    const auto found = std::ranges::find(steps, step);
    if (found != steps.end()) return get_step(file.root(), name, found - steps.begin());
  }
  return std::nullopt;
}

}  // namespace

TrajectoryHeader read_trajectory_header(const std::string& path) {
  const hdf5::File file = open_trajectory(path);
  const Group root = file.root();
  TrajectoryHeader header{.case_text = root.text("case"), .build = {}, .provenance = {}, .system = get_system(root)};
  for (const auto& [key, text] : hdf5::provenance_of(root))
    if (key == "build")
      header.build = text;
    else
      header.provenance.emplace_back(key, text);
  return header;
}

std::vector<Index> trajectory_steps(const std::string& path) {
  const auto steps = open_trajectory(path).root().group("steps").numbers<std::int64_t>("step");
  return {steps.begin(), steps.end()};
}

TrajectoryStep read_trajectory_step(const std::string& path, Index step) {
  if (auto found = find_step(path, step, {"steps"})) return *std::move(found);
  const std::vector<Index> kept = trajectory_steps(path);
  fail("{}: expected one of the {} steps it keeps ({} to {}), met step {}", path, kept.size(),
       kept.empty() ? 0 : kept.front(), kept.empty() ? 0 : kept.back(), step);
}

std::optional<TrajectoryStep> find_trajectory_step(const std::string& path, Index step) {
  return find_step(path, step, {"steps", "last"});
}

TrajectoryStep read_last_step(const std::string& path) { return get_step(open_trajectory(path).root(), "last", 0); }

std::string read_end(const std::string& path) { return open_trajectory(path).root().text_attribute("ended"); }

std::vector<double> read_summary(const std::string& path, const std::string& column) {
  const hdf5::File file = open_trajectory(path);
  const Group group = file.root().group("summary");
  if (!group.has(column) && group.members().empty()) return {};
  return group.numbers<double>(column);
}

bool has_summary(const std::string& path, const std::string& column) {
  return open_trajectory(path).root().group("summary").has(column);
}

std::vector<std::string> read_statuses(const std::string& path) {
  const hdf5::File file = open_trajectory(path);
  const Group group = file.root().group("summary");
  if (group.members().empty()) return {};
  return group.texts("status");
}

std::vector<ChainContact> read_chains(const std::string& path, Index last) {
  const hdf5::File file = open_trajectory(path);
  const Group root = file.root();
  if (!root.has("chains")) return {};
  auto chains =
      get_structs<ChainContact>(root.group("chains"), layout::chain_columns(dimension_of(root.group("last"))));
  const Index bodies = root.group("system").rows("radius") + root.group("system").group("walls").rows("point_x");
  for (const ChainContact& one : chains)
    for (const Index body : {one.geometry.a, one.geometry.b})
      require_within(body, 0, bodies, "a or b", root.group("chains"));
  std::erase_if(chains, [&](const ChainContact& one) { return one.step > last; });
  return chains;
}

void add_chain(const std::string& path, TrajectoryStep& step) {
  std::vector<ChainContact> chains = read_chains(path);
  if (chains.empty()) return;
  const Index taken = read_last_step(path).state.step;
  const bool last = step.state.step == trajectory_steps(path).back();
  const auto ends = [](const TrajectoryContact& c) { return std::pair(c.geometry.a, c.geometry.b); };
  for (const ChainContact& one : chains) {
    if (one.step != step.state.step && !(last && one.step > taken)) continue;
    const TrajectoryContact contact{.geometry = one.geometry, .self_stress = one.stress};
    const auto found = std::ranges::lower_bound(step.contacts, ends(contact), {}, ends);
    if (found != step.contacts.end() && ends(*found) == ends(contact))
      found->self_stress = one.stress;
    else
      step.contacts.insert(found, contact);
  }
}

bool holds_trajectory(const std::string& path) {
  if (!is_file(path)) return false;
  try {
    const hdf5::File file(path, hdf5::Access::read, "");
    return file.root().has("system") && file.root().has("steps") && file.root().has("summary");
  } catch (const Error&) {
    return false;
  }
}

void require_fit(const std::string& path, const Simulation& simulation) {
  try {
    check(simulation.system, simulation.state);
  } catch (const Error& error) {
    fail("{}: {}", path, error.what());
  }
}

Simulation rebuilt_simulation(const std::string& path, const TrajectoryHeader& header, GranularState state) {
  const CaseSpec spec = parse_case(header.case_text, path + ": case", true);
  if (!spec.dynamics) fail("{}: case: expected a section [dynamics], met a case without", path);
  std::vector<BoundarySpec> specs = spec.dynamics->boundaries;
  Index disks = 0;
  for (const BoundarySpec& one : specs) disks += disks_in(one);
  std::erase_if(specs, [](const BoundarySpec& one) { return one.part; });
  GranularSystem system = header.system;
  if (system.boundaries.size() != specs.size())
    fail("{}: expected the {} boundaries of its case, met {}", path, specs.size(), system.boundaries.size());
  for (std::size_t k = 0; k < specs.size(); ++k) {
    Boundary& boundary = system.boundaries[k];
    if (boundary.name != specs[k].name)
      fail("{}: expected the boundary '{}' of its case, met '{}'", path, specs[k].name, boundary.name);
    boundary = {boundary.name, specs[k].motion, specs[k].orientation, specs[k].body, boundary.node, specs[k].source};
  }
  if (state.poses.size() != specs.size())
    fail("{}: expected the poses of its {} boundaries, met {}", path, specs.size(), state.poses.size());
  system.period = spec.contacts.period();
  complete(system, state, *spec.dynamics, system.grains() - disks);
  free_released_grains(system, state);
  Simulation simulation{std::move(system), std::move(state), *spec.dynamics, spec.partition};
  require_fit(path, simulation);
  return simulation;
}

std::string name_of_case(const std::string& path, const TrajectoryHeader& header) {
  constexpr std::string_view mark = "# case ";
  for (const auto& [key, text] : header.provenance)
    if (key == "cases" && text.starts_with(mark)) return text.substr(mark.size(), text.find('\n') - mark.size());
  return std::filesystem::path(path).stem().string();
}

}  // namespace nscdd
