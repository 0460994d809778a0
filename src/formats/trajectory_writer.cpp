// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/alternating_file.hpp"
#include "formats/trajectory_layout.hpp"
#include <nscdd/mechanics/contact_residual.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace nscdd {
namespace {

constexpr std::size_t longest_status = 16;
constexpr Chunk summary_chunk = 256;

template <class Element, class Columns>
void put_structs(hid_t parent, const char* name, const std::vector<Element>& elements, Columns&& columns,
                 Chunk chunk) {
  const Handle group = open_or_make_group(parent, name);
  columns([&](const char* column, const char* unit, auto get) {
    std::vector<decltype(layout::stored(get(elements.front())))> values;
    values.reserve(elements.size());
    for (const Element& element : elements) values.push_back(layout::stored(get(element)));
    put_array<typename decltype(values)::value_type>(group, column, values, unit, chunk);
  });
}

// What changes its size from step to step lies in chunks, in /last only: kept steps never change.
void put_step(hid_t group, const TrajectoryStep& step, Chunk chunk) {
  const GranularState& state = step.state;
  put_attribute(group, "step", static_cast<double>(state.step));
  put_attribute(group, "time", state.time);
  put_attribute(group, "decomposed_at", static_cast<double>(state.decomposed_at));
  put_attribute(group, "eta", state.eta);
  for (const auto& array : layout::state_arrays)
    put_array<double>(group, array.name, state.*(array.values), array.unit);
  put_structs(
      group, "poses", state.poses, [](auto&& v) { layout::pose_columns(v); }, 0);
  put_structs(
      group, "contacts", step.contacts, [](auto&& v) { layout::contact_columns(v); }, chunk);
  put_structs(
      group, "interface", state.gluing, [](auto&& v) { layout::gluing_columns(v); }, chunk);
}

void put_system(hid_t file, const GranularSystem& system) {
  const Handle group = open_or_make_group(file, "system");
  put_array<double>(group, "radius", system.radius, "m");
  put_array<double>(group, "mass", system.mass, "kg");
  std::vector<std::int32_t> driven;
  for (const Index boundary : system.driven_by) driven.push_back(layout::stored(boundary));
  put_array<std::int32_t>(group, "driven_by", driven, "1");
  put_structs(
      group, "walls", system.walls, [](auto&& v) { layout::wall_columns(v); }, 0);
  std::string names;
  for (const Boundary& boundary : system.boundaries) names += boundary.name + "\n";
  put_text(group, "boundaries", names);
}

void append_summary(hid_t file, const std::vector<Column>& columns, const Row& row) {
  const Handle group = open_or_make_group(file, "summary");
  for (std::size_t j = 0; j < columns.size(); ++j) {
    const Column& column = columns[j];
    if (const auto* text = std::get_if<std::string>(&row[j]))
      append_to_texts(group, column.name, *text, longest_status, column.description, summary_chunk);
    else if (const auto* integer = std::get_if<std::int64_t>(&row[j]))
      append_to_array(group, column.name, *integer, column.unit, column.description, summary_chunk);
    else
      append_to_array(group, column.name, std::get<double>(row[j]), column.unit, column.description,
                      summary_chunk);
  }
}

// About one chunk for the contacts of a dense packing.
Chunk chunk_of(const GranularState& state) { return std::clamp<Chunk>(2 * count(state.x), 64, 65536); }

std::string step_name(Index step) { return fmt::format("{:06}", step); }

void keep_step(hid_t file, const TrajectoryStep& step) {
  const Handle steps = open_or_make_group(file, "steps");
  put_step(open_or_make_group(steps, step_name(step.state.step)), step, 0);
}

// The line joins those of earlier restarts; what began the run stays as it was.
void add_restart(hid_t file, const std::string& name, const std::string& line) {
  const Handle origin = open_or_make_group(file, "provenance");
  std::string lines;
  if (has_link(origin, "restarts")) {
    lines = get_text(origin, "restarts", name);
    H5Ldelete(origin, "restarts", H5P_DEFAULT);
  }
  put_text(origin, "restarts", lines + line);
}

// Changes a file that is there, closed behind it.
template <class Change>
void change_file(const std::string& name, Change&& change) {
  const Handle file = open_hdf5(name, true, fmt::format("{}: cannot be changed as an HDF5 file", name));
  change(file);
  if (H5Fflush(file, H5F_SCOPE_GLOBAL) < 0)
    throw Error(fmt::format("{}: cannot be written: no room left, or not permitted", name));
}

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
  std::string path;
  AlternatingFile file;
  std::vector<Column> columns;
};

TrajectoryWriter::TrajectoryWriter(const std::string& path, const TrajectoryHeader& header,
                                   const TrajectoryStep& first, const std::vector<Column>& summary_columns)
    : implementation_(new Implementation{path, AlternatingFile(path), summary_columns}) {
  implementation_->file.create([&](const std::string& name) {
    prepare_hdf5();
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(creation, 0);
    const Handle file(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, creation, access), H5Fclose,
                      fmt::format("{}: cannot be written", path));
    {
      const Handle origin = open_or_make_group(file, "provenance");
      for (const auto& [key, text] : header.provenance) put_text(origin, key, text);
      put_text(origin, "build", header.build);
      put_text(file, "case", header.case_text);
      put_attribute(file, "ended", std::string("running"));
      put_system(file, header.system);
      keep_step(file, first);
      put_step(open_or_make_group(file, "last"), first, chunk_of(first.state));
      open_or_make_group(file, "summary");
    }
    if (H5Fflush(file, H5F_SCOPE_GLOBAL) < 0) throw Error(fmt::format("{}: cannot be written", path));
  });
}

TrajectoryWriter::TrajectoryWriter(const std::string& path, const std::vector<Column>& summary_columns)
    : implementation_(new Implementation{path, AlternatingFile(path), summary_columns}) {}

TrajectoryWriter::~TrajectoryWriter() = default;

void TrajectoryWriter::go_on(const std::string& case_text, const std::string& restart) {
  implementation_->file.change([case_text, restart](const std::string& name) {
    change_file(name, [&](hid_t file) {
      H5Ldelete(file, "case", H5P_DEFAULT);
      put_text(file, "case", case_text);
      add_restart(file, name, restart);
      put_attribute(file, "ended", std::string("running"));
    });
  });
}

void TrajectoryWriter::append(TrajectoryStep step, const Row& summary, bool keep) {
  const auto columns = implementation_->columns;
  implementation_->file.change([step = std::move(step), summary, keep, columns](const std::string& name) {
    change_file(name, [&](hid_t file) {
      if (keep) keep_step(file, step);
      put_step(open_or_make_group(file, "last"), step, chunk_of(step.state));
      append_summary(file, columns, summary);
    });
  });
}

void TrajectoryWriter::end(const std::string& how) {
  implementation_->file.change([how](const std::string& name) {
    change_file(name, [&](hid_t file) { put_attribute(file, "ended", how); });
  });
}

}  // namespace nscdd
