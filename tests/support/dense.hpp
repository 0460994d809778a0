// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/krylov.hpp"
#include <nscdd/core/types.hpp>

namespace nscdd::testing {

/// Restricts an overload to vectors where there is one for matrices, too: Eigen converts either into the other.
template <class Expression>
concept VectorExpression = (Expression::ColsAtCompileTime == 1);

/// A dense matrix whose sums, products and inverses are plain functions, evaluated at once: formulas read as
/// printed, and no product is a new template that every test compiles again. The decompositions are LAPACK's, as an
/// independent judge of those of the library.
class Dense {
 public:
  Dense() = default;  ///< without entries
  Dense(Matrix entries);
  Dense(const SparseMatrix& entries);
  operator Matrix() const;

  Index rows() const { return entries_.rows(); }
  Index cols() const { return entries_.cols(); }
  const Matrix& entries() const { return entries_; }
  double norm() const;  ///< Frobenius
  Dense transpose() const;
  Dense inverse() const;  ///< by LU
  Dense& operator+=(const Dense& other);
  Vector apply(const Vector& x) const;  ///< A x
  Vector operator*(const VectorExpression auto& x) const { return apply(x); }

 private:
  Matrix entries_;
};

Dense zero(Index rows, Index columns);
Dense identity(Index n);
Dense diagonal(const Vector& entries);

Dense operator-(const Dense& a);
Dense operator+(const Dense& a, const Dense& b);
Dense operator-(const Dense& a, const Dense& b);
Dense operator*(const Dense& a, const Dense& b);
Dense operator*(double factor, const Dense& a);
Dense operator*(const Dense& a, double factor);
Dense operator/(const Dense& a, double divisor);

Dense solve(const Dense& a, const Dense& b);  ///< A^-1 B by LU
LinearMap solver(const Dense& a);             ///< x -> A^-1 x by one LU
Vector solve(const Dense& a, const VectorExpression auto& b) { return solver(a)(b); }

double determinant(const Dense& a);                           ///< by LU
Dense cholesky_factor(const Dense& p);                        ///< L of P = L L^T
Index rank(const Dense& a);                                   ///< singular values above rounding
Dense pseudo_inverse(const Dense& a, double threshold);       ///< A^+; singular values below threshold x largest are 0
Vector least_norm_solution(const Dense& a, const Vector& b);  ///< A^+ b
Dense orthogonal_factor(const Dense& a);                      ///< Q of A = Q R

Vector symmetric_eigenvalues(const Dense& a);               ///< ascending
Vector pencil_eigenvalues(const Dense& a, const Dense& p);  ///< A x = lambda P x, P definite; ascending
Eigen::VectorXcd general_eigenvalues(const Dense& a);       ///< of a matrix that need not be symmetric

}  // namespace nscdd::testing
