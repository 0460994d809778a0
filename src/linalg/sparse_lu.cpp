// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_lu.hpp"

#include "linalg/threads.hpp"

#include <umfpack.h>

namespace nscdd {

struct UmfpackFactors {
  UmfpackFactors() {
    umfpack_di_defaults(control);
    control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    control[UMFPACK_ORDERING] = UMFPACK_ORDERING_AMD;
    control[UMFPACK_IRSTEP] = 0;
  }
  ~UmfpackFactors() {
    umfpack_di_free_numeric(&numeric);
    umfpack_di_free_symbolic(&symbolic);
  }
  UmfpackFactors(const UmfpackFactors&) = delete;
  UmfpackFactors& operator=(const UmfpackFactors&) = delete;

  double control[UMFPACK_CONTROL] = {}, info[UMFPACK_INFO] = {};
  double operations = 0;
  void *symbolic = nullptr, *numeric = nullptr;
};

namespace {

void require_memory(int status) {
  if (status == UMFPACK_ERROR_out_of_memory) throw std::bad_alloc();
}

}  // namespace

SparseLu::SparseLu(const SparseMatrix& pattern) : factors_(std::make_shared<UmfpackFactors>()) {
  const OneBlasThread serial_blas;
  const int n = static_cast<int>(pattern.rows());
  require_memory(umfpack_di_symbolic(n, n, pattern.outerIndexPtr(), pattern.innerIndexPtr(), nullptr,
                                     &factors_->symbolic, factors_->control, nullptr));
}

bool SparseLu::factorise(const SparseMatrix& a) {
  const OneBlasThread serial_blas;
  umfpack_di_free_numeric(&factors_->numeric);
  const int status = umfpack_di_numeric(a.outerIndexPtr(), a.innerIndexPtr(), a.valuePtr(), factors_->symbolic,
                                        &factors_->numeric, factors_->control, factors_->info);
  require_memory(status);
  factors_->operations += std::max(factors_->info[UMFPACK_FLOPS], 0.0);  // -1 where it did not get that far
  return status == UMFPACK_OK;
}

Vector SparseLu::solve(const SparseMatrix& a, const Vector& b) const {
  const OneBlasThread serial_blas;
  Vector x(b.size());
  require_memory(umfpack_di_solve(UMFPACK_A, a.outerIndexPtr(), a.innerIndexPtr(), a.valuePtr(), x.data(), b.data(),
                                  factors_->numeric, factors_->control, factors_->info));
  factors_->operations += std::max(factors_->info[UMFPACK_SOLVE_FLOPS], 0.0);
  return x;
}

int SparseLu::determinant_sign() const {
  double mantissa = 0, exponent = 0;
  require_memory(umfpack_di_get_determinant(&mantissa, &exponent, factors_->numeric, factors_->info));
  return mantissa < 0 ? -1 : 1;
}

double SparseLu::operations() const { return factors_->operations; }

}  // namespace nscdd
