// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/disjoint_sets.hpp"
#include "core/fail.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <optional>
#include <vector>

namespace nscdd {
namespace {

constexpr Index dense_up_to = 32;        // unknowns of a piece: a few bodies joined
constexpr Index columns_at_a_time = 64;  // of the right-hand sides of a large piece, dense

// The connected pieces of the pattern of M: the unknowns of each, ascending, and where each unknown is.
struct Pieces {
  std::vector<std::vector<Index>> unknowns;
  std::vector<Index> piece, place;

  explicit Pieces(const SparseMatrix& mass) : piece(at(mass.rows())), place(at(mass.rows())) {
    DisjointSets joined(mass.rows());
    for_entries(mass, [&](Index i, Index j, double value) {
      if (value != 0) joined.join(i, j);
    });
    std::vector<Index> number(at(mass.rows()), -1);
    for (Index i = 0; i < mass.rows(); ++i) {
      Index& p = number[at(joined.root(i))];
      if (p < 0) {
        p = count(unknowns);
        unknowns.emplace_back();
      }
      piece[at(i)] = p;
      place[at(i)] = count(unknowns[at(p)]);
      unknowns[at(p)].push_back(i);
    }
  }

  // The rows of a piece, from these columns of a matrix.
  SparseMatrix part(const SparseMatrix& matrix, Index p, const std::vector<Index>& columns) const {
    SparseEntries entries;
    for (Index k = 0; k < count(columns); ++k)
      for (SparseMatrix::InnerIterator e(matrix, columns[at(k)]); e; ++e)
        if (piece[at(e.row())] == p && e.value() != 0) entries.add(place[at(e.row())], k, e.value());
    return entries.matrix(count(unknowns[at(p)]), count(columns));
  }
};

// M of a piece, factorised.
class PieceFactor {
 public:
  PieceFactor(const SparseMatrix& mass, const Pieces& pieces, Index p, const std::string& name) {
    const std::vector<Index>& unknowns = pieces.unknowns[at(p)];
    const SparseMatrix block = pieces.part(mass, p, unknowns);
    bool definite = true;
    if (count(unknowns) <= dense_up_to) {
      dense_.compute(Matrix(block));
      definite = dense_.info() == Eigen::Success;
    } else {
      sparse_.emplace(CholeskyAnalysis(block), block);
      definite = sparse_->positive_definite();
    }
    if (!definite)
      fail(
          "{}: M: expected a positive definite matrix, met one that is not in the piece of {} unknown(s) that begins "
          "at row {}",
          name, unknowns.size(), unknowns.front());
  }

  Matrix solve(const Matrix& b) const { return sparse_ ? sparse_->solve(b) : Matrix(dense_.solve(b)); }

 private:
  Eigen::LLT<Matrix> dense_;
  std::optional<SparseCholesky> sparse_;
};

// Columns of H that touch each piece, ascending.
std::vector<std::vector<Index>> touching_columns(const SparseMatrix& h, const Pieces& pieces) {
  std::vector<std::vector<Index>> columns(pieces.unknowns.size());
  for_entries(h, [&](Index i, Index j, double) {
    std::vector<Index>& of_piece = columns[at(pieces.piece[at(i)])];
    if (of_piece.empty() || of_piece.back() != j) of_piece.push_back(j);
  });
  return columns;
}

// H_p^T M_p^-1 H_p of one piece, added to W.
void add_delassus(const PieceFactor& factor, const SparseMatrix& h, const std::vector<Index>& columns,
                  SparseEntries& w) {
  for (Index first = 0; first < count(columns); first += columns_at_a_time) {
    const Index size = std::min(columns_at_a_time, count(columns) - first);
    const Matrix block = h.transpose() * factor.solve(Matrix(h.middleCols(first, size)));
    for (Index i = 0; i < count(columns); ++i)
      for (Index k = 0; k < size; ++k) w.add(columns[at(i)], columns[at(first + k)], block(i, k));
  }
}

}  // namespace

LocalFrictionProblem reduce(const GlobalFrictionProblem& problem, const std::string& name) {
  const OneBlasThread serial_blas;
  check(problem, name);
  const Pieces pieces(problem.mass);
  const std::vector<std::vector<Index>> columns = touching_columns(problem.h, pieces);
  SparseEntries w;
  Vector free = Vector::Zero(problem.mass.rows());  // M^-1 f
  for (Index p = 0; p < count(pieces.unknowns); ++p) {
    const std::vector<Index>& unknowns = pieces.unknowns[at(p)];
    const PieceFactor factor(problem.mass, pieces, p, name);
    add_delassus(factor, pieces.part(problem.h, p, columns[at(p)]), columns[at(p)], w);
    free(unknowns) = factor.solve(problem.f(unknowns));
  }
  LocalFrictionProblem local;
  local.w = w.matrix(problem.h.cols(), problem.h.cols());
  local.q = problem.h.transpose() * free + problem.w;
  local.friction = problem.friction;
  check(local, name);
  return local;
}

Vector body_velocities(const GlobalFrictionProblem& problem, const Vector& impulses) {
  const OneBlasThread serial_blas;
  Vector velocities = problem.h * impulses + problem.f;
  const Pieces pieces(problem.mass);
  for (Index p = 0; p < count(pieces.unknowns); ++p)
    velocities(pieces.unknowns[at(p)]) =
        PieceFactor(problem.mass, pieces, p, "M").solve(velocities(pieces.unknowns[at(p)]));
  return velocities;
}

}  // namespace nscdd
