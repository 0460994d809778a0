// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

#include <memory>
#include <utility>

namespace nscdd::testing {
namespace {

using CompleteQr = Eigen::CompleteOrthogonalDecomposition<Matrix>;

}  // namespace

Dense::Dense(Matrix entries) : entries_(std::move(entries)) {}
Dense::Dense(const SparseMatrix& entries) : entries_(entries) {}
Dense::operator Matrix() const { return entries_; }

double Dense::norm() const { return entries_.norm(); }
Dense Dense::transpose() const { return Matrix(entries_.transpose()); }
Dense Dense::inverse() const { return solve(*this, identity(rows())); }

Dense& Dense::operator+=(const Dense& other) {
  entries_ += other.entries_;
  return *this;
}

Vector Dense::apply(const Vector& x) const { return entries_ * x; }

Dense zero(Index rows, Index columns) { return Matrix(Matrix::Zero(rows, columns)); }
Dense identity(Index n) { return Matrix(Matrix::Identity(n, n)); }
Dense diagonal(const Vector& entries) { return Matrix(entries.asDiagonal()); }

Dense operator-(const Dense& a) { return -1 * a; }
Dense operator+(const Dense& a, const Dense& b) { return Matrix(a.entries() + b.entries()); }
Dense operator-(const Dense& a, const Dense& b) { return Matrix(a.entries() - b.entries()); }
Dense operator*(const Dense& a, const Dense& b) { return Matrix(a.entries() * b.entries()); }
Dense operator*(double factor, const Dense& a) { return Matrix(factor * a.entries()); }
Dense operator*(const Dense& a, double factor) { return factor * a; }
Dense operator/(const Dense& a, double divisor) { return Matrix(a.entries() / divisor); }

Dense solve(const Dense& a, const Dense& b) {
  return Matrix(Eigen::PartialPivLU<Matrix>(a.entries()).solve(b.entries()));
}

LinearMap solver(const Dense& a) {
  const auto lu = std::make_shared<Eigen::PartialPivLU<Matrix>>(a.entries());
  return [lu](const Vector& x) -> Vector { return Matrix(lu->solve(Matrix(x))); };
}

Index rank(const Dense& a) { return CompleteQr(a.entries()).rank(); }

Dense pseudo_inverse(const Dense& a, double threshold) {
  CompleteQr decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(a.entries());
  return Matrix(decomposition.pseudoInverse());
}

Vector least_norm_solution(const Dense& a, const Vector& b) { return Matrix(CompleteQr(a.entries()).solve(Matrix(b))); }

Dense orthogonal_factor(const Dense& a) { return Matrix(Eigen::HouseholderQR<Matrix>(a.entries()).householderQ()); }

Vector symmetric_eigenvalues(const Dense& a) {
  return Eigen::SelfAdjointEigenSolver<Matrix>(a.entries(), Eigen::EigenvaluesOnly).eigenvalues();
}

Vector pencil_eigenvalues(const Dense& a, const Dense& p) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(a.entries(), p.entries(), Eigen::EigenvaluesOnly)
      .eigenvalues();
}

Eigen::VectorXcd general_eigenvalues(const Dense& a) {
  return Eigen::EigenSolver<Matrix>(a.entries(), false).eigenvalues();
}

}  // namespace nscdd::testing
