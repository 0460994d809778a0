// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/linalg/inertia_factor.hpp>

#include <complex>

namespace nscdd {

using LinearMap = std::function<Vector(const Vector&)>;  ///< a linear map x -> A x, for iterative solvers

inline constexpr Index arpack_smallest_size = 5;  ///< smallest problem of ARPACK; callers solve smaller ones densely

/// One end of the spectrum of a symmetric definite pencil A x = lambda M x.
struct LanczosResult {
  double value = 0;  ///< Ritz value at the end asked for
  Vector vector;     ///< its Ritz vector; empty if there is none
  bool converged = false;
};

enum class SpectrumEnd { smallest, largest };

/// Implicitly restarted Lanczos (ARPACK dsaupd, mode 2) in the inner product of M. `a`, `m`, `m_inverse`: x -> A x,
/// M x, M^-1 x, A symmetric, M symmetric positive definite. `start`: initial vector, such as that of a neighbouring
/// problem, plus a thousandth of a fixed vector, to escape a wrong eigenvector; if empty, the fixed vector. Equal calls
/// give equal bits. Calls wait for each other (static memory). Throws Error for n < 5.
LanczosResult lanczos(Index n, const LinearMap& a, const LinearMap& m, const LinearMap& m_inverse, SpectrumEnd end,
                      const ArpackOptions& options = {}, const Vector& start = {});

/// Eigenvalue of largest modulus of a nonsymmetric operator.
struct ArnoldiResult {
  std::complex<double> value{not_a_number, not_a_number};  ///< of a complex pair, the one with positive imaginary part
  double residual = not_a_number;  ///< ||A x - lambda x|| / ||x||, recomputed with one more complex application
  Index applications = 0;
  Index units = 0;  ///< eigenvalues skipped because they lie within `unit_tolerance` of 1
  bool converged = false;
};

/// Implicitly restarted Arnoldi (ARPACK dnaupd, mode 1) for the eigenvalue of largest modulus, n >= 5. Several
/// eigenvalues are computed, so that a complex pair is never split; those nearer to 1 than `unit_tolerance` are
/// skipped; not converged if all of them are. The start vector is fixed.
ArnoldiResult arnoldi(Index n, const LinearMap& a, const ArpackOptions& options = {}, double unit_tolerance = 0);

/// Stopping criteria: a run stops once every wanted eigenvalue meets one of the two accuracies.
struct ShiftInvertOptions {
  Index maximum_steps = 300;  ///< Krylov vectors, cut to the size of the problem
  double tolerance = 1e-12;   ///< residual of nu = 1 / (lambda - sigma), relative to nu
  double accuracy = 0;        ///< estimated error of lambda (ShiftInvertResult::errors)
};

/// Eigenvalues of A x = lambda M x next to a shift sigma on one side of it, nearest first.
struct ShiftInvertResult {
  Vector values;   ///< Ritz values lambda, as many as wanted if there are as many on that side
  Matrix vectors;  ///< their vectors, n x k, M-orthonormal
  Vector bounds;   ///< an eigenvalue lies within this distance of each
  /// Expected distance, min(bound, residual^2 / gap to the next Ritz value). No proof: the gap may hide an eigenvalue.
  Vector errors;
  Index applications = 0;  ///< products with (A - sigma M)^-1
  bool converged = false;  ///< all wanted ones
};

/// A x = lambda M x next to a shift sigma, of `size` unknowns. M is symmetric positive definite.
struct ShiftedProblem {
  Index size;
  LinearMap solve;  ///< x -> (A - sigma M)^-1 x
  LinearMap m;      ///< x -> M x
  double sigma;
  double offset = 0;  ///< `solve` has the images (A - sigma M)^-1 M x without offset x; M may then be semidefinite
};

/// Shift-inverted Lanczos in the inner product of M, with full orthogonalisation, without restarts. `end` = smallest
/// looks above the shift, where the smallest eigenvalues lie if none is below it; largest looks below. `start`: initial
/// vector, such as that of a neighbouring problem, plus a tenth of a fixed vector, to escape a wrong eigenvector; if
/// empty, the fixed vector. `locked`: M-orthonormal eigenvectors to stay orthogonal to, size x l: each run finds one
/// copy of a multiple eigenvalue that is not locked. Equal calls give equal bits. Throws Error for a size < 5.
ShiftInvertResult shift_invert_lanczos(const ShiftedProblem& problem, SpectrumEnd end, Index wanted,
                                       const ShiftInvertOptions& options = {}, const Vector& start = {},
                                       const Matrix& locked = {});

}  // namespace nscdd
