// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/disjoint_sets.hpp"
#include "core/fail.hpp"
#include "core/memory.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include "mechanics/contact_frame.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

#include <Eigen/Cholesky>

namespace nscdd {

// Largest difference of entries (i, j) and (j, i) of M, relative to the largest entry. Siconos writes six digits.
constexpr double symmetry_tolerance = 1e-5;
// The same of W. Public problems of bodies in space differ by up to 2.5 10^-3 (docs/formats.md).
constexpr double coupling_symmetry_tolerance = 5e-3;

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

void require_symmetric(const std::string& what, const SparseMatrix& matrix, double tolerance) {
  double largest = 0;
  bool above = false, below = false;
  for_entries(matrix, [&](Index i, Index j, double value) {
    largest = std::max(largest, std::abs(value));
    above = above || (i < j && value != 0);
    below = below || (i > j && value != 0);
  });
  for_entries(matrix - SparseMatrix(matrix.transpose()), [&](Index i, Index j, double difference) {
    if (std::abs(difference) > tolerance * largest)
      fail("{}: expected a symmetric matrix stored in full, met {} at ({}, {}) and {} at ({}, {}){}", what,
           matrix.coeff(i, j), i, j, matrix.coeff(j, i), j, i,
           above == below ? ""
           : above        ? ": only the upper triangle"
                          : ": only the lower triangle");
  });
}

void require_friction(const std::string& name, const Vector& friction) {
  require_finite(name + ": mu", friction);
  constexpr double most = 1e4;  // the natural map divides errors of u_n by it
  for (Index c = 0; c < friction.size(); ++c)
    if (!(friction[c] >= 0 && friction[c] <= most))
      fail("{}: mu: expected coefficients of friction from 0 to {}, met {} for contact {}", name, most, friction[c], c);
}

constexpr Index dense_up_to = 32;        // unknowns of a piece
constexpr Index columns_at_a_time = 64;  // dense right-hand sides

// The connected pieces of the pattern of M: the unknowns of each, ascending, and the piece and place of each unknown.
struct Pieces {
  std::vector<std::vector<Index>> unknowns;
  std::vector<Index> piece, place;

