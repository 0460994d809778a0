// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_cholesky.hpp"

#include "linalg/one_metis.hpp"
#include <nscdd/core/error.hpp>

#include <cholmod.h>

#include <new>

namespace nscdd {
namespace {

struct Workspace {
  cholmod_common common;
  Workspace() {
    cholmod_start(&common);
    common.print = 0;  // the library is silent: status codes are read instead
    // One fixed ordering, nested dissection: the best for the planar networks of grains.
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
    common.final_ll = 1;
    common.quick_return_if_not_posdef = 1;
  }
  ~Workspace() { cholmod_finish(&common); }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
};

// Eigen's arrays seen by CHOLMOD without a copy; stype -1 means the lower triangle is read.
cholmod_sparse view(const SparseMatrix& a) {
  cholmod_sparse s{};
  s.nrow = static_cast<std::size_t>(a.rows());
  s.ncol = static_cast<std::size_t>(a.cols());
  s.nzmax = static_cast<std::size_t>(a.nonZeros());
  s.p = const_cast<int*>(a.outerIndexPtr());
  s.i = const_cast<int*>(a.innerIndexPtr());
  s.x = const_cast<double*>(a.valuePtr());
  s.stype = -1;
  s.itype = CHOLMOD_INT;
  s.xtype = CHOLMOD_REAL;
  s.dtype = CHOLMOD_DOUBLE;
  s.sorted = 1;
  s.packed = 1;
  return s;
}

void require_memory(const cholmod_common& common, bool present) {
  if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE || !present)
    throw std::bad_alloc();
}

}  // namespace

class CholeskyAnalysis::Implementation {
 public:
  explicit Implementation(const SparseMatrix& pattern) {
    cholmod_sparse a = view(pattern);
    const auto lock = one_metis_at_a_time();
    factor = cholmod_analyze(&a, &workspace.common);
    require_memory(workspace.common, factor != nullptr);
  }
  ~Implementation() { cholmod_free_factor(&factor, &workspace.common); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  mutable Workspace workspace;
  cholmod_factor* factor = nullptr;
};

class SparseCholesky::Implementation {
 public:
  Implementation(const CholeskyAnalysis::Implementation& analysis, const SparseMatrix& matrix) {
    cholmod_sparse a = view(matrix);
    factor = cholmod_copy_factor(analysis.factor, &workspace.common);
    require_memory(workspace.common, factor != nullptr);
    const int done = cholmod_factorize(&a, factor, &workspace.common);
    require_memory(workspace.common, done != 0 || workspace.common.status == CHOLMOD_NOT_POSDEF);
    positive_definite = workspace.common.status == CHOLMOD_OK && factor->minor == factor->n;
  }
  ~Implementation() { cholmod_free_factor(&factor, &workspace.common); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  Matrix solve(const Matrix& b) const {
    cholmod_dense right{};
    right.nrow = static_cast<std::size_t>(b.rows());
    right.ncol = static_cast<std::size_t>(b.cols());
    right.nzmax = right.nrow * right.ncol;
    right.d = right.nrow;
    right.x = const_cast<double*>(b.data());
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor, &right, &workspace.common);
    require_memory(workspace.common, x != nullptr);
    Matrix result = Eigen::Map<const Matrix>(static_cast<const double*>(x->x), b.rows(), b.cols());
    cholmod_free_dense(&x, &workspace.common);
    return result;
  }

  mutable Workspace workspace;
  cholmod_factor* factor = nullptr;
  bool positive_definite = false;
};

CholeskyAnalysis::CholeskyAnalysis(const SparseMatrix& pattern)
    : implementation_(std::make_shared<const Implementation>(pattern)) {}

SparseCholesky::SparseCholesky(const CholeskyAnalysis& analysis, const SparseMatrix& a)
    : implementation_(std::make_shared<const Implementation>(*analysis.implementation_, a)) {}

bool SparseCholesky::positive_definite() const { return implementation_->positive_definite; }

Matrix SparseCholesky::solve(const Matrix& b) const { return implementation_->solve(b); }

}  // namespace nscdd
