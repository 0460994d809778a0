// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/trajectory/trajectory_layout.hpp"
#include "mechanics/grain_contacts.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

using hdf5::ArrayForm;
using hdf5::Group;
using Steps = std::span<const TrajectoryStep>;

// A commit takes some milliseconds, as long as a hundred steps of a few disks.
constexpr std::chrono::seconds commit_interval{1};

// A list of the state of a step.
template <class List>
auto of_state(List GranularState::*list) {
  return [list](const TrajectoryStep& step) -> auto& { return step.state.*list; };
}

// The structs of `list` in each owner, one owner after the other.
template <class Owner, class List, class Columns>
void put_structs(const Group& group, std::span<const Owner> owners, List list, Columns&& columns, ArrayForm form) {
  columns([&](const char* column, const char* unit, auto get) {
    using Number = decltype(layout::stored(*get(std::invoke(list, owners[0])[0])));
    std::vector<Number> values;
    for (const Owner& owner : owners)
      for (const auto& element : std::invoke(list, owner)) values.push_back(layout::stored(*get(element)));
    form.attributes = {{"unit", unit}};
    group.put<Number>(column, values, form);
  });
}

// The same if their number changes. The array `rows` has the first row of each step and the one after its last.
template <class List, class Columns>
void put_lists(const Group& group, Steps steps, List list, Columns&& columns, ArrayForm form) {
  put_structs(group, steps, list, columns, form);
  const Index before = form.append ? group.rows("rows") : 0;
  std::int64_t end = before > 0 ? group.numbers<std::int64_t>("rows", hdf5::Rows{before - 1}).back() : 0;
  std::vector<std::int64_t> rows;
  for (const TrajectoryStep& step : steps) {
    rows.push_back(end);
    rows.push_back(end += count(std::invoke(list, step)));
  }
  form.attributes = {{"unit", "1"}};
  form.rows = steps.size();
  group.put<std::int64_t>("rows", rows, form);
}

// One array per quantity holds all steps, which saves calls of HDF5. A chunk holds the contacts of a dense packing.
// Lists that few cases have are in all steps of a file or in none: `system` of a new file decides.
void put_steps(const Group& group, Steps steps, bool append, const GranularSystem* system = nullptr) {
  if (steps.empty()) return;
  ArrayForm form{.chunk = std::clamp<std::size_t>(2 * steps[0].state.x.size(), 256, 65536), .append = append};
  const auto state = [](const TrajectoryStep& step) { return std::span(&step.state, 1); };
  const auto lists = [&](const char* name, auto list, auto columns) {
    put_lists(group.make_group(name), steps, list, columns, form);
  };
  const auto releases = [](const Boundary& one) { return one.source.has_value(); };
  using State = GranularState;
  const Index dimension = steps[0].state.z.empty() ? 2 : 3;
  put_structs(group, steps, state, layout::state_columns, form);
  lists("contacts", &TrajectoryStep::contacts, layout::contact_columns(dimension));
  lists("interface", of_state(&State::gluing), layout::gluing_columns(dimension));
  if (system != nullptr ? system->pairs.bonds() : group.has("bonds"))
    lists("bonds", of_state(&State::bonds), layout::bond_columns);
  if (system != nullptr ? std::ranges::any_of(system->boundaries, releases) : group.has("released"))
    lists("released", of_state(&State::released), layout::released_columns);
  if (!steps[0].state.models.empty())  // one per subdomain in every step of a run that switches models
    lists("models", of_state(&State::models), layout::model_columns);
  form.rows = steps.size();
  put_structs(group.make_group("poses"), steps, of_state(&State::poses), layout::pose_columns(dimension), form);
  if (!steps[0].state.body_velocities.empty())
    put_structs(group.make_group("bodies"), steps, of_state(&State::body_velocities),
                layout::velocity_columns(dimension), form);
  for (const auto& array : layout::state_arrays(dimension)) {
    const auto column = [&](auto&& visit) { visit(array.name, array.unit, [](auto& number) { return &number; }); };
    put_structs(group, steps, of_state(array.values), column, form);
  }
}

void put_chains(const Group& root, const std::vector<ChainContact>& chains) {
  if (chains.empty()) return;
  put_structs(root.make_group("chains"), std::span(&chains, 1), std::identity(),
              layout::chain_columns(root.group("last").has("z") ? 3 : 2), {.chunk = 256, .append = true});
}