  explicit Pieces(const SparseMatrix& mass) : piece(at(mass.rows())), place(at(mass.rows())) {
    DisjointSets joined(mass.rows());
    for_entries(mass, [&](Index i, Index j, double value) {
      if (value != 0) joined.join(i, j);
    });
    for (Index i = 0; i < mass.rows(); ++i) piece[at(i)] = joined.root(i);
    piece = renumbered(std::move(piece));
    for (Index i = 0; i < mass.rows(); ++i) {
      const Index p = piece[at(i)];
      if (p == count(unknowns)) unknowns.emplace_back();
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

class PieceFactor {
 public:
  PieceFactor(const SparseMatrix& mass, const Pieces& pieces, Index p, const std::string& name) {
    const std::vector<Index>& unknowns = pieces.unknowns[at(p)];
    const SparseMatrix block = pieces.part(mass, p, unknowns);
    if (count(unknowns) <= dense_up_to)
      dense_.compute(Matrix(block));
    else
      sparse_.emplace(CholeskyAnalysis(block), block);
    if (!(sparse_ ? sparse_->positive_definite() : dense_.info() == Eigen::Success))
      fail(
          "{}: M: expected a positive definite matrix, met one that is not positive definite, in the piece of {} "
          "unknown(s) that begins at row {}",
          name, unknowns.size(), unknowns.front());
  }

  Matrix solve(const Matrix& b) const { return sparse_ ? sparse_->solve(b) : Matrix(dense_.solve(b)); }

 private:
  Eigen::LLT<Matrix> dense_;
  std::optional<SparseCholesky> sparse_;
};

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

void require_dimension(const std::string& name, Index dimension) {
  if (dimension != 2 && dimension != 3) fail("{}: dimension: expected 2 or 3, met {}", name, dimension);
}

bool positive_definite(const FullDelassus<2>& w) { return w.nn > 0 && w.tt > 0 && w.nn * w.tt - w.nt * w.nt > 0; }

// By the principal minors of the block without its normal component.
bool positive_definite(const FullDelassus<3>& w) {
  const auto [first, mixed, second] = w.schur_complement();
  return w.nn > 0 && first > 0 && second > 0 && first * second - mixed * mixed > 0;
}

std::string text_of(const FullDelassus<2>& w) { return fmt::format("[{} {}; {} {}]", w.nn, w.nt, w.nt, w.tt); }
std::string text_of(const FullDelassus<3>& w) {
  const auto& [first, mixed, second] = w.tt;
  return fmt::format("[{} {} {}; {} {} {}; {} {} {}]", w.nn, w.nt.first, w.nt.second, w.nt.first, first, mixed,
                     w.nt.second, mixed, second);
}

}  // namespace

void check(const LocalFrictionProblem& problem, const std::string& name) {
  require_dimension(name, problem.dimension);
  const Index size = problem.size();
  require_shape(name + ": W", problem.w, size, size);
  require_size(name + ": q", problem.q.size(), fmt::format("{} x contacts", problem.dimension), size);
  if (const Index dofs = problem.mass.rows(); dofs > 0 || problem.h.size() > 0) {
    require_shape(name + ": M", problem.mass, dofs, dofs);
    require_shape(name + ": H", problem.h, dofs, size);
  }
  if (problem.speeds.size() > 0) require_size(name + ": speeds", problem.speeds.size(), "contacts", problem.contacts());
  require_finite(name + ": W", problem.w);
  require_finite(name + ": q", problem.q);
  require_friction(name, problem.friction);
  require_symmetric(name + ": W", problem.w, coupling_symmetry_tolerance);
  in_dimension(problem, [&](auto dimension) {
    for (Index c = 0; c < problem.contacts(); ++c)
      if (const auto block = diagonal_block<dimension()>(problem, c); !positive_definite(block))
        fail("{}: W: expected a positive definite block for every contact, met {} for contact {}", name, text_of(block),
             c);
  });
}

void check(const GlobalFrictionProblem& problem, const std::string& name) {
  require_dimension(name, problem.dimension);
  const Index size = problem.size(), dofs = problem.mass.rows();
  require_shape(name + ": M", problem.mass, dofs, dofs);
  require_shape(name + ": H", problem.h, dofs, size);
  require_size(name + ": f", problem.f.size(), "rows of M", dofs);
  require_size(name + ": w", problem.w.size(), fmt::format("{} x contacts", problem.dimension), size);
  require_finite(name + ": M", problem.mass);
  require_finite(name + ": H", problem.h);
  require_finite(name + ": f", problem.f);
  require_finite(name + ": w", problem.w);
  require_friction(name, problem.friction);
  require_symmetric(name + ": M", problem.mass, symmetry_tolerance);
}

ReferenceProblem reference_problem(const GlobalFrictionProblem& problem, const std::string& name) {
  check(problem, name);
  const Index dofs = problem.dimension == 3 ? 6 : 3;
  if (problem.mass.rows() == 0 || problem.mass.rows() % dofs != 0)
    fail("{}: M: expected {}, met {} rows", name,
         dofs == 6 ? "six rows per body (three translations and three rotations)"
                   : "three rows per body (two translations and a rotation)",
         problem.mass.rows());
  for_entries(problem.mass, [&](Index i, Index j, double value) {
    if (i != j && value != 0) fail("{}: M: expected a diagonal matrix, met {} at row {}, column {}", name, value, i, j);
  });
  const Vector inertia = problem.mass.diagonal();
  for (Index i = 0; i < inertia.size(); ++i)
    if (!(inertia[i] > 0))
      fail("{}: M: expected positive numbers on the diagonal, met {} at row {}", name, inertia[i], i);
  return {.dimension = problem.dimension,
          .dofs_per_grain = dofs,
          .columns_per_contact = problem.dimension,
          .inertia = inertia,
          .h = problem.h,
          .arriving_velocity = problem.f.cwiseQuotient(inertia)};
}

LocalFrictionProblem reduce(const GlobalFrictionProblem& problem, const std::string& name) {
  const OneBlasThread serial_blas;
  check(problem, name);
  const Pieces pieces(problem.mass);
  std::vector<std::vector<Index>> columns(pieces.unknowns.size());  // of H that touch each piece, ascending
  for_entries(problem.h, [&](Index i, Index j, double) {
    std::vector<Index>& of_piece = columns[at(pieces.piece[at(i)])];
    if (of_piece.empty() || of_piece.back() != j) of_piece.push_back(j);
  });
  std::size_t entries = 0;
  for (const std::vector<Index>& of_piece : columns) entries += of_piece.size() * of_piece.size();
  // Triplets, and W twice, a number and an index per entry, while it is built.
  require_memory(static_cast<double>(entries) * (sizeof(Eigen::Triplet<double>) + 2 * 12),
                 fmt::format("W of {} contacts", problem.contacts()), "fewer contacts");
  SparseEntries w;
  w.reserve(entries);
  Vector free = Vector::Zero(problem.mass.rows());  // M^-1 f
  for (Index p = 0; p < count(pieces.unknowns); ++p) {
    const std::vector<Index>& unknowns = pieces.unknowns[at(p)];
    const PieceFactor factor(problem.mass, pieces, p, name);
    add_delassus(factor, pieces.part(problem.h, p, columns[at(p)]), columns[at(p)], w);
    free(unknowns) = factor.solve(problem.f(unknowns));
  }
  const Vector speeds = problem.h.cwiseAbs().transpose() * free.cwiseAbs() + problem.w.cwiseAbs();
  LocalFrictionProblem local{
      .w = w.matrix(problem.h.cols(), problem.h.cols()),
      .q = problem.h.transpose() * free + problem.w,
      .friction = problem.friction,
      .mass = problem.mass,
      .h = problem.h,
      .dimension = problem.dimension,
      .speeds = speeds.reshaped(problem.dimension, problem.contacts()).colwise().norm().transpose()};
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
