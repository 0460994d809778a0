// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "files/csv.hpp"
#include "formats/contact_problem/fclib_matrices.hpp"
#include "formats/contact_problem/siconos_dat.hpp"

namespace nscdd {
namespace {

using hdf5::Group;

constexpr std::pair<const char*, std::optional<std::string> FclibInfo::*> info_texts[] = {
    {"title", &FclibInfo::title}, {"description", &FclibInfo::description}, {"math_info", &FclibInfo::math_info}};

Vector numbers_of(const Group& group, const std::string& name, Index expected) {
  Vector values = vector_of(group, name);
  require_length(group, name, values.size(), expected);
  return values;
}

// D and the number of contacts. Throws Error for problems with members other than contacts.
std::pair<Index, Index> kind_of(const Group& group, const std::string& kind, const std::string& matrix,
                                std::initializer_list<std::pair<const char*, const char*>> refused) {
  const std::int64_t dimension = group.integer("spacedim");
  const Group counted = group.group(matrix);
  const std::int64_t columns = size_of(counted, "n");
  if (dimension != 2 && dimension != 3) fail("{}: expected 2 or 3, met {}", group.of("spacedim"), dimension);
  for (const auto& [member, meaning] : refused)
    if (group.has(member))
      fail("{}: not supported: a {} problem with {} ({}) ({} contacts, spacedim {}); expected contacts alone",
           group.path(), kind, meaning, member, columns / dimension, dimension);
  if (columns % dimension != 0)
    fail("{}: expected {} columns per contact, met {} columns", counted.of("n"), dimension == 2 ? "two" : "three",
         columns);
  return {dimension, columns / dimension};
}

LocalFrictionProblem read_local(const Group& group) {
  const auto [dimension, contacts] =
      kind_of(group, "local", "W", {{"V", "equality constraints"}, {"R", "equality constraints"}});
  const Group vectors = group.group("vectors");
  LocalFrictionProblem problem;
  problem.dimension = dimension;
  problem.q = numbers_of(vectors, "q", dimension * contacts);  // before the matrix, whose size it bounds
  problem.friction = numbers_of(vectors, "mu", contacts);
  problem.w = read_matrix(group, "W");
  check(problem, group.path());
  return problem;
}

GlobalFrictionProblem read_global(const Group& group) {
  const auto [dimension, contacts] = kind_of(group, "global", "H", {{"G", "equality constraints"}});
  const Group vectors = group.group("vectors");
  GlobalFrictionProblem problem;
  problem.dimension = dimension;
  problem.f = numbers_of(vectors, "f", size_of(group.group("M"), "m"));
  problem.w = numbers_of(vectors, "w", dimension * contacts);
  problem.friction = numbers_of(vectors, "mu", contacts);
  problem.mass = read_matrix(group, "M");
  problem.h = read_h(group, dimension);
  check(problem, group.path());
  return problem;
}

FclibInfo read_info(const Group& problem) {
  FclibInfo info;
  if (!problem.has("info")) return info;
  const Group group = problem.group("info");
  for (const auto& [name, text] : info_texts)
    if (group.has(name)) info.*text = group.text(name);
  return info;
}

FclibSolution read_solution(const Group& group, const FclibFile& file) {
  const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem);
  FclibSolution solution;
  if (global != nullptr && global->mass.rows() > 0) solution.v = numbers_of(group, "v", global->mass.rows());
  solution.u = numbers_of(group, "u", file.dimension() * file.contacts());
  solution.r = numbers_of(group, "r", file.dimension() * file.contacts());
  for (const Vector* values : {&solution.v, &solution.u, &solution.r})
    if (!values->allFinite()) fail("{}: expected finite numbers, met others", group.path());
  return solution;
}

std::vector<std::string> problems_in(const Group& root) {
  std::vector<std::string> found;
  for (const char* name : {"fclib_local", "fclib_global", "fclib_global_rolling"})
    if (root.has(name)) found.emplace_back(name);
  return found;
}

void write_numbers(const Group& group, const std::string& name, const Vector& values) {
  group.put<double>(name, {values.data(), at(values.size())});
}

template <class Value>
using Named = std::vector<std::pair<const char*, const Value*>>;

void write_problem(const Group& group, const Named<SparseMatrix>& matrices, const Named<Vector>& vectors,
                   Index dimension, const FclibInfo& info) {
  write_integer(group, "spacedim", dimension);
  for (const auto& [name, matrix] : matrices) write_matrix(group, name, *matrix);
  const Group parent = group.make_group("vectors");
  for (const auto& [name, values] : vectors) write_numbers(parent, name, *values);
  for (const auto& [name, text] : info_texts)
    if (info.*text) group.make_group("info").put_text(name, *(info.*text), true);
}

void write_solution(const Group& parent, const std::string& name, const FclibSolution& solution) {
  const Group group = parent.make_group(name);
  if (solution.v.size() > 0) write_numbers(group, "v", solution.v);
  write_numbers(group, "u", solution.u);
  write_numbers(group, "r", solution.r);
}

}  // namespace

