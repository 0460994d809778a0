// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense.hpp"

#include <cblas.h>
#include <lapacke.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace nscdd::testing {
namespace {

constexpr int by_columns = LAPACK_COL_MAJOR;

lapack_int integer(Index n) { return static_cast<lapack_int>(n); }

// Distance of two columns, which LAPACK wants to be positive.
lapack_int stride(const Matrix& a) { return std::max<lapack_int>(1, integer(a.rows())); }

void require(lapack_int status, const std::string& routine) {
  if (status != 0) throw std::runtime_error(routine + " of LAPACK: status " + std::to_string(status));
}

// A = U diag(values) V^T.
struct Svd {
  Vector values;
  Matrix u, vt;

  explicit Svd(Matrix a)
      : values(std::min(a.rows(), a.cols())), u(a.rows(), values.size()), vt(values.size(), a.cols()) {
    if (values.size() == 0) return;
    require(LAPACKE_dgesdd(by_columns, 'S', integer(a.rows()), integer(a.cols()), a.data(), stride(a), values.data(),
                           u.data(), stride(u), vt.data(), stride(vt)),
            "dgesdd");
  }
  // Number of values above a part of the largest.
  Index rank(double threshold) const { return (values.array() > threshold * values.maxCoeff()).count(); }
  Matrix pseudo_inverse(double threshold) const {
    if (values.size() == 0) return Matrix::Zero(vt.cols(), u.rows());
    const Index kept = rank(threshold);
    return Dense(vt.topRows(kept).transpose()) * diagonal(values.head(kept).cwiseInverse()) *
           Dense(u.leftCols(kept).transpose());
  }
};

double rounding(const Dense& a) {
  return std::numeric_limits<double>::epsilon() * static_cast<double>(std::max(a.rows(), a.cols()));
}

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

// Products are those of BLAS: the linker may take Eigen's from a test that is compiled without optimisation.
Vector Dense::apply(const Vector& x) const {
  if (x.size() != cols()) throw std::runtime_error("product: expected a vector with a number for each column");
  Vector y = Vector::Zero(rows());
  if (rows() > 0 && cols() > 0)
    cblas_dgemv(CblasColMajor, CblasNoTrans, integer(rows()), integer(cols()), 1, entries_.data(), stride(entries_),
                x.data(), 1, 0, y.data(), 1);
  return y;
}

Dense zero(Index rows, Index columns) { return Matrix(Matrix::Zero(rows, columns)); }
Dense identity(Index n) { return Matrix(Matrix::Identity(n, n)); }
Dense diagonal(const Vector& entries) { return Matrix(entries.asDiagonal()); }

Dense operator-(const Dense& a) { return -1 * a; }
Dense operator+(const Dense& a, const Dense& b) { return Matrix(a.entries() + b.entries()); }
Dense operator-(const Dense& a, const Dense& b) { return Matrix(a.entries() - b.entries()); }
Dense operator*(const Dense& a, const Dense& b) {
  if (a.cols() != b.rows()) throw std::runtime_error("product: expected as many rows as the factor before has columns");
  Matrix c = Matrix::Zero(a.rows(), b.cols());
  if (c.size() > 0 && a.cols() > 0)
    cblas_dgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, integer(a.rows()), integer(b.cols()), integer(a.cols()), 1,
                a.entries().data(), stride(a.entries()), b.entries().data(), stride(b.entries()), 0, c.data(),
                stride(c));
  return c;
}
Dense operator*(double factor, const Dense& a) { return Matrix(factor * a.entries()); }
Dense operator*(const Dense& a, double factor) { return factor * a; }
Dense operator/(const Dense& a, double divisor) { return Matrix(a.entries() / divisor); }

Dense solve(const Dense& a, const Dense& b) {
  Matrix factors = a, x = b;
  std::vector<lapack_int> pivots(static_cast<std::size_t>(a.rows()));
  require(LAPACKE_dgesv(by_columns, integer(a.rows()), integer(b.cols()), factors.data(), stride(factors),
                        pivots.data(), x.data(), stride(x)),
          "dgesv");
  return x;
}

