// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/linalg/pencil.hpp>

#include <Eigen/Eigenvalues>
#include <lapacke.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace nscdd {
namespace {

// The symmetric tridiagonal matrix Q^T C Q, with Q kept as LAPACK's Householder vectors.
struct Tridiagonal {
  Matrix reflectors;
  Vector diagonal, off, tau;
};

Tridiagonal tridiagonalise(Matrix c) {
  const auto n = static_cast<lapack_int>(c.rows());
  Tridiagonal t{{}, Vector(n), Vector(std::max(n - 1, 1)), Vector(std::max(n - 1, 1))};
  LAPACKE_dsytrd(LAPACK_COL_MAJOR, 'L', n, c.data(), n, t.diagonal.data(), t.off.data(), t.tau.data());
  t.reflectors = std::move(c);
  return t;
}

// Eigenvalue number k (from 1, ascending) of a tridiagonal matrix, its unit eigenvector put into `vector`;
// NaN where LAPACK fails.
double eigenpair(const Tridiagonal& t, lapack_int k, double* vector) {
  const auto n = static_cast<lapack_int>(t.diagonal.size());
  lapack_int found = 0, blocks = 0, failed = 0;
  std::vector<lapack_int> block(at(n)), split(at(n));
  Vector value = Vector::Zero(n);                 // LAPACKE looks for NaN in all n, of which one is set
  const double finest = 2 * LAPACKE_dlamch('S');  // as accurate as bisection can be
  if (LAPACKE_dstebz('I', 'B', n, 0, 0, k, k, finest, t.diagonal.data(), t.off.data(), &found, &blocks,
                     value.data(), block.data(), split.data()) != 0 ||
      found < 1 ||
      LAPACKE_dstein(LAPACK_COL_MAJOR, n, t.diagonal.data(), t.off.data(), 1, value.data(), block.data(),
                     split.data(), vector, n, &failed) != 0)
    return not_a_number;
  return value[0];
}

}  // namespace

PencilEnds pencil_ends(const Matrix& a, const Matrix& p) {
  PencilEnds ends;
  const auto n = static_cast<lapack_int>(a.rows());
  Matrix lower = p, c = a;
  ends.definite = p.allFinite() && a.allFinite() &&
                  LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, lower.data(), n) == 0;  // P = L L^T
  if (!ends.definite) return ends;
  LAPACKE_dsygst(LAPACK_COL_MAJOR, 1, 'L', n, c.data(), n, lower.data(), n);  // C = L^-1 A L^-T
  const Tridiagonal t = tridiagonalise(std::move(c));                         // T = Q^T C Q
  Matrix y(n, 2);
  ends.smallest = eigenpair(t, 1, y.col(0).data());
  ends.largest = eigenpair(t, n, y.col(1).data());
  if (n > 1)
    LAPACKE_dormtr(LAPACK_COL_MAJOR, 'L', 'L', 'N', n, 2, t.reflectors.data(), n, t.tau.data(), y.data(),
                   n);  // Q y
  const auto triangle = lower.triangularView<Eigen::Lower>();
  const Matrix x =
      lower.transpose().triangularView<Eigen::Upper>().solve(y);  // L^-T Q y, so that x^T P x = 1
  Matrix r = a * x;
  r.col(0) -= ends.smallest * (p * x.col(0));
  r.col(1) -= ends.largest * (p * x.col(1));
  r = triangle.solve(r).eval();  // ||r||_{P^-1} = ||L^-1 r||
  ends.residual = std::max(r.col(0).norm(), r.col(1).norm());
  ends.vectors = x;
  return ends;
}

KernelSplit split_kernel(const Matrix& s, Index nullity) {
  const Index n = s.rows();
  if (nullity == 0) return {Matrix(n, 0), Matrix::Identity(n, n)};
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(s);
  return {solver.eigenvectors().leftCols(nullity), solver.eigenvectors().rightCols(n - nullity)};
}

}  // namespace nscdd
