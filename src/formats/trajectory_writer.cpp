// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/alternating_file.hpp"
#include "formats/trajectory_layout.hpp"
#include "mechanics/contact_residual.hpp"
#include <nscdd/core/error.hpp>

#include <algorithm>
#include <chrono>

namespace nscdd {
namespace {

using hdf5::Chunk;
using hdf5::Group;
using Clock = std::chrono::steady_clock;

constexpr std::size_t longest_status = 16;
constexpr Chunk summary_chunk = 256;
// Bringing the file up to date takes some milliseconds, as long as a hundred steps of a few disks.
constexpr std::chrono::seconds commit_interval{1};

template <class Element, class Columns>
void put_structs(const Group& parent, const char* name, const std::vector<Element>& elements, Columns&& columns,
                 Chunk chunk) {
  const Group group = parent.make_group(name);
  columns([&](const char* column, const char* unit, auto get) {
    using Number = decltype(layout::stored(std::invoke(get, elements.front())));
    std::vector<Number> values;
    values.reserve(elements.size());
    for (const Element& element : elements) values.push_back(layout::stored(std::invoke(get, element)));
    group.put<Number>(column, values, {{"unit", unit}}, chunk);
  });
}

// Arrays that change their size from step to step lie in chunks in /last. Kept steps never change.
void put_step(const Group& group, const TrajectoryStep& step, Chunk chunk) {
  const GranularState& state = step.state;
  group.put_attribute("step", static_cast<double>(state.step));
  group.put_attribute("time", state.time);
  group.put_attribute("decomposed_at", static_cast<double>(state.decomposed_at));
  group.put_attribute("eta", state.eta);
  for (const auto& array : layout::state_arrays)
    group.put<double>(array.name, state.*(array.values), {{"unit", array.unit}});
  put_structs(group, "poses", state.poses, layout::pose_columns, 0);
  put_structs(group, "contacts", step.contacts, layout::contact_columns, chunk);
  put_structs(group, "interface", state.gluing, layout::gluing_columns, chunk);
}

// About one chunk for the contacts of a dense packing.
void put_last(const Group& root, const TrajectoryStep& step) {
  put_step(root.make_group("last"), step, std::clamp<Chunk>(2 * count(step.state.x), 64, 65536));
}

void put_kept(const Group& root, const TrajectoryStep& step) {
  put_step(root.make_group("steps").make_group(layout::step_name(step.state.step)), step, 0);
}

void put_system(const Group& root, const GranularSystem& system) {
  const Group group = root.make_group("system");
  group.put<double>("radius", system.radius, {{"unit", "m"}});
  group.put<double>("mass", system.mass, {{"unit", "kg"}});
  std::vector<std::int32_t> driven;
  for (const Index boundary : system.driven_by) driven.push_back(layout::stored(boundary));
  group.put<std::int32_t>("driven_by", driven, {{"unit", "1"}});
  put_structs(group, "walls", system.walls, layout::wall_columns, 0);
  std::string names;
  for (const Boundary& boundary : system.boundaries) names += boundary.name + "\n";
  group.put_text("boundaries", names);
}

template <class Value>
std::vector<Value> gather(const Table& table, std::size_t column) {
  std::vector<Value> values;
  for (const Row& row : table.rows) values.push_back(std::get<Value>(row[column]));
  return values;
}

void append_summary(const Group& root, const Table& rows) {
  if (rows.rows.empty()) return;
  const Group group = root.make_group("summary");
  for (std::size_t j = 0; j < rows.columns.size(); ++j) {
    const auto& [name, unit, description] = rows.columns[j];
    const hdf5::Attributes attributes{{"unit", unit}, {"description", description}};
    const Cell& first = rows.rows.front()[j];
    if (std::holds_alternative<std::string>(first))
      group.append_texts(name, gather<std::string>(rows, j), longest_status, attributes, summary_chunk);
    else if (std::holds_alternative<std::int64_t>(first))
      group.append<std::int64_t>(name, gather<std::int64_t>(rows, j), attributes, summary_chunk);
    else
      group.append<double>(name, gather<double>(rows, j), attributes, summary_chunk);
  }
}

// The line joins those of earlier restarts. The provenance of the beginning of the run stays.
void add_restart(const Group& root, const std::string& line) {
  const Group origin = root.group("provenance");
  std::string lines;
  if (origin.has("restarts")) {
    lines = origin.text("restarts");
    origin.remove("restarts");
  }
  origin.put_text("restarts", lines + line);
}

// Changes a file that exists. It is closed afterwards.
template <class Change>
void change_file(const std::string& name, Change&& change) {
  const hdf5::File file(name, hdf5::Access::change, fmt::format("{}: cannot be changed as an HDF5 file", name));
  change(file.root());
  file.flush();
}

struct PendingStep {
  TrajectoryStep step;
  bool keep = false;
};

// What the file lacks. Of the steps that are not kept only the newest one is needed, for /last.
struct Pending {
  std::vector<PendingStep> steps;
  Table summary;
  std::string ended;

