// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/contact_problem/siconos_dat.hpp"

#include <fmt/format.h>

namespace nscdd {
namespace {

void write_matrix(std::string& text, const SparseMatrix& matrix, const std::string& program) {
  Index first = 0;
  double norm = 0;
  for (Index j = 0; j < matrix.cols(); ++j) norm = std::max(norm, matrix.col(j).cwiseAbs().sum());
  const auto out = std::back_inserter(text);
  fmt::format_to(out,
                 "2\n{0}\n{1}\n2\n{2} (in the layout of CSparse)\n{0}-by-{1}, nzmax: {3} nnz: {3}, 1-norm: {4:g}\n",
                 matrix.rows(), matrix.cols(), program, matrix.nonZeros(), norm);
  for (Index j = 0; j < matrix.cols(); ++j) {
    const Index entries = matrix.col(j).nonZeros();
    fmt::format_to(out, "    col {} : locations {} to {}\n", j, first, first + entries - 1);
    for (SparseMatrix::InnerIterator e(matrix, j); e; ++e)
      fmt::format_to(out, "      {} : {:.17g}\n", e.row(), e.value());
    first += entries;
  }
}

void write_numbers(std::string& text, const Vector& values) {
  for (const double value : values) fmt::format_to(std::back_inserter(text), "{:32.24e} ", value);
  text += '\n';
}

}  // namespace

std::string siconos_text(const FclibFile& file, const std::string& program) {
  std::string text = fmt::format("{}\n{}\n", file.dimension(), file.contacts());
  if (const auto* local = std::get_if<LocalFrictionProblem>(&file.problem)) {
    write_matrix(text, local->w, program);
    write_numbers(text, local->q);
    write_numbers(text, local->friction);
  } else {
    const auto& global = std::get<GlobalFrictionProblem>(file.problem);
    write_matrix(text, global.mass, program);
    write_matrix(text, global.h, program);
    for (const Vector* values : {&global.f, &global.w, &global.friction}) write_numbers(text, *values);
  }
  return text;
}

}  // namespace nscdd
