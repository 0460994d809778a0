// SPDX-License-Identifier: GPL-3.0-or-later
#include "spectra/balanced_spectrum.hpp"

#include "linalg/krylov.hpp"
#include "linalg/pencil.hpp"
#include "linalg/threads.hpp"

#include <Eigen/Cholesky>

namespace nscdd {

BalancedSpectrum::BalancedSpectrum(const PrimalInterface& interface, const CoarseProblem& coarse)
    : interface_(interface), coarse_(coarse), roots_(interface.subdomains.size()) {
  for_each_in_parallel(count(roots_), [&](Index e) {
    const CondensedSubdomain& one = interface_.subdomains[at(e)];
    if (!one.rows.empty()) roots_[at(e)] = one.weights * Eigen::LLT<Matrix>(one.flexibility).matrixL().toDenseMatrix();
  });
}

double BalancedSpectrum::largest(Index k) const {
  if (interface_.size() - k <= 0) return 1;
  if (const auto known = known_.find(k); known != known_.end()) return known->second;
  const OneBlasThread serial_blas;
  std::vector<Index> first{0};
  for (const Matrix& root : roots_) first.push_back(first.back() + root.cols());
  const auto product = [&](const Vector& y) {  // B^T (I - C Q) C B y, Q = U (U^T C U)^-1 U^T
    Vector u = Vector::Zero(interface_.size());
    for (std::size_t e = 0; e < roots_.size(); ++e)
      if (roots_[e].size() > 0) u(interface_.subdomains[e].rows) += roots_[e] * y.segment(first[e], roots_[e].cols());
    Vector p = interface_.apply(u);
    if (k > 0) p -= interface_.apply(coarse_.solve(p, k));
    Vector result(y.size());
    for (std::size_t e = 0; e < roots_.size(); ++e)
      if (roots_[e].size() > 0)
        result.segment(first[e], roots_[e].cols()) = roots_[e].transpose() * p(interface_.subdomains[e].rows);
    return result;
  };
  const Index n = first.back();
  if (n < arpack_smallest_size) {
    Matrix map(n, n);
    for (Index j = 0; j < n; ++j) map.col(j) = product(Vector::Unit(n, j));
    return known_[k] = symmetric_eigen(0.5 * (map + map.transpose()), Eigenvectors::not_wanted).values.maxCoeff();
  }
  const LinearMap same = [](const Vector& x) { return x; };
  const LanczosResult found = lanczos(n, product, same, same, SpectrumEnd::largest, {.basis = 60, .tolerance = 1e-10});
  return known_[k] = found.vector.size() > 0 ? std::max(1.0, found.value) : not_a_number;
}

std::optional<Index> BalancedSpectrum::fewest(double kappa) const {
  if (largest(0) <= kappa) return 0;
  Index too_few = 0, enough = coarse_.size();
  if (!(largest(enough) <= kappa) || std::isnan(largest(0))) return std::nullopt;
  Index next = coarse_.below(1 / kappa);  // the bound of GenEO would be sharp there
  while (enough - too_few > 1) {
    if (next <= too_few || next >= enough) next = (too_few + enough) / 2;
    const double value = largest(next);
    if (std::isnan(value)) return std::nullopt;
    (value <= kappa ? enough : too_few) = next;
    next = -1;
  }
  return enough;
}

const Matrix& BalancedSpectrum::whitened() const {
  if (!whitened_) {
    lower_ = Eigen::LLT<Matrix>(Matrix(interface_.sparse())).matrixL().toDenseMatrix();
    const auto upper = lower_->transpose().triangularView<Eigen::Upper>();
    const Matrix half = upper * interface_.dense_preconditioner();  // L^T N
    whitened_ = upper * half.transpose();
    *whitened_ = (0.5 * (*whitened_ + whitened_->transpose())).eval();
  }
  return *whitened_;
}

Matrix BalancedSpectrum::whitened_vectors(Index k) const {
  return lower_->transpose().triangularView<Eigen::Upper>() * coarse_.orthonormal().leftCols(k);
}

Vector BalancedSpectrum::all(Index k) const {
  const Index n = interface_.size();
  if (n > dense_limit || k >= n) return {};
  const OneBlasThread serial_blas;
  Matrix t = whitened();
  if (k > 0) {
    const Matrix complement = orthonormal_complement(whitened_vectors(k));
    t = complement.transpose() * (t * complement).eval();
  }
  return symmetric_values(std::move(t));
}

std::optional<Index> BalancedSpectrum::above(double shift, Index k) const {
  const Index n = interface_.size();
  if (n > dense_limit) return std::nullopt;
  const OneBlasThread serial_blas;
  Matrix bordered = Matrix::Zero(n + k, n + k);
  bordered.topLeftCorner(n, n) = -whitened();
  bordered.diagonal().head(n).array() += shift;
  if (k > 0) bordered.bottomLeftCorner(k, n) = whitened_vectors(k).transpose();
  const std::optional<Index> negative = negative_eigenvalues(std::move(bordered));
  return negative ? std::optional(*negative - k) : std::nullopt;
}

std::optional<double> BalancedSpectrum::proved_width(double lowest, double highest, Index k) const {
  const Index n = interface_.size(), left = n - k;
  if (!coarse_.is_orthonormal()) return std::nullopt;
  if (left <= 0) return end_width;
  const double rounding = 4 * 2.3e-16 * static_cast<double>(n) * largest(0);  // of an eigenvalue
  if (n > dense_limit || !(lowest > 0) || !(rounding <= largest_width * lowest)) return std::nullopt;
  const double width = std::max(end_width, rounding / lowest);
  const bool proved = above(highest * (1 + width), k) == Index{0} && above(highest * (1 - width), k) > Index{0} &&
                      above(lowest * (1 - width), k) == left;
  return proved ? std::optional(width) : std::nullopt;
}

Index fewest_deflated(const Vector& eigenvalues, double kappa) {
  Index fewest = eigenvalues.size();
  for (Index i = 0; i < eigenvalues.size(); ++i) {
    const double* const end = eigenvalues.data() + eigenvalues.size();
    fewest =
        std::min(fewest, std::max<Index>(i, end - std::upper_bound(eigenvalues.data(), end, kappa * eigenvalues[i])));
  }
  return fewest;
}

}  // namespace nscdd
