// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/enriched_inertia.hpp"

#include "core/lazy.hpp"
#include "linalg/ldlt/factor.hpp"
#include "linalg/pencil.hpp"
#include "linalg/range_projector.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace nscdd {
namespace {

// A_E without its empty rows.
SparseMatrix compact_rows(const SparseMatrix& a, const std::vector<Index>& rows) {
  SparseEntries entries;
  for (Index j = 0; j < a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(a, j); e; ++e)
      entries.add(std::lower_bound(rows.begin(), rows.end(), e.row()) - rows.begin(), j, e.value());
  return entries.matrix(count(rows), a.cols());
}

// Modes of one subdomain: M^-1/2 Q, their eigenvalues, and their traces on the interface, A M^-1/2 Q.
struct Modes {
  Matrix vectors;
  Vector eigenvalues;
  Matrix traces;

  Vector weights(double eta) const {
    return eigenvalues.unaryExpr(
        [eta](double lambda) { return lambda == 0 || std::isinf(eta) ? 1.0 : eta / (eta + lambda); });
  }
};

Modes diagonalise(const Subdomain& subdomain, const SparseMatrix& a) {
  const OneBlasThread serial_blas;
  if (subdomain.grains.empty()) return {Matrix(0, 0), Vector(0), Matrix(0, 0)};  // Eigen takes no empty matrix
  const Vector root = subdomain.inertia.cwiseSqrt().cwiseInverse();              // M^-1/2
  const Matrix b = root.asDiagonal() * Matrix(subdomain.h);                      // M^-1/2 H
  const auto [eigenvalues, vectors] = symmetric_eigen(b * b.transpose());
  Modes modes;
  modes.eigenvalues = eigenvalues;
  // There are as many zeros as H has dependent rows. This rank does not depend on masses.
  const Index nullity = subdomain.h.rows() - sparse_rank(subdomain.h);
  modes.eigenvalues.head(nullity).setZero();
  modes.eigenvalues = modes.eigenvalues.cwiseMax(0.0);
  modes.vectors = root.asDiagonal() * vectors;
  modes.traces = a * modes.vectors;
  return modes;
}

}  // namespace

