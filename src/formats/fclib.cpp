// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/csv.hpp"
#include "files/hdf5_file.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/formats/fclib.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace nscdd {
namespace {

using hdf5::Group;

constexpr std::int64_t largest_index = std::numeric_limits<int>::max();
constexpr std::array<const char*, 3> problem_groups{"fclib_local", "fclib_global", "fclib_global_rolling"};

Vector vector_of(const Group& group, const std::string& name) {
  const std::vector<double> values = group.numbers<double>(name);
  return Eigen::Map<const Vector>(values.data(), count(values));
}

void require_length(const Group& group, const std::string& name, Index met, Index expected) {
  if (met != expected) throw Error(fmt::format("{}: expected {} numbers, met {}", group.of(name), expected, met));
}

Vector numbers_of(const Group& group, const std::string& name, Index expected) {
  Vector values = vector_of(group, name);
  require_length(group, name, values.size(), expected);
  return values;
}

// The position of the first index outside 0 ... bound - 1, or -1 if there is none.
Index first_outside(const std::vector<std::int64_t>& indices, std::int64_t bound) {
  for (Index k = 0; k < count(indices); ++k)
    if (indices[at(k)] < 0 || indices[at(k)] >= bound) return k;
  return -1;
}

void require_inside(const Group& group, const std::string& name, const std::vector<std::int64_t>& indices,
                    std::int64_t bound) {
  const Index k = first_outside(indices, bound);
  if (k >= 0)
    throw Error(fmt::format("{}: expected indices in 0..{}, met {} at position {}", group.of(name), bound - 1,
                            indices[at(k)], k));
}

using Triplets = std::vector<Eigen::Triplet<double>>;

// nz >= 0: entry k lies at (p_k, i_k), or at (i_k, p_k) if only that fits the matrix.
Triplets triplet_entries(const Group& group, std::int64_t rows, std::int64_t columns, Index entries) {
  auto p = group.numbers<std::int64_t>("p"), i = group.numbers<std::int64_t>("i");
  const Vector x = vector_of(group, "x");
  require_length(group, "p", count(p), entries);
  require_length(group, "i", count(i), entries);
  if (x.size() < entries) require_length(group, "x", x.size(), entries);  // longer where nzmax is
  const bool documented = first_outside(p, rows) < 0 && first_outside(i, columns) < 0;
  const bool exchanged = first_outside(p, columns) < 0 && first_outside(i, rows) < 0;
  if (!documented && exchanged) std::swap(p, i);
  require_inside(group, "p", p, rows);
  require_inside(group, "i", i, columns);
  Triplets found;
  for (Index k = 0; k < entries; ++k) found.emplace_back(static_cast<int>(p[at(k)]), static_cast<int>(i[at(k)]), x[k]);
  return found;
}

// nz = -1 (lines are columns) or -2 (rows): line k holds entries p_k ... p_(k+1) - 1 at i within the line.
Triplets compressed_entries(const Group& group, std::int64_t lines, std::int64_t width, Index nzmax, bool by_columns) {
  const auto p = group.numbers<std::int64_t>("p"), i = group.numbers<std::int64_t>("i");
  const Vector x = vector_of(group, "x");
  require_length(group, "p", count(p), lines + 1);
  require_length(group, "i", count(i), nzmax);
  require_length(group, "x", x.size(), nzmax);
  if (p.front() != 0) throw Error(fmt::format("{}: expected 0 at position 0, met {}", group.of("p"), p.front()));
  for (Index k = 1; k < count(p); ++k)
    if (p[at(k)] < p[at(k - 1)] || p[at(k)] > nzmax)
      throw Error(fmt::format("{}: expected numbers that ascend to {} at most, met {} at position {}", group.of("p"),
                              nzmax, p[at(k)], k));
  require_inside(group, "i", i, width);
  Triplets found;
  for (Index line = 0; line < lines; ++line)
    for (Index k = p[at(line)]; k < p[at(line + 1)]; ++k) {
      const auto inner = static_cast<int>(i[at(k)]), outer = static_cast<int>(line);
      found.emplace_back(by_columns ? inner : outer, by_columns ? outer : inner, x[k]);
    }
  return found;
}

std::int64_t size_of(const Group& group, const std::string& name) {
  const std::int64_t size = group.integer(name);
  if (size < 0 || size >= largest_index)
    throw Error(fmt::format("{}: expected a number from 0 to {}, met {}", group.of(name), largest_index - 1, size));
  return size;
}

SparseMatrix read_matrix(const Group& parent, const std::string& name) {
  const Group group = parent.group(name);
  const std::int64_t rows = size_of(group, "m"), columns = size_of(group, "n");
  const std::int64_t nz = group.integer("nz"), nzmax = size_of(group, "nzmax");
  Triplets entries;
  if (nz == -1) {
    entries = compressed_entries(group, columns, rows, nzmax, true);
  } else if (nz == -2) {
    entries = compressed_entries(group, rows, columns, nzmax, false);
  } else if (nz >= 0 && nz <= nzmax) {
    entries = triplet_entries(group, rows, columns, nz);
  } else {
    throw Error(
        fmt::format("{}: expected -1 (by columns), -2 (by rows) or a number of triplets up to nzmax = {}, met {}",
                    group.of("nz"), nzmax, nz));
  }
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());  // entries met twice add up, as in CSparse
  return matrix;
}

[[noreturn]] void not_supported(const Group& group, const std::string& what, std::int64_t columns,
                                std::int64_t dimension) {
  throw Error(
      fmt::format("{}: not supported: {} ({} contacts, spacedim {}); expected a plane problem, spacedim "
                  "2, with contacts alone",
                  group.path(), what, dimension > 0 ? columns / dimension : 0, dimension));
}

