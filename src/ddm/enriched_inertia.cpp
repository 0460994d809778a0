// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/enriched_inertia.hpp"

#include "core/fail.hpp"
#include "linalg/pencil.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

// With very unequal columns the short ones drown in rounding; factors, which scale each column, are then more exact.
bool similar_lengths(const SparseMatrix& h) {
  double longest = 0, shortest = infinity;
  for (Index j = 0; j < h.cols(); ++j)
    if (const double length = h.col(j).norm(); length > 0) {
      longest = std::max(longest, length);
      shortest = std::min(shortest, length);
    }
  return longest <= 1e3 * shortest;
}

}  // namespace

EnrichedInertiaFamily::EnrichedInertiaFamily(const Subdomain& subdomain, Index dense_limit)
    : inertia_(subdomain.inertia), h_(subdomain.h), centres_(subdomain.centres) {
  for_entries(subdomain.a, [&](Index row, Index, double) { rows_.push_back(row); });
  sort_unique(rows_);
  a_ = SparseMatrix(selected_columns(subdomain.a.transpose(), rows_).transpose());
  dofs_per_grain_ = inertia_.size() / std::max<Index>(count(subdomain.grains), 1);
  if (inertia_.size() <= dense_limit && similar_lengths(h_)) {
    modes_ = diagonalised();
    return;
  }
  // K = H H^T, with M in its pattern
  stiffness_ = SparseMatrix(h_ * h_.transpose()) + diagonal_matrix(Vector::Zero(inertia_.size()));
}

EnrichedInertiaFamily::Modes EnrichedInertiaFamily::diagonalised() const {
  const OneBlasThread serial_blas;
  if (inertia_.size() == 0) return {Matrix(0, 0), Vector(0), Matrix(0, 0), 0};  // Eigen takes no empty matrix
  const Vector root = inertia_.cwiseSqrt().cwiseInverse();                      // M^-1/2
  auto [values, vectors] = left_singular(root.asDiagonal() * Matrix(h_));       // of M^-1/2 H
  if (values.size() == 0) {                                                     // LAPACK has failed
    values.setConstant(inertia_.size(), not_a_number);
    vectors.setConstant(inertia_.size(), inertia_.size(), not_a_number);
  }
  // H has as many dependent rows as there are zeros. Its rank does not depend on masses.
  const Index zeros = h_.rows() - rigid_rank(dofs_per_grain_, centres_, inertia_, h_).value;
  Modes modes;
  modes.tilt = zeros > 0 && zeros < values.size() ? values[zeros - 1] / values[zeros] : 0;
  if (!std::isfinite(modes.tilt)) modes.tilt = infinity;
  values.head(zeros).setZero();
  modes.eigenvalues = values.array().square();
  modes.vectors = root.asDiagonal() * vectors;
  modes.traces = a_ * modes.vectors;
  return modes;
}

SparseMatrix EnrichedInertiaFamily::sum(double eta) const {
  SparseMatrix m = stiffness_ / eta;
  m.diagonal() += inertia_;
  return m;
}

// Columns of A_E that are not empty, ascending.
std::vector<Index> EnrichedInertiaFamily::glued_dofs() const {
  std::vector<Index> dofs;
  for (Index j = 0; j < a_.outerSize(); ++j)
    if (a_.outerIndexPtr()[j + 1] > a_.outerIndexPtr()[j]) dofs.push_back(j);
  return dofs;
}

// The interface grains come last, so that the trailing block of the factor is the condensed subdomain.
const SymmetricAnalysis& EnrichedInertiaFamily::condensation() const {
  return condensation_.get([this] {
    std::vector<Index> grain(at(inertia_.size()));
    for (Index i = 0; i < inertia_.size(); ++i) grain[at(i)] = i / dofs_per_grain_;
    std::vector<char> shared(at(inertia_.size() / dofs_per_grain_), 0);
    for (const Index i : glued_dofs()) shared[at(i / dofs_per_grain_)] = 1;
    return SymmetricAnalysis(SparseMatrix(stiffness_.triangularView<Eigen::Lower>()), grain,
                             {.last = shared, .kept = {}});
  });
}