  void write(const Group& root) const {
    for (const PendingStep& one : steps)
      if (one.keep) put_kept(root, one.step);
    if (!steps.empty()) put_last(root, steps.back().step);
    append_summary(root, summary);
    if (!ended.empty()) root.put_attribute("ended", ended);
  }
};

}  // namespace

std::vector<std::string> names_beside(const std::string& path) { return AlternatingFile::names_beside(path); }

TrajectoryStep trajectory_step(const Simulation& after, const SolvedStep& solved) {
  TrajectoryStep step;
  step.state = after.state;
  const ContactLaw law = contact_law(after.dynamics.interaction, solved.problem.h);
  step.contacts.reserve(solved.contacts.size());
  for (std::size_t k = 0; k < solved.contacts.size(); ++k) {
    const DiskContact& c = solved.contacts[k];
    step.contacts.push_back({solved.problem.geometry[k],
                             {c.impulse_n, c.impulse_t},
                             status_of(law, c),
                             solved.partition.subdomain_of_contact[k]});
  }
  return step;
}

struct TrajectoryWriter::Implementation {
  AlternatingFile file;
  std::vector<Column> columns;
  Pending pending{{}, {columns, {}}, {}};
  Clock::time_point committed = Clock::now();

  void commit() {
    if (pending.steps.empty() && pending.ended.empty()) return;
    const auto batch = std::make_shared<const Pending>(std::exchange(pending, Pending{{}, {columns, {}}, {}}));
    file.change(
        [batch](const std::string& name) { change_file(name, [&](const Group& root) { batch->write(root); }); });
    committed = Clock::now();
  }
};

TrajectoryWriter::TrajectoryWriter(const std::string& path, const TrajectoryHeader& header, const TrajectoryStep& first,
                                   const std::vector<Column>& summary_columns)
    : TrajectoryWriter(path, summary_columns) {
  implementation_->file.create([&](const std::string& name) {
    const hdf5::File file(name, hdf5::Access::create, fmt::format("{}: cannot be written", path));
    const Group root = file.root();
    hdf5::put_provenance(root, header.provenance);
    root.group("provenance").put_text("build", header.build);
    root.put_text("case", header.case_text);
    root.put_attribute("ended", "running");
    put_system(root, header.system);
    put_kept(root, first);
    put_last(root, first);
    root.make_group("summary");
    file.flush();
  });
}

TrajectoryWriter::TrajectoryWriter(const std::string& path, const std::vector<Column>& summary_columns)
    : implementation_(new Implementation{AlternatingFile(path), summary_columns}) {}

TrajectoryWriter::~TrajectoryWriter() {
  try {
    implementation_->commit();
  } catch (const Error&) {  // the run has failed already, and the file stays as it was
  }
}

void TrajectoryWriter::go_on(const std::string& case_text, const std::string& restart) {
  implementation_->file.change([case_text, restart](const std::string& name) {
    change_file(name, [&](const Group& root) {
      root.remove("case");
      root.put_text("case", case_text);
      add_restart(root, restart);
      root.put_attribute("ended", "running");
    });
  });
}

void TrajectoryWriter::append(TrajectoryStep step, const Row& summary, bool keep) {
  Pending& pending = implementation_->pending;
  if (!pending.steps.empty() && !pending.steps.back().keep) pending.steps.pop_back();
  pending.steps.push_back({std::move(step), keep});
  pending.summary.rows.push_back(summary);
}

bool TrajectoryWriter::due() const { return Clock::now() - implementation_->committed >= commit_interval; }

void TrajectoryWriter::commit() { implementation_->commit(); }

void TrajectoryWriter::end(const std::string& how) {
  implementation_->pending.ended = how;
  implementation_->commit();
}

}  // namespace nscdd