// The number of contacts. Refuses everything but a plane problem with contacts alone.
Index plane_contacts(const Group& group, const std::string& kind, const std::string& matrix,
                     std::initializer_list<std::pair<const char*, const char*>> refused) {
  const std::int64_t dimension = group.integer("spacedim");
  const Group counted = group.group(matrix);
  const std::int64_t columns = size_of(counted, "n");
  if (dimension == 3) not_supported(group, fmt::format("a {} problem in three dimensions", kind), columns, dimension);
  if (dimension != 2) throw Error(fmt::format("{}: expected 2, met {}", group.of("spacedim"), dimension));
  for (const auto& [member, meaning] : refused)
    if (group.has(member))
      not_supported(group, fmt::format("a {} problem with {} ({})", kind, meaning, member), columns, dimension);
  if (columns % 2 != 0)
    throw Error(fmt::format("{}: expected two columns per contact, met {} columns", counted.of("n"), columns));
  return columns / 2;
}

LocalFrictionProblem read_local(const Group& group) {
  const Index contacts =
      plane_contacts(group, "local", "W", {{"V", "equality constraints"}, {"R", "equality constraints"}});
  const Group vectors = group.group("vectors");
  LocalFrictionProblem problem;
  problem.q = numbers_of(vectors, "q", 2 * contacts);  // first: they bound the sizes of the matrix
  problem.friction = numbers_of(vectors, "mu", contacts);
  problem.w = read_matrix(group, "W");
  check(problem, group.path());
  return problem;
}

GlobalFrictionProblem read_global(const Group& group) {
  const Index contacts = plane_contacts(group, "global", "H", {{"G", "equality constraints"}});
  const Group vectors = group.group("vectors");
  GlobalFrictionProblem problem;
  problem.f = numbers_of(vectors, "f", size_of(group.group("M"), "m"));
  problem.w = numbers_of(vectors, "w", 2 * contacts);
  problem.friction = numbers_of(vectors, "mu", contacts);
  problem.mass = read_matrix(group, "M");
  problem.h = read_matrix(group, "H");
  check(problem, group.path());
  return problem;
}

FclibInfo read_info(const Group& problem) {
  FclibInfo info;
  if (!problem.has("info")) return info;
  const Group group = problem.group("info");
  const auto text = [&](const char* name, std::optional<std::string>& value) {
    if (group.has(name)) value = group.text(name);
  };
  text("title", info.title);
  text("description", info.description);
  text("math_info", info.math_info);
  return info;
}

// How many velocities of bodies (0 for a local problem) and how many contact unknowns there are.
std::array<Index, 2> sizes(const FclibFile& file) {
  const auto* global = std::get_if<GlobalFrictionProblem>(&file.problem);
  return {global != nullptr ? global->mass.rows() : 0, 2 * file.contacts()};
}

FclibSolution read_solution(const Group& group, std::array<Index, 2> expected) {
  FclibSolution solution;
  if (expected[0] > 0) solution.v = numbers_of(group, "v", expected[0]);
  solution.u = numbers_of(group, "u", expected[1]);
  solution.r = numbers_of(group, "r", expected[1]);
  for (const Vector* values : {&solution.v, &solution.u, &solution.r})
    if (!values->allFinite()) throw Error(fmt::format("{}: expected finite numbers, met others", group.path()));
  return solution;
}

std::vector<FclibSolution> read_guesses(const Group& group, std::array<Index, 2> expected) {
  const std::int64_t number = size_of(group, "number_of_guesses");
  std::vector<FclibSolution> guesses;
  for (std::int64_t k = 1; k <= number; ++k) guesses.push_back(read_solution(group.group(std::to_string(k)), expected));
  return guesses;
}

std::vector<std::string> problems_in(const Group& root) {
  std::vector<std::string> found;
  for (const char* name : problem_groups)
    if (root.has(name)) found.emplace_back(name);
  return found;
}

}  // namespace

Index FclibFile::contacts() const {
  return std::visit([](const auto& one) { return one.contacts(); }, problem);
}

bool holds_fclib(std::string_view bytes, const std::string& name) {
  return !problems_in(hdf5::File(bytes, name).root()).empty();
}

FclibFile fclib_from_hdf5(std::string_view bytes, const std::string& name) {
  const hdf5::File file(bytes, name);
  const Group root = file.root();
  const std::vector<std::string> problems = problems_in(root);
  if (problems.size() != 1)
    throw Error(fmt::format("{}: expected one group fclib_local or fclib_global, met {}", name,
                            problems.empty() ? "none" : problems[0] + " and " + problems[1]));
  const Group group = root.group(problems[0]);
  FclibFile result;
  if (problems[0] == "fclib_local") {
    result.problem = read_local(group);
  } else if (problems[0] == "fclib_global") {
    result.problem = read_global(group);
  } else {
    throw Error(fmt::format("{}: not supported: rolling friction; expected fclib_local or fclib_global", group.path()));
  }
  result.info = read_info(group);
  if (root.has("solution")) result.solution = read_solution(root.group("solution"), sizes(result));
  if (root.has("guesses")) result.guesses = read_guesses(root.group("guesses"), sizes(result));
  return result;
}

FclibFile read_fclib(const std::string& path) { return fclib_from_hdf5(read_text(path), path); }

GlobalFrictionProblem read_global_problem(const std::string& path) {
  FclibFile file = read_fclib(path);
  if (auto* global = std::get_if<GlobalFrictionProblem>(&file.problem)) return std::move(*global);
  throw Error(fmt::format(
      "{}: expected a global problem, with M and H, met a local one, in which bodies cannot be told", path));
}

}  // namespace nscdd