Index FclibFile::contacts() const {
  return std::visit([](const auto& one) { return one.contacts(); }, problem);
}

Index FclibFile::dimension() const {
  return std::visit([](const auto& one) { return one.dimension; }, problem);
}

bool holds_fclib(std::string_view bytes, const std::string& name) {
  return !problems_in(hdf5::File(bytes, name).root()).empty();
}

FclibFile fclib_from_hdf5(std::string_view bytes, const std::string& name) {
  const hdf5::File file(bytes, name,
                        "a contact problem: HDF5 of FCLIB (.hdf5), text of Siconos (.dat) or Vloc_Rloc.INI");
  const Group root = file.root();
  const std::vector<std::string> problems = problems_in(root);
  if (problems.size() != 1)
    fail("{}: expected one group fclib_local or fclib_global, met {}", name,
         problems.empty() ? "none" : problems[0] + " and " + problems[1]);
  const Group group = root.group(problems[0]);
  FclibFile result;
  if (problems[0] == "fclib_local") {
    result.problem = read_local(group);
  } else if (problems[0] == "fclib_global") {
    result.problem = read_global(group);
  } else {
    fail("{}: not supported: rolling friction; expected fclib_local or fclib_global", group.path());
  }
  result.info = read_info(group);
  if (root.has("solution")) result.solution = read_solution(root.group("solution"), result);
  if (!root.has("guesses")) return result;
  const Group guesses = root.group("guesses");
  const std::int64_t number = size_of(guesses, "number_of_guesses");
  for (std::int64_t k = 1; k <= number; ++k)
    result.guesses.push_back(read_solution(guesses.group(std::to_string(k)), result));
  return result;
}

FclibFile read_fclib(const std::string& path) { return fclib_from_hdf5(read_text(path), path); }

GlobalFrictionProblem read_global_problem(const std::string& path, Matrix* points) {
  FclibFile file = read_contact_problem(path);
  if (points != nullptr) *points = file.points;
  if (auto* global = std::get_if<GlobalFrictionProblem>(&file.problem)) return std::move(*global);
  fail("{}: expected a global problem, with M and H, met a local one, which does not identify bodies", path);
}

std::string to_hdf5(const FclibFile& content, const Provenance& provenance) {
  return hdf5::new_file_bytes([&](const Group& root) {
    if (!provenance.empty()) hdf5::put_provenance(root, provenance);
    if (const auto* local = std::get_if<LocalFrictionProblem>(&content.problem))
      write_problem(root.make_group("fclib_local"), {{"W", &local->w}}, {{"q", &local->q}, {"mu", &local->friction}},
                    local->dimension, content.info);
    else if (const auto* global = std::get_if<GlobalFrictionProblem>(&content.problem))
      write_problem(root.make_group("fclib_global"), {{"M", &global->mass}, {"H", &global->h}},
                    {{"f", &global->f}, {"w", &global->w}, {"mu", &global->friction}}, global->dimension, content.info);
    if (content.solution) write_solution(root, "solution", *content.solution);
    if (content.guesses.empty()) return;
    const Group guesses = root.make_group("guesses");
    write_integer(guesses, "number_of_guesses", count(content.guesses));
    for (std::size_t k = 0; k < content.guesses.size(); ++k)
      write_solution(guesses, std::to_string(k + 1), content.guesses[k]);
  });
}

}  // namespace nscdd
