// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cholmod.h>

#include <new>

namespace nscdd {

/// A factor of CHOLMOD, symbolic or numeric, with the settings and the status that belong to it: silent
/// (status codes are read instead), one fixed ordering, L L^T.
struct CholmodFactor {
  explicit CholmodFactor(int ordering) {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = ordering;
    common.postorder = 1;
    common.final_ll = 1;
    common.quick_return_if_not_posdef = 1;
  }
  ~CholmodFactor() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  /// Throws std::bad_alloc if the last call ran out of memory or gave no result.
  void require_memory(bool result) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE || !result) throw std::bad_alloc();
  }

  cholmod_common common;
  cholmod_factor* factor = nullptr;
};

/// The lower triangle of a symmetric n x n matrix, compressed by columns, as CHOLMOD sees it without a copy.
/// `values`: null for a pattern.
inline cholmod_sparse lower_triangle_view(std::size_t n, std::size_t entries, const int* start, const int* rows,
                                          const double* values) {
  cholmod_sparse a{};
  a.nrow = a.ncol = n;
  a.nzmax = entries;
  a.p = const_cast<int*>(start);
  a.i = const_cast<int*>(rows);
  a.x = const_cast<double*>(values);
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = values == nullptr ? CHOLMOD_PATTERN : CHOLMOD_REAL;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  a.packed = 1;
  return a;
}

}  // namespace nscdd