std::vector<Index> interface_rows(const Subdomain& subdomain) {
  std::vector<Index> rows;
  for (Index j = 0; j < subdomain.a.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(subdomain.a, j); e; ++e) rows.push_back(e.row());
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

// What does not depend on eta.
class EnrichedInertiaFamily::Preparation {
 public:
  Preparation(const Subdomain& subdomain, Index dense_limit)
      : inertia(subdomain.inertia), h(subdomain.h), a(compact_rows(subdomain.a, interface_rows(subdomain))) {
    if (inertia.size() <= dense_limit) {
      modes = diagonalise(subdomain, a);
      return;
    }
    SparseMatrix zero_diagonal(inertia.size(), inertia.size());  // keeps a place for M in the pattern of K
    zero_diagonal.setIdentity();
    zero_diagonal.coeffs().setZero();
    stiffness = SparseMatrix(h * h.transpose()) + zero_diagonal;  // K = H H^T
    dofs_per_grain = inertia.size() / count(subdomain.grains);
  }

  // M + K / eta
  SparseMatrix sum(double eta) const {
    SparseMatrix m = stiffness / eta;
    m.diagonal() += inertia;
    return m;
  }

  const CholeskyAnalysis& analysis() const {
    return analysis_.get([this] { return CholeskyAnalysis(stiffness); });
  }

  // The interface grains come last, so that the trailing block of the factor is the condensed subdomain.
  const SymmetricAnalysis& condensation() const {
    return condensation_.get([this] {
      std::vector<Index> grain(nscdd::at(inertia.size()));
      for (Index i = 0; i < inertia.size(); ++i) grain[nscdd::at(i)] = i / dofs_per_grain;
      std::vector<char> shared(nscdd::at(inertia.size() / dofs_per_grain), 0);
      for (const Index i : glued_dofs()) shared[nscdd::at(i / dofs_per_grain)] = 1;
      return SymmetricAnalysis(SparseMatrix(stiffness.triangularView<Eigen::Lower>()), grain, shared);
    });
  }

  std::vector<Index> glued_dofs() const {  // columns of A_E that are not empty, ascending
    std::vector<Index> dofs;
    for (Index j = 0; j < a.outerSize(); ++j)
      if (a.outerIndexPtr()[j + 1] > a.outerIndexPtr()[j]) dofs.push_back(j);
    return dofs;
  }

  Vector inertia;
  SparseMatrix h, a, stiffness;
  std::optional<Modes> modes;
  Index dofs_per_grain = 0;

 private:
  Lazy<CholeskyAnalysis> analysis_;
  Lazy<SymmetricAnalysis> condensation_;
};

class EnrichedInertia::Implementation {
 public:
  Implementation(std::shared_ptr<const EnrichedInertiaFamily::Preparation> p, double flexibility)
      : preparation(std::move(p)), eta(flexibility) {
    if (preparation->modes) weights = preparation->modes->weights(eta);
  }

  Matrix apply(const Matrix& r) const {
    const auto& p = *preparation;
    if (p.modes) return p.modes->vectors * (weights.asDiagonal() * (p.modes->vectors.transpose() * r));
    if (std::isinf(eta)) return p.inertia.cwiseInverse().asDiagonal() * r;
    if (eta > 0) {
      const SparseCholesky& factor = cholesky_.get([&] { return SparseCholesky(p.analysis(), p.sum(eta)); });
      if (!factor.positive_definite()) return Matrix::Constant(r.rows(), r.cols(), not_a_number);
      return factor.solve(r);
    }
    // The rigid limit, M^-1/2 (I - Pi) M^-1/2
    const RangeProjector& range = range_.get([&] { return RangeProjector(scaled_connectivity(p.inertia, p.h)); });
    const Vector root = p.inertia.cwiseSqrt().cwiseInverse();
    Matrix scaled = root.asDiagonal() * r;
    for (Index j = 0; j < scaled.cols(); ++j) scaled.col(j) -= range.apply(scaled.col(j));
    return root.asDiagonal() * scaled;
  }

  std::shared_ptr<const EnrichedInertiaFamily::Preparation> preparation;
  double eta;
  Vector weights;  // of the modes of a small subdomain

 private:
  Lazy<RangeProjector> range_;
  Lazy<SparseCholesky> cholesky_;
};

EnrichedInertia::EnrichedInertia(std::shared_ptr<const Implementation> implementation)
    : implementation_(std::move(implementation)) {}

Vector EnrichedInertia::solve(const Vector& impulses) const {
  const OneBlasThread serial_blas;
  return implementation_->apply(impulses);
}

Matrix EnrichedInertia::condense() const {
  const OneBlasThread serial_blas;
  const auto& p = *implementation_->preparation;
  const double eta = implementation_->eta;
  if (p.modes) {
    const Matrix scaled = p.modes->traces * implementation_->weights.cwiseSqrt().asDiagonal();
    const Matrix product = scaled * scaled.transpose();
    return 0.5 * (product + product.transpose());
  }
  if (eta > 0 && !std::isinf(eta)) {
    const SymmetricFactor ldl(p.condensation(), p.sum(eta).triangularView<Eigen::Lower>());
    if (!ldl.regular() || ldl.negative_eigenvalues() > 0) return Matrix::Constant(p.a.rows(), p.a.rows(), not_a_number);
    const std::vector<Index> dofs = p.glued_dofs();
    const SparseMatrix gluing = selected_columns(p.a, dofs);  // A_E on these
    const Matrix condensed = gluing * (ldl.inverse_block(dofs) * gluing.transpose());
    return 0.5 * (condensed + condensed.transpose());
  }
  Matrix condensed(p.a.rows(), p.a.rows());
  constexpr Index block = 64;  // right-hand sides at a time, so that memory stays that of a few vectors
  const SparseMatrix transposed = p.a.transpose();
  for (Index first = 0; first < p.a.rows(); first += block) {
    const Index width = std::min(block, p.a.rows() - first);
    condensed.middleCols(first, width) = p.a * implementation_->apply(Matrix(transposed.middleCols(first, width)));
  }
  return 0.5 * (condensed + condensed.transpose());
}

EnrichedInertiaFamily::EnrichedInertiaFamily(const Subdomain& subdomain, Index dense_limit)
    : preparation_(std::make_shared<const Preparation>(subdomain, dense_limit)) {}

EnrichedInertia EnrichedInertiaFamily::at(double eta) const {
  if (!(eta >= 0)) throw Error(fmt::format("flexibility: expected a number in [0, inf], met {}", eta));
  return EnrichedInertia(std::make_shared<const EnrichedInertia::Implementation>(preparation_, eta));
}

}  // namespace nscdd
