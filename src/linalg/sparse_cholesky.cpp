// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_cholesky.hpp"

#include "linalg/cholmod_factor.hpp"
#include "linalg/one_metis.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

cholmod_sparse view(const SparseMatrix& a) {
  return lower_triangle_view(at(a.rows()), at(a.nonZeros()), a.outerIndexPtr(), a.innerIndexPtr(), a.valuePtr());
}

constexpr int ordering = CHOLMOD_METIS;  // nested dissection, the best for the planar networks of grains

}  // namespace

class CholeskyAnalysis::Implementation {
 public:
  explicit Implementation(const SparseMatrix& pattern) : symbolic(ordering) {
    cholmod_sparse a = view(pattern);
    const OneMetis one_at_a_time;
    symbolic.factor = cholmod_analyze(&a, &symbolic.common);
    symbolic.require_memory(symbolic.factor != nullptr);
  }
  CholmodFactor symbolic;
};

class SparseCholesky::Implementation {
 public:
  Implementation(const CholeskyAnalysis::Implementation& analysis, const SparseMatrix& matrix) : numeric_(ordering) {
    const OneBlasThread serial_blas;
    cholmod_sparse a = view(matrix);
    numeric_.factor = cholmod_copy_factor(analysis.symbolic.factor, &numeric_.common);
    numeric_.require_memory(numeric_.factor != nullptr);
    const int done = cholmod_factorize(&a, numeric_.factor, &numeric_.common);
    numeric_.require_memory(done != 0 || numeric_.common.status == CHOLMOD_NOT_POSDEF);
    positive_definite = numeric_.common.status == CHOLMOD_OK && numeric_.factor->minor == numeric_.factor->n;
  }

  Matrix solve(const Matrix& b) const {
    const OneBlasThread serial_blas;
    cholmod_dense right{};
    right.nrow = static_cast<std::size_t>(b.rows());
    right.ncol = static_cast<std::size_t>(b.cols());
    right.nzmax = right.nrow * right.ncol;
    right.d = right.nrow;
    right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, numeric_.factor, &right, &numeric_.common);
    numeric_.require_memory(x != nullptr);
    Matrix result = Eigen::Map<const Matrix>(static_cast<const double*>(x->x), b.rows(), b.cols());
    cholmod_free_dense(&x, &numeric_.common);
    return result;
  }

  bool positive_definite = false;

 private:
  mutable CholmodFactor numeric_;
};

CholeskyAnalysis::CholeskyAnalysis(const SparseMatrix& pattern)
    : implementation_(std::make_shared<const Implementation>(pattern)) {}

SparseCholesky::SparseCholesky(const CholeskyAnalysis& analysis, const SparseMatrix& a)
    : implementation_(std::make_shared<const Implementation>(*analysis.implementation_, a)) {}

bool SparseCholesky::positive_definite() const { return implementation_->positive_definite; }

Matrix SparseCholesky::solve(const Matrix& b) const { return implementation_->solve(b); }

}  // namespace nscdd
