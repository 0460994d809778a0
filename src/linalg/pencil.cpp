// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/linalg/pencil.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// Below this size one call that computes every vector is quicker than the staged computation.
constexpr Index small_size = 24;

// Eigenvector of the symmetric tridiagonal matrix (diagonal, off) for a computed eigenvalue lambda, by
// inverse iteration with partial pivoting. Two steps suffice: the shift is exact to rounding.
Vector tridiagonal_eigenvector(const Vector& diagonal, const Vector& off, double lambda) {
  const Index n = diagonal.size();
  const double norm = std::max(diagonal.cwiseAbs().maxCoeff(), n > 1 ? off.cwiseAbs().maxCoeff() : 0.0);
  const double smallest_pivot = std::max(norm, 1e-300) * 1e-16;
  // Rows of U: three diagonals (u0, u1, u2); `swapped` and `factor` record the elimination.
  Vector u0(n), u1 = Vector::Zero(n), u2 = Vector::Zero(n), factor = Vector::Zero(n);
  std::vector<char> swapped(at(n), 0);
  double d = diagonal[0] - lambda, e = n > 1 ? off[0] : 0.0;
  for (Index i = 0; i < n; ++i) {
    if (i + 1 == n) {
      u0[i] = d;
      break;
    }
    const double below = off[i], next_d = diagonal[i + 1] - lambda, next_e = i + 2 < n ? off[i + 1] : 0.0;
    if (std::abs(below) > std::abs(d)) {
      swapped[at(i)] = 1;
      factor[i] = d / below;
      u0[i] = below;
      u1[i] = next_d;
      u2[i] = next_e;
      d = e - factor[i] * next_d;
      e = -factor[i] * next_e;
    } else {
      if (std::abs(d) < smallest_pivot) d = smallest_pivot;
      factor[i] = below / d;
      u0[i] = d;
      u1[i] = e;
      d = next_d - factor[i] * e;
      e = next_e;
    }
  }
  for (Index i = 0; i < n; ++i)
    if (std::abs(u0[i]) < smallest_pivot) u0[i] = smallest_pivot;
  // A start with no symmetry, so that it is orthogonal to no eigenvector by construction.
  Vector x(n);
  for (Index i = 0; i < n; ++i) x[i] = 1.0 + 0.37 * std::sin(1.0 + 2.1 * static_cast<double>(i));
  for (int step = 0; step < 3; ++step) {
    if (step > 0)
      for (Index i = 0; i + 1 < n; ++i) {  // forward elimination of the right-hand side
        if (swapped[at(i)]) std::swap(x[i], x[i + 1]);
        x[i + 1] -= factor[i] * x[i];
      }
    for (Index i = n - 1; i >= 0; --i) {
      double sum = x[i];
      if (i + 1 < n) sum -= u1[i] * x[i + 1];
      if (i + 2 < n) sum -= u2[i] * x[i + 2];
      x[i] = sum / u0[i];
      if (std::abs(x[i]) > 1e100) x *= 1e-100 * 1e-100;
    }
    x.normalize();
  }
  return x;
}

}  // namespace

PencilSpectrum symmetric_pencil(const Matrix& a, const Matrix& p) {
  PencilSpectrum result;
  const Index n = a.rows();
  if (n == 0) return result;
  const Eigen::LLT<Matrix> cholesky(p);
  if (cholesky.info() != Eigen::Success || !p.allFinite()) {
    result.definite = false;
    return result;
  }
  const auto lower = cholesky.matrixL();
  Matrix c = lower.solve(a);               // L^-1 A
  c = lower.solve(c.transpose()).eval();   // L^-1 (L^-1 A)^T = L^-1 A L^-T
  c = (0.5 * (c + c.transpose())).eval();  // symmetric to the last bit

  Matrix ends(n, 2);  // eigenvectors of c at the low and at the high end
  if (n <= small_size) {
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(c);
    result.eigenvalues = solver.eigenvalues();
    ends.col(0) = solver.eigenvectors().col(0);
    ends.col(1) = solver.eigenvectors().col(n - 1);
  } else {
    const Eigen::Tridiagonalization<Matrix> tridiagonal(c);
    const Vector diagonal = tridiagonal.diagonal(), off = tridiagonal.subDiagonal();
    Eigen::SelfAdjointEigenSolver<Matrix> solver(n);
    solver.computeFromTridiagonal(diagonal, off, Eigen::EigenvaluesOnly);
    result.eigenvalues = solver.eigenvalues();
    ends.col(0) = tridiagonal_eigenvector(diagonal, off, result.eigenvalues[0]);
    ends.col(1) = tridiagonal_eigenvector(diagonal, off, result.eigenvalues[n - 1]);
    ends.applyOnTheLeft(tridiagonal.matrixQ());
  }
  const Matrix x = cholesky.matrixU().solve(ends);  // L^-T y, so that x^T P x = 1
  Matrix r = a * x;
  r.col(0) -= result.eigenvalues[0] * (p * x.col(0));
  r.col(1) -= result.eigenvalues[n - 1] * (p * x.col(1));
  r = lower.solve(r).eval();  // ||r||_{P^-1} = ||L^-1 r||
  result.residual = std::max(r.col(0).norm() / ends.col(0).norm(), r.col(1).norm() / ends.col(1).norm());
  return result;
}

KernelSplit split_kernel(const Matrix& s, const Vector& scale, double tolerance) {
  const Index n = s.rows();
  if (n == 0) return {Matrix(0, 0), Matrix(0, 0)};
  const Vector root = scale.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(root.asDiagonal() * s * root.asDiagonal());
  Index nullity = 0;
  while (nullity < n && solver.eigenvalues()[nullity] <= tolerance) ++nullity;
  // D^-1/2 z is null for S where z is null for D^-1/2 S D^-1/2; the full Q of its QR splits R^n.
  const Matrix kernel = root.asDiagonal() * solver.eigenvectors().leftCols(nullity);
  if (nullity == 0) return {Matrix(n, 0), Matrix::Identity(n, n)};
  const Matrix q = Eigen::HouseholderQR<Matrix>(kernel).householderQ();
  return {q.leftCols(nullity), q.rightCols(n - nullity)};
}

}  // namespace nscdd