EnrichedInertia::EnrichedInertia(const EnrichedInertiaFamily& family, double eta) : family_(family), eta_(eta) {
  if (!(eta >= 0)) fail("flexibility: expected a number in [0, inf], met {}", eta);
  if (family.modes_)
    weights_ = family.modes_->eigenvalues.unaryExpr(
        [eta](double lambda) { return lambda == 0 || std::isinf(eta) ? 1.0 : eta / (eta + lambda); });
}

Matrix EnrichedInertia::apply(const Matrix& r) const {
  if (family_.modes_) {
    const Matrix& vectors = family_.modes_->vectors;
    return vectors * (weights_.asDiagonal() * (vectors.transpose() * r));
  }
  const Vector& inertia = family_.inertia_;
  if (std::isinf(eta_)) return inertia.cwiseInverse().asDiagonal() * r;
  if (eta_ > 0) {
    const auto analyse = [&] { return CholeskyAnalysis(family_.stiffness_); };
    const SparseCholesky& factor =
        cholesky_.get([&] { return SparseCholesky(family_.analysis_.get(analyse), family_.sum(eta_)); });
    if (!factor.positive_definite()) return Matrix::Constant(r.rows(), r.cols(), not_a_number);
    return factor.solve(r);
  }
  // The rigid limit, Z M^-1/2 (I - Pi) M^-1/2 Z^T
  const auto& [motions, range] = rigid();
  const Vector root = motions.inertia.cwiseSqrt().cwiseInverse();
  Matrix scaled = root.asDiagonal() * (motions.z.transpose() * r);
  for (Index j = 0; j < scaled.cols(); ++j) scaled.col(j) -= range.apply(scaled.col(j));
  return motions.z * (root.asDiagonal() * scaled);
}

const EnrichedInertia::RigidInverse& EnrichedInertia::rigid() const {
  return rigid_.get([this] {
    RigidMotions found = rigid_motions(family_.dofs_per_grain_, family_.centres_, family_.inertia_, family_.h_);
    RangeProjector projector(scaled_connectivity(found.inertia, found.h), rank_tolerance, Tilt::measured);
    return RigidInverse{std::move(found), std::move(projector)};
  });
}

double EnrichedInertia::uncertainty() const {
  if (eta_ > 0) return 0;
  const OneBlasThread serial_blas;
  return family_.modes_ ? family_.modes_->tilt : rigid().range.tilt();
}

Vector EnrichedInertia::solve(const Vector& impulses) const {
  const OneBlasThread serial_blas;
  return apply(impulses);
}

Matrix EnrichedInertia::condense() const {
  const OneBlasThread serial_blas;
  const SparseMatrix& a = family_.a_;
  Matrix condensed(a.rows(), a.rows());
  if (family_.modes_) {
    const Matrix scaled = family_.modes_->traces * weights_.cwiseSqrt().asDiagonal();
    condensed.noalias() = scaled * scaled.transpose();
  } else if (eta_ > 0 && !std::isinf(eta_)) {
    const SymmetricFactor ldl(family_.condensation(), family_.sum(eta_).triangularView<Eigen::Lower>());
    if (!ldl.regular() || ldl.negative_eigenvalues() > 0) return condensed.setConstant(not_a_number);
    const std::vector<Index> dofs = family_.glued_dofs();
    const SparseMatrix gluing = selected_columns(a, dofs);  // A_E on these
    condensed = gluing * (ldl.inverse_block(dofs) * gluing.transpose());
  } else {
    constexpr Index block = 64;  // right-hand sides at a time: the memory of a few vectors
    const SparseMatrix transposed = a.transpose();
    for (Index first = 0; first < a.rows(); first += block) {
      const Index width = std::min(block, a.rows() - first);
      condensed.middleCols(first, width) = a * apply(Matrix(transposed.middleCols(first, width)));
    }
  }
  return 0.5 * (condensed + condensed.transpose());
}

double stiffest(const Decomposition& parts) {
  double bound = 0;
  for (const Subdomain& subdomain : parts.subdomains) {
    if (subdomain.h.cols() == 0) continue;
    const SparseMatrix a = over_rows(subdomain.h.cwiseAbs(), subdomain.inertia.cwiseSqrt());
    const Vector rows = a * Vector::Ones(a.cols());
    bound = std::max(bound, (a.transpose() * rows).maxCoeff());
  }
  return parts.interface.processes().maximum(bound);
}

}  // namespace nscdd
