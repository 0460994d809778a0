// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/pencil.hpp"

#include "linalg/threads.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <lapacke.h>

namespace nscdd {
namespace {

using SymmetricSolver = Eigen::SelfAdjointEigenSolver<Matrix>;

// The symmetric tridiagonal matrix Q^T C Q, with Q kept as LAPACK's Householder vectors.
struct Tridiagonal {
  Matrix reflectors;
  Vector diagonal, off, tau;
};

Tridiagonal tridiagonalise(Matrix c) {
  const auto n = static_cast<lapack_int>(c.rows());
  Tridiagonal t{std::move(c), Vector(n), Vector(std::max(n - 1, 1)), Vector(std::max(n - 1, 1))};
  LAPACKE_dsytrd(LAPACK_COL_MAJOR, 'L', n, t.reflectors.data(), n, t.diagonal.data(), t.off.data(), t.tau.data());
  return t;
}

ValuesAndVectors eigen_of(const SymmetricSolver& solver, Eigenvectors vectors) {
  const Index n = solver.eigenvalues().size();
  if (solver.info() != Eigen::Success) return {Vector::Constant(n, not_a_number), Matrix::Zero(n, n)};
  return {solver.eigenvalues(), vectors == Eigenvectors::wanted ? solver.eigenvectors() : Matrix()};
}

// Largest || T v - lambda v || of pairs of a tridiagonal matrix T.
double residual_of(const ValuesAndVectors& pairs, const Tridiagonal& t) {
  const Index n = t.diagonal.size();
  const auto off = t.off.head(n - 1).asDiagonal();
  Matrix r = t.diagonal.asDiagonal() * pairs.vectors - pairs.vectors * pairs.values.asDiagonal();
  r.topRows(n - 1) += off * pairs.vectors.bottomRows(n - 1);
  r.bottomRows(n - 1) += off * pairs.vectors.topRows(n - 1);
  return r.colwise().norm().maxCoeff();
}

// Eigenvalues first ... last (from 1, ascending) of a tridiagonal matrix with unit eigenvectors, by bisection and
// inverse iteration. Empty if LAPACK finds too few values, or no vectors, as may happen if many are equal.
ValuesAndVectors some_pairs(const Tridiagonal& t, lapack_int first, lapack_int last) {
  const auto n = static_cast<lapack_int>(t.diagonal.size());
  const Index wanted = last - first + 1;
  lapack_int found = 0, blocks = 0;
  std::vector<lapack_int> block(at(n)), split(at(n)), failed(at(wanted));
  Vector value = Vector::Zero(n);                 // LAPACKE checks all n for NaN, of which a few are set
  const double finest = 2 * LAPACKE_dlamch('S');  // as accurate as bisection can be
  if (LAPACKE_dstebz('I', 'B', n, 0, 0, first, last, finest, t.diagonal.data(), t.off.data(), &found, &blocks,
                     value.data(), block.data(), split.data()) != 0 ||
      found != wanted)
    return {};
  Matrix vectors = Matrix::Zero(n, wanted);
  if (LAPACKE_dstein(LAPACK_COL_MAJOR, n, t.diagonal.data(), t.off.data(), static_cast<lapack_int>(wanted),
                     value.data(), block.data(), split.data(), vectors.data(), n, failed.data()) != 0)
    return {};
  std::vector<Index> order = natural_order(wanted);
  std::sort(order.begin(), order.end(), [&](Index i, Index j) { return value[i] < value[j]; });
  ValuesAndVectors pairs{value(order), vectors(Eigen::all, order)};
  const double largest = std::max(t.diagonal.cwiseAbs().maxCoeff(), t.off.cwiseAbs().maxCoeff());
  if (!(residual_of(pairs, t) <= 1e-14 * static_cast<double>(n) * largest)) return {};
  return pairs;
}

// The k first and last pairs. If bisection fails, the QR iteration computes all pairs.
std::pair<ValuesAndVectors, ValuesAndVectors> both_ends(const Tridiagonal& t, lapack_int k) {
  const auto n = static_cast<lapack_int>(t.diagonal.size());
  const ValuesAndVectors low = some_pairs(t, 1, k), high = some_pairs(t, n - k + 1, n);
  if (low.values.size() > 0 && high.values.size() > 0) return {low, high};
  const ValuesAndVectors all = tridiagonal_eigen(t.diagonal, t.off.head(n - 1));
  if (!all.values.allFinite()) return {};
  return {ValuesAndVectors{all.values.head(k), all.vectors.leftCols(k)},
          ValuesAndVectors{all.values.tail(k), all.vectors.rightCols(k)}};
}

}  // namespace

double pair_residual(const Matrix& a, const Matrix& p, const Matrix& lower, const Vector& values,
                     const Matrix& vectors) {
  const OneBlasThread serial_blas;
  Matrix r = a * vectors - p * vectors * values.asDiagonal();
  lower.triangularView<Eigen::Lower>().solveInPlace(r);  // ||r||_{P^-1} = ||L^-1 r||
  return r.colwise().norm().maxCoeff();
}

PencilEnds pencil_ends(const Matrix& a, const Matrix& p, Index wanted) {
  const OneBlasThread serial_blas;
  PencilEnds ends;
  const auto n = static_cast<lapack_int>(a.rows());
  const auto k = static_cast<lapack_int>(std::min<Index>(wanted, n));
  Matrix lower = p, c = a;
  if (!a.allFinite() || !p.allFinite()) return ends.failure = "an entry is not finite", ends;
  if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'L', n, lower.data(), n) != 0)  // P = L L^T
    return ends.failure = "P is not positive definite in double precision", ends;
  LAPACKE_dsygst(LAPACK_COL_MAJOR, 1, 'L', n, c.data(), n, lower.data(), n);  // C = L^-1 A L^-T
  const Tridiagonal t = tridiagonalise(std::move(c));                         // T = Q^T C Q
  const auto [low, high] = both_ends(t, k);
  if (low.values.size() == 0) return ends.failure = "LAPACK finds no eigenvalues", ends;
  Matrix y(n, 2 * k);
  y << low.vectors, high.vectors;
  if (n > 1)
    LAPACKE_dormtr(LAPACK_COL_MAJOR, 'L', 'L', 'N', n, 2 * k, t.reflectors.data(), n, t.tau.data(), y.data(),
                   n);                                               // Q y
  lower.transpose().triangularView<Eigen::Upper>().solveInPlace(y);  // L^-T Q y, so that x^T P x = 1
  Vector values(2 * k);
  values << low.values, high.values;
  ends.residual = pair_residual(a, p, lower, values, y);
  ends.low = low.values;
  ends.low_vectors = y.leftCols(k);
  ends.high = high.values.reverse();
  ends.high_vectors = y.rightCols(k).rowwise().reverse();
  return ends;
}

