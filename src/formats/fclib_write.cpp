// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/hdf5_handles.hpp"
#include <nscdd/formats/fclib.hpp>

namespace nscdd {
namespace {

using hdf5::Handle;

void write_integer(hid_t group, const std::string& name, Index value) {
  const int number = static_cast<int>(value);
  hdf5::write_integers(group, name, {&number, 1});
}

void write_numbers(hid_t group, const std::string& name, const Vector& values) {
  hdf5::write_numbers(group, name, {values.data(), at(values.size())});
}

void write_matrix(hid_t parent, const std::string& name, SparseMatrix matrix) {
  matrix.makeCompressed();
  const Handle group = hdf5::new_group(parent, name);
  write_integer(group, "nzmax", matrix.nonZeros());
  write_integer(group, "m", matrix.rows());
  write_integer(group, "n", matrix.cols());
  write_integer(group, "nz", -1);
  hdf5::write_integers(group, "p", {matrix.outerIndexPtr(), at(matrix.cols() + 1)});
  hdf5::write_integers(group, "i", {matrix.innerIndexPtr(), at(matrix.nonZeros())});
  hdf5::write_numbers(group, "x", {matrix.valuePtr(), at(matrix.nonZeros())});
}

void write_info(hid_t problem, const FclibInfo& info) {
  if (!info.title && !info.description && !info.math_info) return;
  const Handle group = hdf5::new_group(problem, "info");
  if (info.title) hdf5::write_terminated_text(group, "title", *info.title);
  if (info.description) hdf5::write_terminated_text(group, "description", *info.description);
  if (info.math_info) hdf5::write_terminated_text(group, "math_info", *info.math_info);
}

void write_problem(hid_t file, const LocalFrictionProblem& problem, const FclibInfo& info) {
  const Handle group = hdf5::new_group(file, "fclib_local");
  write_integer(group, "spacedim", 2);
  write_matrix(group, "W", problem.w);
  const Handle vectors = hdf5::new_group(group, "vectors");
  write_numbers(vectors, "q", problem.q);
  write_numbers(vectors, "mu", problem.friction);
  write_info(group, info);
}

void write_problem(hid_t file, const GlobalFrictionProblem& problem, const FclibInfo& info) {
  const Handle group = hdf5::new_group(file, "fclib_global");
  write_integer(group, "spacedim", 2);
  write_matrix(group, "M", problem.mass);
  write_matrix(group, "H", problem.h);
  const Handle vectors = hdf5::new_group(group, "vectors");
  write_numbers(vectors, "f", problem.f);
  write_numbers(vectors, "w", problem.w);
  write_numbers(vectors, "mu", problem.friction);
  write_info(group, info);
}

void write_solution(hid_t parent, const std::string& name, const FclibSolution& solution) {
  const Handle group = hdf5::new_group(parent, name);
  if (solution.v.size() > 0) write_numbers(group, "v", solution.v);
  write_numbers(group, "u", solution.u);
  write_numbers(group, "r", solution.r);
}

}  // namespace

std::string to_hdf5(const FclibFile& file, const Provenance& provenance) {
  return hdf5::file_bytes([&](hid_t root) {
    if (!provenance.empty()) {
      const Handle origin = hdf5::new_group(root, "provenance");
      for (const auto& [name, text] : provenance) hdf5::write_text(origin, name, text);
    }
    std::visit([&](const auto& problem) { write_problem(root, problem, file.info); }, file.problem);
    if (file.solution) write_solution(root, "solution", *file.solution);
    if (file.guesses.empty()) return;
    const Handle guesses = hdf5::new_group(root, "guesses");
    write_integer(guesses, "number_of_guesses", count(file.guesses));
    for (std::size_t k = 0; k < file.guesses.size(); ++k)
      write_solution(guesses, std::to_string(k + 1), file.guesses[k]);
  });
}

}  // namespace nscdd