void put_system(const Group& root, const GranularSystem& system) {
  const Group group = root.make_group("system");
  group.put<double>("radius", system.radius, {.attributes = {{"unit", "m"}}});
  group.put<double>("mass", system.mass, {.attributes = {{"unit", "kg"}}});
  const std::vector<std::int32_t> driven(system.driven_by.begin(), system.driven_by.end());
  group.put<std::int32_t>("driven_by", driven, {.attributes = {{"unit", "1"}}});
  const bool radii = std::ranges::any_of(system.walls, [](const Wall& wall) { return wall.radius != 0; });
  const bool lengths = std::ranges::any_of(system.walls, [](const Wall& wall) { return wall.half_length > 0; });
  put_structs(group.make_group("walls"), std::span(&system, 1), &GranularSystem::walls,
              layout::wall_columns(system.dimension, radii, lengths), {});
  std::string names;
  for (const Boundary& boundary : system.boundaries) names += boundary.name + "\n";
  group.put_text("boundaries", names);
  if (const Period& period = system.period; period.any())
    group.put<double>("period", std::array{period.x, period.y}, {.attributes = {{"unit", "m"}}});
}

AlternatingFile::Change changing(std::function<void(const Group& root)> change) {
  return [change](const std::string& name) {
    const hdf5::File file(name, hdf5::Access::change, fmt::format("{}: cannot be changed as an HDF5 file", name));
    change(file.root());
    file.flush();
  };
}

}  // namespace

TrajectoryWriter::TrajectoryWriter(const std::string& path, const TrajectoryHeader& header, const TrajectoryStep& first,
                                   const std::vector<Column>& summary_columns)
    : TrajectoryWriter(path, summary_columns) {
  file_.create([&](const std::string& name) {
    const hdf5::File file(name, hdf5::Access::create, fmt::format("{}: cannot be written", path));
    const Group root = file.root();
    hdf5::put_provenance(root, header.provenance);
    root.group("provenance").put_text("build", header.build);
    root.put_text("case", header.case_text);
    root.put_attribute("ended", "running");
    put_system(root, header.system);
    for (const char* group : {"steps", "last"}) put_steps(root.make_group(group), {&first, 1}, false, &header.system);
    if (!first.state.impulses.empty())  // given to the first step
      put_structs(root.make_group("start"), std::span(&first, 1), of_state(&GranularState::impulses),
                  layout::start_columns, {});
    root.make_group("summary");
    file.flush();
  });
}

TrajectoryWriter::TrajectoryWriter(const std::string& path, const std::vector<Column>& summary_columns)
    : file_(path), pending_{.summary = {summary_columns, {}}} {}

TrajectoryWriter::~TrajectoryWriter() {
  try {
    commit();
  } catch (const Error&) {  // the run has failed already, and the file stays as it was
  }
}

void TrajectoryWriter::go_on(const std::string& case_text, const std::string& restart,
                             const std::vector<ChainContact>& chains) {
  file_.change(changing([case_text, restart, chains](const Group& root) {
    if (root.has("chains")) root.remove("chains");
    put_chains(root, chains);
    root.remove("case");
    root.put_text("case", case_text);
    const Group origin = root.group("provenance");
    const std::string lines = origin.has("restarts") ? origin.text("restarts") : "";
    if (origin.has("restarts")) origin.remove("restarts");
    origin.put_text("restarts", lines + restart);
    root.put_attribute("ended", "running");
  }));
}

void TrajectoryWriter::append(TrajectoryStep step, const std::vector<Row>& summary, bool keep) {
  step.state.impulses = {};  // contacts hold impulses and subdomains
  step.state.subdomains = {};
  if (!pending_.newest_kept) pending_.steps.pop_back();
  pending_.steps.push_back(std::move(step));
  pending_.newest_kept = keep;
  pending_.summary.rows.insert(pending_.summary.rows.end(), summary.begin(), summary.end());
}

void TrajectoryWriter::append(const std::vector<ChainContact>& chain) {
  pending_.chains.insert(pending_.chains.end(), chain.begin(), chain.end());
}

bool TrajectoryWriter::due() const { return std::chrono::steady_clock::now() - committed_ >= commit_interval; }

void TrajectoryWriter::commit() {
  if (pending_.steps.empty() && pending_.ended.empty()) return;
  Pending next{.summary = {pending_.summary.columns, {}}};
  const auto batch = std::make_shared<const Pending>(std::exchange(pending_, std::move(next)));
  file_.change(changing([batch](const Group& root) {
    const auto& [steps, newest_kept, summary, chains, ended] = *batch;
    put_steps(root.group("steps"), Steps(steps).first(steps.size() - (newest_kept ? 0 : 1)), true);
    put_steps(root.group("last"), Steps(steps).last(std::min<std::size_t>(steps.size(), 1)), false);
    if (!summary.rows.empty())
      root.group("summary").put_columns(summary, {.chunk = 256, .append = true, .longest_text = 16});
    put_chains(root, chains);
    if (!ended.empty()) root.put_attribute("ended", ended);
  }));
  committed_ = std::chrono::steady_clock::now();
}

void TrajectoryWriter::end(const std::string& how) {
  pending_.ended = how;
  commit();
}

}  // namespace nscdd