ValuesAndVectors symmetric_eigen(const Matrix& a, Eigenvectors vectors) {
  const int asked = vectors == Eigenvectors::wanted ? Eigen::ComputeEigenvectors : Eigen::EigenvaluesOnly;
  return eigen_of(SymmetricSolver(a, asked), vectors);
}

Vector symmetric_values(Matrix a) {
  const OneBlasThread serial_blas;
  const auto n = static_cast<lapack_int>(a.rows());
  Vector values(n);
  if (n > 0 && LAPACKE_dsyev(LAPACK_COL_MAJOR, 'N', 'L', n, a.data(), n, values.data()) != 0) return {};
  return values;
}

std::optional<Index> negative_eigenvalues(Matrix a) {
  const OneBlasThread serial_blas;
  const auto n = static_cast<lapack_int>(a.rows());
  std::vector<lapack_int> pivots(at(n));
  if (n > 0 && LAPACKE_dsytrf(LAPACK_COL_MAJOR, 'L', n, a.data(), n, pivots.data()) != 0) return std::nullopt;
  Index negative = 0;
  for (Index k = 0; k < n; ++k) {
    if (pivots[at(k)] < 0) {  // a 2 x 2 pivot of Bunch and Kaufman is indefinite
      ++negative;
      ++k;
    } else {
      negative += a(k, k) < 0;
    }
  }
  return negative;
}

