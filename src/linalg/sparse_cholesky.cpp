// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_cholesky.hpp"

#include "linalg/cholmod_factor.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

constexpr int ordering = CHOLMOD_METIS;  // nested dissection, the best for the planar networks of grains

cholmod_sparse view(const SparseMatrix& a) {
  return lower_triangle_view(at(a.rows()), at(a.nonZeros()), a.outerIndexPtr(), a.innerIndexPtr(), a.valuePtr());
}

}  // namespace

CholeskyAnalysis::CholeskyAnalysis(const SparseMatrix& pattern) {
  const auto symbolic = std::make_shared<CholmodFactor>(ordering);
  cholmod_sparse a = view(pattern);
  const OneMetis one_at_a_time;
  symbolic->factor = cholmod_analyze(&a, &symbolic->common);
  symbolic->require_memory(symbolic->factor != nullptr);
  symbolic_ = symbolic;
}

SparseCholesky::SparseCholesky(const CholeskyAnalysis& analysis, const SparseMatrix& matrix)
    : numeric_(std::make_shared<CholmodFactor>(ordering)) {
  const OneBlasThread serial_blas;
  cholmod_sparse a = view(matrix);
  numeric_->factor = cholmod_copy_factor(analysis.symbolic_->factor, &numeric_->common);
  numeric_->require_memory(numeric_->factor != nullptr);
  const int done = cholmod_factorize(&a, numeric_->factor, &numeric_->common);
  numeric_->require_memory(done != 0 || numeric_->common.status == CHOLMOD_NOT_POSDEF);
  positive_definite_ = numeric_->common.status == CHOLMOD_OK && numeric_->factor->minor == numeric_->factor->n;
}

Matrix SparseCholesky::solve(const Matrix& b) const {
  const OneBlasThread serial_blas;
  cholmod_dense right{};
  right.nrow = right.d = at(b.rows());
  right.ncol = at(b.cols());
  right.nzmax = right.nrow * right.ncol;
  right.x = const_cast<double*>(b.data());
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, numeric_->factor, &right, &numeric_->common);
  numeric_->require_memory(x != nullptr);
  Matrix result = Eigen::Map<const Matrix>(static_cast<const double*>(x->x), b.rows(), b.cols());
  cholmod_free_dense(&x, &numeric_->common);
  return result;
}

}  // namespace nscdd
