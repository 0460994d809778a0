// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dense.hpp"
#include "linalg/krylov.hpp"
#include "linalg/random.hpp"
#include <nscdd/core/types.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace nscdd::testing {

Dense random_matrix(Index rows, Index columns, std::uint64_t seed);  ///< standard normal entries
Dense random_matrix(Index rows, Index columns, RandomStream& random);
Dense random_orthogonal(Index n, std::uint64_t seed);

/// A symmetric definite pencil whose eigenvalues are known: A = L Q diag(lambda) Q^T L^T, P = L L^T.
struct KnownPencil {
  KnownPencil(const Vector& eigenvalues, std::uint64_t seed);
  Dense a, p;
};

LinearMap map_of(const Dense& a);

/// x -> (A - sigma P)^-1 x by dense elimination.
LinearMap shifted_inverse(const KnownPencil& pencil, double sigma);

/// A symmetric matrix by its lower triangle, with the groups its rows are eliminated in.
struct SymmetricProblem {
  std::string name;
  SparseMatrix lower;
  std::vector<Index> group;
};

Matrix full(const SparseMatrix& lower);           ///< both triangles
SparseMatrix lower_triangle(const Matrix& full);  ///< entries that are not 0, and the whole diagonal

/// 0, 1, ..., n - 1: every row on its own.
std::vector<Index> single_rows(Index n);

/// Well-conditioned symmetric matrices of every shape an elimination meets: definite and indefinite, saddle points with
/// every multiplier in the group of the rows it ties, arrows, a diagonal, one row, disconnected blocks, dense.
std::vector<SymmetricProblem> every_symmetric_problem();

/// [K A^T; A -C], K = `first` on pairs of rows 2i, 2i + 1 and random couplings between pairs, multiplier i
/// tying 2i to 2i + 1, C = `last` on the diagonal. Groups: a pair with its multiplier.
SymmetricProblem saddle_point(Index pairs, double first, double last, std::uint64_t seed);

/// -Laplacian on a grid with h = 1 and zero values around it, minus a shift; its eigenvalues are
/// 4 sin^2(i pi / (2 (columns + 1))) + 4 sin^2(j pi / (2 (rows + 1))) - shift.
SparseMatrix shifted_laplacian(Index columns, Index rows, double shift);

/// max_i |b - A x|_i / (|A| |x| + |b|)_i for a symmetric matrix given by its lower triangle: the smallest
/// relative change of the data of which x is the exact solution (Oettli and Prager).
double backward_error(const SparseMatrix& lower, const Vector& x, const Vector& b);

}  // namespace nscdd::testing