ValuesAndVectors tridiagonal_eigen(const Vector& diagonal, const Vector& below) {
  SymmetricSolver solver;
  solver.computeFromTridiagonal(diagonal, below);
  return eigen_of(solver, Eigenvectors::wanted);
}

// A wide matrix is replaced by the L of its L Q, Q orthogonal.
ValuesAndVectors left_singular(Matrix a) {
  const auto rows = static_cast<lapack_int>(a.rows()), all = static_cast<lapack_int>(a.cols());
  const lapack_int columns = std::min(rows, all);
  ValuesAndVectors result{Vector::Zero(rows), Matrix::Identity(rows, rows)};
  if (columns == 0) return result;
  if (all > rows) {
    Vector scale(rows);
    LAPACKE_dgelqf(LAPACK_COL_MAJOR, rows, all, a.data(), rows, scale.data());
    a = Matrix(a.leftCols(rows).triangularView<Eigen::Lower>());
  }
  Vector descending(columns), unconverged(columns);
  Matrix u(rows, rows), v(columns, columns);
  const Matrix kept = a;  // LAPACK overwrites it
  if (LAPACKE_dgesdd(LAPACK_COL_MAJOR, 'A', rows, columns, a.data(), rows, descending.data(), u.data(), rows, v.data(),
                     columns) != 0 &&
      LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'A', 'N', rows, columns, (a = kept).data(), rows, descending.data(), u.data(),
                     rows, v.data(), columns, unconverged.data()) != 0)
    return {};
  result.values.tail(columns) = descending.reverse();
  result.vectors = u.rowwise().reverse();
  return result;
}

GeneralEigen general_eigen(Matrix a, Eigenvectors vectors) {
  const auto n = static_cast<lapack_int>(a.rows());
  Vector real(n), imaginary(n), scale(n);
  const bool wanted = vectors == Eigenvectors::wanted;
  GeneralEigen result{{}, Matrix(wanted ? n : 1, wanted ? n : 1)};
  lapack_int low = 0, high = 0;
  double norm = 0;
  // Not balanced ('N' first): with tiny entries, balancing costs eigenvectors half of their digits.
  if (LAPACKE_dgeevx(LAPACK_COL_MAJOR, 'N', 'N', wanted ? 'V' : 'N', 'N', n, a.data(), n, real.data(), imaginary.data(),
                     nullptr, 1, result.packed.data(), wanted ? n : 1, &low, &high, scale.data(), &norm, nullptr,
                     nullptr) == 0)
    result.values = real + std::complex<double>(0, 1) * imaginary;
  return result;
}

Eigen::VectorXcd GeneralEigen::vector(Index k) const {
  const double part = values[k].imag();
  if (part == 0) return packed.col(k);
  const Index first = part > 0 ? k : k - 1;
  return packed.col(first) + std::complex<double>(0, part > 0 ? 1 : -1) * packed.col(first + 1);
}

std::function<Matrix(const Matrix&)> minimum_norm_map(const Matrix& a, double threshold) {
  Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(a);
  return [decomposition](const Matrix& b) -> Matrix {
    if (b.cols() == 1) return Vector(decomposition.solve(Vector(b)));  // other bits than of a matrix with one column
    return decomposition.solve(b);
  };
}

Matrix orthonormal_basis(const Matrix& columns) {
  auto factors = columns.colPivHouseholderQr();
  factors.setThreshold(1e-10);
  return factors.householderQ() * Matrix::Identity(columns.rows(), factors.rank());
}

Matrix orthonormal_complement(const Matrix& columns) {
  return Matrix(Eigen::HouseholderQR<Matrix>(columns).householderQ()).rightCols(columns.rows() - columns.cols());
}

KernelSplit split_kernel(const Matrix& s, Index nullity) {
  const OneBlasThread serial_blas;
  const Index n = s.rows();
  if (nullity == 0) return {Matrix(n, 0), Matrix::Identity(n, n)};
  const auto [values, vectors] = symmetric_eigen(s);
  return {vectors.leftCols(nullity), vectors.rightCols(n - nullity),
          values[nullity - 1] / std::max(values[n - 1], 1e-300)};
}

}  // namespace nscdd
