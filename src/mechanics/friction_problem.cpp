// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/sparse_entries.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

void require_size(const std::string& what, Index met, const std::string& size, Index expected) {
  if (met != expected) fail("{}: expected {} = {} numbers, met {}", what, size, expected, met);
}

void require_shape(const std::string& what, const SparseMatrix& matrix, Index rows, Index columns) {
  if (matrix.rows() != rows || matrix.cols() != columns)
    fail("{}: expected a {} x {} matrix, met {} x {}", what, rows, columns, matrix.rows(), matrix.cols());
}

void require_finite(const std::string& what, const Vector& values) {
  for (Index i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i])) fail("{}: expected finite numbers, met {} at position {}", what, values[i], i);
}

void require_finite(const std::string& what, const SparseMatrix& matrix) {
  for_entries(matrix, [&](Index i, Index j, double value) {
    if (!std::isfinite(value)) fail("{}: expected finite numbers, met {} at row {}, column {}", what, value, i, j);
  });
}

void require_symmetric(const std::string& what, const SparseMatrix& matrix) {
  double largest = 0;
  bool above = false, below = false;
  for_entries(matrix, [&](Index i, Index j, double value) {
    largest = std::max(largest, std::abs(value));
    above = above || (i < j && value != 0);
    below = below || (i > j && value != 0);
  });
  for_entries(matrix - SparseMatrix(matrix.transpose()), [&](Index i, Index j, double difference) {
    if (std::abs(difference) > symmetry_tolerance * largest)
      fail("{}: expected a symmetric matrix stored in full, met {} at ({}, {}) and {} at ({}, {}){}", what,
           matrix.coeff(i, j), i, j, matrix.coeff(j, i), j, i,
           above == below ? ""
           : above        ? ": the upper triangle alone"
                          : ": the lower triangle alone");
  });
}

void require_friction(const std::string& name, const Vector& friction) {
  require_finite(name + ": mu", friction);
  for (Index c = 0; c < friction.size(); ++c)
    if (friction[c] < 0)
      fail("{}: mu: expected coefficients of friction >= 0, met {} for contact {}", name, friction[c], c);
}

}  // namespace

FullDelassus diagonal_block(const LocalFrictionProblem& problem, Index contact) {
  const Index n = 2 * contact, t = n + 1;
  return {problem.w.coeff(n, n), (problem.w.coeff(n, t) + problem.w.coeff(t, n)) / 2, problem.w.coeff(t, t)};
}

void check(const LocalFrictionProblem& problem, const std::string& name) {
  const Index size = 2 * problem.contacts();
  require_shape(name + ": W", problem.w, size, size);
  require_size(name + ": q", problem.q.size(), "2 x contacts", size);
  require_finite(name + ": W", problem.w);
  require_finite(name + ": q", problem.q);
  require_friction(name, problem.friction);
  require_symmetric(name + ": W", problem.w);
  for (Index c = 0; c < problem.contacts(); ++c) {
    const FullDelassus block = diagonal_block(problem, c);
    if (!(block.nn > 0 && block.tt > 0 && block.nn * block.tt - block.nt * block.nt > 0))
      fail("{}: W: expected a positive definite block for every contact, met [{} {}; {} {}] for contact {}", name,
           block.nn, block.nt, block.nt, block.tt, c);
  }
}

void check(const GlobalFrictionProblem& problem, const std::string& name) {
  const Index size = 2 * problem.contacts(), dofs = problem.mass.rows();
  require_shape(name + ": M", problem.mass, dofs, dofs);
  require_shape(name + ": H", problem.h, dofs, size);
  require_size(name + ": f", problem.f.size(), "rows of M", dofs);
  require_size(name + ": w", problem.w.size(), "2 x contacts", size);
  require_finite(name + ": M", problem.mass);
  require_finite(name + ": H", problem.h);
  require_finite(name + ": f", problem.f);
  require_finite(name + ": w", problem.w);
  require_friction(name, problem.friction);
  require_symmetric(name + ": M", problem.mass);
}

ReferenceProblem reference_problem(const GlobalFrictionProblem& problem, const std::string& name) {
  check(problem, name);
  constexpr Index dofs = 3;
  if (problem.mass.rows() == 0 || problem.mass.rows() % dofs != 0)
    fail("{}: M: expected three rows per body (two translations and a rotation), met {} rows", name,
         problem.mass.rows());
  for_entries(problem.mass, [&](Index i, Index j, double value) {
    if (i != j && value != 0) fail("{}: M: expected a diagonal matrix, met {} at row {}, column {}", name, value, i, j);
  });
  const Vector inertia = problem.mass.diagonal();
  for (Index i = 0; i < inertia.size(); ++i)
    if (!(inertia[i] > 0))
      fail("{}: M: expected positive numbers on the diagonal, met {} at row {}", name, inertia[i], i);
  return {.dofs_per_grain = dofs,
          .columns_per_contact = 2,
          .inertia = inertia,
          .h = problem.h,
          .arriving_velocity = problem.f.cwiseQuotient(inertia)};
}

}  // namespace nscdd
