// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/disjoint_sets.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/core/error.hpp>
#include <nscdd/mechanics/friction_problem.hpp>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

namespace nscdd {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr Index dense_up_to = 32;        // unknowns of a piece: a few bodies joined
constexpr Index columns_at_a_time = 64;  // of the right-hand sides of a large piece, dense

// Unknowns of each connected piece of the pattern of M, ascending.
std::vector<std::vector<Index>> pieces(const SparseMatrix& mass) {
  DisjointSets joined(mass.rows());
  for (Index j = 0; j < mass.cols(); ++j)
    for (SparseMatrix::InnerIterator e(mass, j); e; ++e)
      if (e.value() != 0) joined.join(e.row(), j);
  std::vector<Index> number(at(mass.rows()), -1);
  std::vector<std::vector<Index>> found;
  for (Index i = 0; i < mass.rows(); ++i) {
    Index& piece = number[at(joined.root(i))];
    if (piece < 0) {
      piece = count(found);
      found.emplace_back();
    }
    found[at(piece)].push_back(i);
  }
  return found;
}

// A piece of M, factorised.
class Piece {
 public:
  // `place`: local number of each unknown, filled in for those of this piece.
  Piece(const SparseMatrix& mass, const std::vector<Index>& unknowns, std::vector<Index>& place,
        const std::string& name) {
    for (Index i = 0; i < count(unknowns); ++i) place[at(unknowns[at(i)])] = i;
    SparseEntries entries;
    for (const Index j : unknowns)
      for (SparseMatrix::InnerIterator e(mass, j); e; ++e)
        if (e.value() != 0) entries.add(place[at(e.row())], place[at(j)], e.value());
    const SparseMatrix block = entries.matrix(count(unknowns), count(unknowns));
    bool definite = true;
    if (count(unknowns) <= dense_up_to) {
      dense_.compute(Matrix(block));
      definite = dense_.info() == Eigen::Success;
    } else {
      sparse_.emplace(CholeskyAnalysis(block), block);
      definite = sparse_->positive_definite();
    }
    if (!definite)
      throw Error(
          fmt::format("{}: M: expected a positive definite matrix, met one that is not in the piece of {} unknown(s) "
                      "that begins at row {}",
                      name, unknowns.size(), unknowns.front()));
  }

  Matrix solve(const Matrix& b) const { return sparse_ ? sparse_->solve(b) : Matrix(dense_.solve(b)); }

 private:
  Eigen::LLT<Matrix> dense_;
  std::optional<SparseCholesky> sparse_;
};

// Columns of H that touch a piece, ascending.
std::vector<Index> columns_of(const SparseRows& h, const std::vector<Index>& unknowns) {
  std::vector<Index> columns;
  for (const Index i : unknowns)
    for (SparseRows::InnerIterator e(h, i); e; ++e) columns.push_back(e.col());
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
  return columns;
}

// The rows `unknowns` of H, columns `first` ... `first + size - 1` of `columns`.
Matrix block_of(const SparseMatrix& h, const std::vector<Index>& columns, Index first, Index size,
                const std::vector<Index>& unknowns, const std::vector<Index>& place) {
  Matrix block = Matrix::Zero(count(unknowns), size);
  for (Index k = 0; k < size; ++k)
    for (SparseMatrix::InnerIterator e(h, columns[at(first + k)]); e; ++e) {
      const Index local = place[at(e.row())];
      if (local < count(unknowns) && unknowns[at(local)] == e.row()) block(local, k) += e.value();
    }
  return block;
}

// H_p^T M_p^-1 H_p of one piece, added to W.
void add_delassus(const GlobalFrictionProblem& problem, const Piece& piece, const std::vector<Index>& unknowns,
                  const std::vector<Index>& place, const std::vector<Index>& columns, SparseEntries& w) {
  for (Index first = 0; first < count(columns); first += columns_at_a_time) {
    const Index size = std::min(columns_at_a_time, count(columns) - first);
    const Matrix solved = piece.solve(block_of(problem.h, columns, first, size, unknowns, place));
    for (const Index row : columns)
      for (Index k = 0; k < size; ++k) {
        double value = 0;
        for (SparseMatrix::InnerIterator e(problem.h, row); e; ++e) {
          const Index local = place[at(e.row())];
          if (local < count(unknowns) && unknowns[at(local)] == e.row()) value += e.value() * solved(local, k);
        }
        w.add(row, columns[at(first + k)], value);
      }
  }
}

Vector gathered(const Vector& values, const std::vector<Index>& unknowns) {
  Vector part(count(unknowns));
  for (Index i = 0; i < part.size(); ++i) part[i] = values[unknowns[at(i)]];
  return part;
}

}  // namespace

LocalFrictionProblem reduce(const GlobalFrictionProblem& problem, const std::string& name) {
  const OneBlasThread serial_blas;
  check(problem, name);
  const Index size = problem.h.cols();
  const SparseRows rows = problem.h;
  std::vector<Index> place(at(problem.mass.rows()), 0);
  SparseEntries w;
  Vector free = Vector::Zero(problem.mass.rows());  // M^-1 f
  for (const std::vector<Index>& unknowns : pieces(problem.mass)) {
    const Piece piece(problem.mass, unknowns, place, name);
    add_delassus(problem, piece, unknowns, place, columns_of(rows, unknowns), w);
    const Vector solved = piece.solve(gathered(problem.f, unknowns));
    for (Index i = 0; i < solved.size(); ++i) free[unknowns[at(i)]] = solved[i];
  }
  LocalFrictionProblem local;
  local.w = w.matrix(size, size);
  local.q = problem.h.transpose() * free + problem.w;
  local.friction = problem.friction;
  check(local, name);
  return local;
}

Vector body_velocities(const GlobalFrictionProblem& problem, const Vector& impulses) {
  const OneBlasThread serial_blas;
  const Vector momentum = problem.h * impulses + problem.f;
  std::vector<Index> place(at(problem.mass.rows()), 0);
  Vector velocities(momentum.size());
  for (const std::vector<Index>& unknowns : pieces(problem.mass)) {
    const Vector solved = Piece(problem.mass, unknowns, place, "M").solve(gathered(momentum, unknowns));
    for (Index i = 0; i < solved.size(); ++i) velocities[unknowns[at(i)]] = solved[i];
  }
  return velocities;
}

}  // namespace nscdd