LinearMap solver(const Dense& a) {
  Matrix factors = a;
  std::vector<lapack_int> pivots(static_cast<std::size_t>(a.rows()));
  require(
      LAPACKE_dgetrf(by_columns, integer(a.rows()), integer(a.rows()), factors.data(), stride(factors), pivots.data()),
      "dgetrf");
  return [factors, pivots](Vector x) -> Vector {
    require(LAPACKE_dgetrs(by_columns, 'N', integer(x.size()), 1, factors.data(), stride(factors), pivots.data(),
                           x.data(), stride(factors)),
            "dgetrs");
    return x;
  };
}

double determinant(const Dense& a) {
  Matrix factors = a;
  std::vector<lapack_int> pivots(static_cast<std::size_t>(a.rows()));
  const lapack_int status =
      LAPACKE_dgetrf(by_columns, integer(a.rows()), integer(a.rows()), factors.data(), stride(factors), pivots.data());
  if (status < 0) require(status, "dgetrf");  // a positive one says that the matrix is singular
  double product = 1;
  for (Index k = 0; k < a.rows(); ++k)
    product *= pivots[static_cast<std::size_t>(k)] == integer(k + 1) ? factors(k, k) : -factors(k, k);
  return product;
}

Dense cholesky_factor(const Dense& p) {
  Matrix lower = Matrix(p).triangularView<Eigen::Lower>();
  require(LAPACKE_dpotrf(by_columns, 'L', integer(p.rows()), lower.data(), stride(lower)), "dpotrf");
  return lower;
}

Index rank(const Dense& a) { return a.entries().size() == 0 ? 0 : Svd(a).rank(rounding(a)); }

Dense pseudo_inverse(const Dense& a, double threshold) { return Svd(a).pseudo_inverse(threshold); }

Vector least_norm_solution(const Dense& a, const Vector& b) { return pseudo_inverse(a, rounding(a)) * b; }

Dense orthogonal_factor(const Dense& a) {
  const Index n = a.rows(), columns = std::min(n, a.cols());
  Matrix q = zero(n, n);
  q.leftCols(columns) = a.entries().leftCols(columns);
  Vector tau(columns);
  require(LAPACKE_dgeqrf(by_columns, integer(n), integer(columns), q.data(), stride(q), tau.data()), "dgeqrf");
  require(LAPACKE_dorgqr(by_columns, integer(n), integer(n), integer(columns), q.data(), stride(q), tau.data()),
          "dorgqr");
  return q;
}

Vector symmetric_eigenvalues(const Dense& a) {
  Matrix overwritten = a;
  Vector values(a.rows());
  require(
      LAPACKE_dsyev(by_columns, 'N', 'L', integer(a.rows()), overwritten.data(), stride(overwritten), values.data()),
      "dsyev");
  return values;
}

Vector pencil_eigenvalues(const Dense& a, const Dense& p) {
  Matrix overwritten = a, other = p;
  Vector values(a.rows());
  require(LAPACKE_dsygv(by_columns, 1, 'N', 'L', integer(a.rows()), overwritten.data(), stride(overwritten),
                        other.data(), stride(other), values.data()),
          "dsygv");
  return values;
}

Eigen::VectorXcd general_eigenvalues(const Dense& a) {
  Matrix overwritten = a;
  Vector real(a.rows()), imaginary(a.rows());
  require(LAPACKE_dgeev(by_columns, 'N', 'N', integer(a.rows()), overwritten.data(), stride(overwritten), real.data(),
                        imaginary.data(), nullptr, 1, nullptr, 1),
          "dgeev");
  Eigen::VectorXcd values(a.rows());
  for (Index k = 0; k < a.rows(); ++k) values[k] = {real[k], imaginary[k]};
  return values;
}

}  // namespace nscdd::testing
