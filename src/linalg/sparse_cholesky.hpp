// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

struct CholmodFactor;

/// Ordering and fill pattern of the Cholesky factor of one sparsity pattern (CHOLMOD), computed once and used for
/// every matrix of that pattern. Throws std::bad_alloc if CHOLMOD runs out of memory.
class CholeskyAnalysis {
 public:
  /// `pattern`: n x n symmetric, n >= 1, lower triangle read, values ignored.
  explicit CholeskyAnalysis(const SparseMatrix& pattern);

  /// Largest number of bytes that CHOLMOD allocates to factorise a matrix of this pattern, its factor included.
  double bytes_at_once(const SparseMatrix& a) const;

 private:
  friend class SparseCholesky;
  std::shared_ptr<const CholmodFactor> symbolic_;
};

/// A = L L^T (up to a permutation) of a sparse symmetric positive definite matrix. If it is not so numerically,
/// `positive_definite()` is false and `solve` must not be called. Solve from one thread at a time.
class SparseCholesky {
 public:
  /// Throws Error before any work if the factor does not fit into memory (require_memory).
  SparseCholesky(const CholeskyAnalysis& analysis, const SparseMatrix& a);
  bool positive_definite() const { return positive_definite_; }
  Matrix solve(const Matrix& b) const;  ///< A^-1 b, n x k
  /// Floating-point operations of the factorisation and of a solve with one column, from the pattern of the factor.
  double factorisation_operations() const;
  double solve_operations() const;
  double bytes_at_most() const;  ///< that the factorisation took, as CHOLMOD counts them

 private:
  std::shared_ptr<CholmodFactor> numeric_;
  bool positive_definite_;
};

/// Neighbours of node g, without g itself and ascending, are neighbours[start[g]] ... neighbours[start[g + 1] - 1].
struct Graph {
  std::vector<int> start{0}, neighbours;
};

/// Nested dissection order (METIS). `weight`: of nodes; empty: 1. `seed`: -1 for METIS's own. Throws std::bad_alloc.
std::vector<int> nested_dissection(Graph graph, std::vector<int> weight, int seed);

/// Runs of columns of a Cholesky factor with equal rows below them. A "position" is a place in their order.
struct Supernodes {
  std::vector<int> node;          ///< at each position, the row of the matrix
  std::vector<int> first_column;  ///< supernode s eliminates positions first_column[s] ... first_column[s + 1] - 1
  std::vector<int> first_row;     ///< its rows are rows[first_row[s]] ... rows[first_row[s + 1] - 1]
  std::vector<int> rows;          ///< as positions, ascending; those that s eliminates come first
  Index size() const { return count(first_column) - 1; }
};

/// Largest numbers of columns of a supernode to be merged with its parent, with any number of zeros stored, with at
/// most 80 % of zeros, and with at most 10 %. The defaults are those of CHOLMOD.
using MergedColumns = std::array<std::size_t, 3>;
constexpr MergedColumns usually_merged{4, 16, 48};

/// The supernodes of a pattern as for CholeskyAnalysis, n >= 1, in this order up to merging. Throws std::bad_alloc.
Supernodes supernodes(const SparseMatrix& pattern, std::vector<int> order,
                      const MergedColumns& merged = usually_merged);

}  // namespace nscdd
