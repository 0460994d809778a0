// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_file.hpp"
#include <nscdd/formats/fclib.hpp>

namespace nscdd {
namespace {

using hdf5::Group;

void write_integer(const Group& group, const std::string& name, Index value) {
  const auto number = static_cast<std::int32_t>(value);
  group.put<std::int32_t>(name, {&number, 1});
}

void write_numbers(const Group& group, const std::string& name, const Vector& values) {
  group.put<double>(name, {values.data(), at(values.size())});
}

void write_matrix(const Group& parent, const std::string& name, SparseMatrix matrix) {
  matrix.makeCompressed();
  const Group group = parent.make_group(name);
  write_integer(group, "nzmax", matrix.nonZeros());
  write_integer(group, "m", matrix.rows());
  write_integer(group, "n", matrix.cols());
  write_integer(group, "nz", -1);
  group.put<std::int32_t>("p", {matrix.outerIndexPtr(), at(matrix.cols() + 1)});
  group.put<std::int32_t>("i", {matrix.innerIndexPtr(), at(matrix.nonZeros())});
  group.put<double>("x", {matrix.valuePtr(), at(matrix.nonZeros())});
}

void write_info(const Group& problem, const FclibInfo& info) {
  if (!info.title && !info.description && !info.math_info) return;
  const Group group = problem.make_group("info");
  if (info.title) group.put_terminated_text("title", *info.title);
  if (info.description) group.put_terminated_text("description", *info.description);
  if (info.math_info) group.put_terminated_text("math_info", *info.math_info);
}

void write_problem(const Group& root, const LocalFrictionProblem& problem, const FclibInfo& info) {
  const Group group = root.make_group("fclib_local");
  write_integer(group, "spacedim", 2);
  write_matrix(group, "W", problem.w);
  const Group vectors = group.make_group("vectors");
  write_numbers(vectors, "q", problem.q);
  write_numbers(vectors, "mu", problem.friction);
  write_info(group, info);
}

void write_problem(const Group& root, const GlobalFrictionProblem& problem, const FclibInfo& info) {
  const Group group = root.make_group("fclib_global");
  write_integer(group, "spacedim", 2);
  write_matrix(group, "M", problem.mass);
  write_matrix(group, "H", problem.h);
  const Group vectors = group.make_group("vectors");
  write_numbers(vectors, "f", problem.f);
  write_numbers(vectors, "w", problem.w);
  write_numbers(vectors, "mu", problem.friction);
  write_info(group, info);
}

void write_solution(const Group& parent, const std::string& name, const FclibSolution& solution) {
  const Group group = parent.make_group(name);
  if (solution.v.size() > 0) write_numbers(group, "v", solution.v);
  write_numbers(group, "u", solution.u);
  write_numbers(group, "r", solution.r);
}

}  // namespace

std::string to_hdf5(const FclibFile& content, const Provenance& provenance) {
  return hdf5::new_file_bytes([&](const Group& root) {
    if (!provenance.empty()) hdf5::put_provenance(root, provenance);
    std::visit([&](const auto& problem) { write_problem(root, problem, content.info); }, content.problem);
    if (content.solution) write_solution(root, "solution", *content.solution);
    if (content.guesses.empty()) return;
    const Group guesses = root.make_group("guesses");
    write_integer(guesses, "number_of_guesses", count(content.guesses));
    for (std::size_t k = 0; k < content.guesses.size(); ++k)
      write_solution(guesses, std::to_string(k + 1), content.guesses[k]);
  });
}

}  // namespace nscdd
