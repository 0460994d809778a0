// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/linear_operator.hpp"
#include <nscdd/linalg/arpack_options.hpp>

#include <complex>

namespace nscdd {

/// ARPACK cannot treat problems smaller than this; callers go dense below it.
inline constexpr Index arpack_smallest_size = 5;

/// One end of the spectrum of a symmetric definite pencil A x = lambda M x.
struct LanczosResult {
  double value = 0;        ///< Ritz value at the end asked for
  Vector vector;           ///< its Ritz vector; empty where the iteration produced none
  Index applications = 0;  ///< products with A, one solve with M each
  bool converged = false;
};

enum class SpectrumEnd { smallest, largest };

/// Implicitly restarted Lanczos (ARPACK dsaupd, mode 2) in the inner product of M.
/// `a`, `m`: x -> A x, M x; `m_inverse`: x -> M^-1 x; A symmetric, M symmetric positive definite, n >= 5.
/// `start`: where the iteration starts, such as the vector of a neighbouring problem; empty for a fixed
/// vector, a thousandth of which is added to any other, so that a wrong eigenvector is left. Equal calls give
/// equal bits. One call runs at a time (ARPACK keeps state in static memory); others wait. Throws Error for a
/// size ARPACK cannot take.
LanczosResult lanczos(Index n, const LinearMap& a, const LinearMap& m, const LinearMap& m_inverse, SpectrumEnd end,
                      const ArpackOptions& options = {}, const Vector& start = {});

/// Eigenvalue of largest modulus of a nonsymmetric operator.
struct ArnoldiResult {
  std::complex<double> value{not_a_number, not_a_number};  ///< of a complex pair, the one with positive imaginary part
  double residual = not_a_number;  ///< ||A x - lambda x|| / ||x||, recomputed with one more complex application
  Index applications = 0;
  Index units = 0;  ///< eigenvalues passed over because they lie within `unit_tolerance` of 1
  bool converged = false;
};

/// Implicitly restarted Arnoldi (ARPACK dnaupd, mode 1) for the eigenvalue of largest modulus, n >= 5.
/// Several eigenvalues are asked for, so that a complex pair is never cut in two; those nearer to 1 than
/// `unit_tolerance` are passed over (not converged where all of them are). Fixed start vector.
ArnoldiResult arnoldi(Index n, const LinearMap& a, const ArpackOptions& options = {}, double unit_tolerance = 0);

}  // namespace nscdd
