// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// Both ends of the spectrum of a symmetric definite pencil, A x = lambda P x.
struct PencilEnds {
  std::string_view failure = {};     ///< reason for missing eigenvalues, else empty
  Vector low, high;                  ///< k eigenvalues from each end inwards: ascending, descending
  Matrix low_vectors, high_vectors;  ///< n x k, their eigenvectors, x^T P x = 1
  /// Largest ||A x - lambda P x||_{P^-1} / ||x||_P of these pairs. An eigenvalue lies this near to each value.
  double residual = not_a_number;
};

/// Ends of the spectrum of (A, P), A n x n symmetric, P n x n symmetric positive definite, n >= 1 (LAPACK): bisection
/// and inverse iteration on the tridiagonal form of L^-1 A L^-T, P = L L^T, for the k = min(wanted, n) eigenvalues of
/// each end, or QR iteration if these fail, as they may if many are equal. Fails if P has no Cholesky factor.
PencilEnds pencil_ends(const Matrix& a, const Matrix& p, Index wanted = 1);

/// Largest residual of such pairs for any pencil, P = L L^T.
double pair_residual(const Matrix& a, const Matrix& p, const Matrix& lower, const Vector& values,
                     const Matrix& vectors);

/// Eigenvalues or singular values, ascending, and their orthonormal vectors as columns.
struct ValuesAndVectors {
  Vector values;
  Matrix vectors;
};
enum class Eigenvectors { wanted, not_wanted };

/// All eigenvalues of a symmetric matrix, and its eigenvectors if wanted. The values are NaN if the QR iteration fails.
/// (Eigen's decompositions are slow to compile, so only this source does.)
ValuesAndVectors symmetric_eigen(const Matrix& a, Eigenvectors vectors = Eigenvectors::wanted);
/// All eigenvalues of a symmetric matrix, ascending, its lower triangle read (LAPACK dsyev); empty if it fails.
Vector symmetric_values(Matrix a);
/// Negative eigenvalues of a symmetric matrix, its lower triangle read, by the inertia of L D L^T (LAPACK dsytrf);
/// nothing if it is singular in double precision.
std::optional<Index> negative_eigenvalues(Matrix a);
/// Eigenvalues and eigenvectors of a tridiagonal matrix, given by its diagonal and subdiagonal.
ValuesAndVectors tridiagonal_eigen(const Vector& diagonal, const Vector& below);

/// The n singular values of an n x c matrix, with n - c zeros if c < n, and its left singular vectors (LAPACK dgesdd,
/// or dgesvd if that fails; no values if both fail). Small values keep digits that eigenvalues of A A^T lose.
ValuesAndVectors left_singular(Matrix a);

/// All eigenvalues of a general square matrix, n >= 1, with eigenvectors if wanted (LAPACK); none if it fails.
struct GeneralEigen {
  Eigen::VectorXcd values;
  Matrix packed;  ///< a column per real eigenvalue; real and imaginary part for the two of a pair, the upper one first

  Eigen::VectorXcd vector(Index k) const;
};
GeneralEigen general_eigen(Matrix a, Eigenvectors vectors = Eigenvectors::wanted);

/// B -> A^+ B by a complete orthogonal decomposition; pivots below `threshold` times the largest count as zero.
std::function<Matrix(const Matrix&)> minimum_norm_map(const Matrix& a, double threshold);

/// Orthonormal basis of n x m columns: n x rank. Pivots below 10^-10 times the largest count as zero.
Matrix orthonormal_basis(const Matrix& columns);

/// Orthonormal basis of the complement of n x m independent columns: n x (n - m).
Matrix orthonormal_complement(const Matrix& columns);

/// Orthonormal bases of the kernel of a symmetric positive semidefinite matrix and of its complement.
struct KernelSplit {
  Matrix kernel;       ///< n x m
  Matrix range;        ///< n x (n - m)
  double largest = 0;  ///< eigenvalue of the kernel, over that of the matrix
};

/// The kernel is the space of the `nullity` smallest eigenvalues.
KernelSplit split_kernel(const Matrix& s, Index nullity);

}  // namespace nscdd
