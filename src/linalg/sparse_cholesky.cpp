// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/sparse_cholesky.hpp"

#include "core/memory.hpp"
#include "linalg/threads.hpp"

#include <cholmod.h>
#include <fmt/format.h>
#include <metis.h>

#include <new>

namespace nscdd {

// A factor of CHOLMOD, symbolic or numeric, L L^T, with its settings (one ordering, no messages) and its status.
struct CholmodFactor {
  CholmodFactor() {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_GIVEN;
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

  // Throws std::bad_alloc if the last call ran out of memory or returned no result.
  void require_memory(bool result) const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE || !result) throw std::bad_alloc();
  }

  cholmod_common common;
  cholmod_factor* factor = nullptr;
};

namespace {

// The lower triangle of a symmetric matrix as CHOLMOD sees it without a copy.
cholmod_sparse view(const SparseMatrix& lower) {
  cholmod_sparse a{};
  a.nrow = a.ncol = at(lower.rows());
  a.nzmax = at(lower.nonZeros());
  a.p = const_cast<int*>(lower.outerIndexPtr());
  a.i = const_cast<int*>(lower.innerIndexPtr());
  a.x = const_cast<double*>(lower.valuePtr());
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_REAL;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  a.packed = 1;
  return a;
}

// The sum of the lengths of the columns of L to a power.
double column_lengths(const cholmod_factor& factor, int power) {
  const int* lengths = static_cast<const int*>(factor.ColCount);
  double sum = 0;
  for (std::size_t j = 0; j < factor.n; ++j) sum += std::pow(lengths[j], power);
  return sum;
}

}  // namespace

CholeskyAnalysis::CholeskyAnalysis(const SparseMatrix& pattern) {
  const SparseMatrix full = pattern.selfadjointView<Eigen::Lower>();
  Graph graph;
  for (Index j = 0; j < full.cols(); ++j) {
    for (SparseMatrix::InnerIterator e(full, j); e; ++e)
      if (e.row() != j) graph.neighbours.push_back(static_cast<int>(e.row()));
    graph.start.push_back(static_cast<int>(graph.neighbours.size()));
  }
  // METIS is best for planar networks of grains. CHOLMOD would not see METIS fail, and would lose a signal.
  std::vector<int> order = nested_dissection(std::move(graph), {}, -1);
  const auto symbolic = std::make_shared<CholmodFactor>();
  cholmod_sparse a = view(pattern);
  symbolic->factor = cholmod_analyze_p(&a, order.data(), nullptr, 0, &symbolic->common);
  symbolic->require_memory(symbolic->factor != nullptr);
  symbolic_ = symbolic;
}

double CholeskyAnalysis::bytes_at_once(const SparseMatrix& matrix) const {
  const cholmod_factor& factor = *symbolic_->factor;
  const auto of = [](double bytes, std::size_t number) { return bytes * static_cast<double>(number); };
  const double permuted_matrix = of(12, at(matrix.nonZeros())) + of(4, factor.n);
  if (factor.is_super == 0) return permuted_matrix + 12 * column_lengths(factor, 1) + of(48, factor.n);
  return permuted_matrix + of(8, factor.xsize + factor.maxcsize) + of(4, factor.ssize) + of(12, factor.nsuper) +
         of(28, factor.n);
}

SparseCholesky::SparseCholesky(const CholeskyAnalysis& analysis, const SparseMatrix& matrix)
    : numeric_(std::make_shared<CholmodFactor>()) {
  require_memory(analysis.bytes_at_once(matrix), fmt::format("a Cholesky factor of {} rows", matrix.rows()));
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

double SparseCholesky::factorisation_operations() const { return column_lengths(*numeric_->factor, 2); }
double SparseCholesky::solve_operations() const { return 4 * column_lengths(*numeric_->factor, 1); }
double SparseCholesky::bytes_at_most() const { return static_cast<double>(numeric_->common.memory_usage); }

std::vector<int> nested_dissection(Graph graph, std::vector<int> weight, int seed) {
  auto n = static_cast<idx_t>(graph.start.size() - 1);
  std::vector<idx_t> order(at(n)), position(at(n));
  std::iota(order.begin(), order.end(), 0);
  if (graph.neighbours.empty()) return order;  // METIS does not take a graph without edges
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = seed;
  const int status = metis_status([&] {
    return METIS_NodeND(&n, graph.start.data(), graph.neighbours.data(), weight.empty() ? nullptr : weight.data(),
                        options, order.data(), position.data());
  });
  if (status != METIS_OK) throw std::bad_alloc();
  return order;
}

Supernodes supernodes(const SparseMatrix& pattern, std::vector<int> order, const MergedColumns& merged) {
  cholmod_sparse a = view(pattern);
  CholmodFactor cholmod;
  cholmod.common.supernodal = CHOLMOD_SUPERNODAL;
  std::ranges::copy(merged, cholmod.common.nrelax);
  cholmod.factor = cholmod_analyze_p(&a, order.data(), nullptr, 0, &cholmod.common);
  cholmod.require_memory(cholmod.factor != nullptr && cholmod.common.status >= CHOLMOD_OK);
  const cholmod_factor& factor = *cholmod.factor;
  const auto numbers = [](const void* from, std::size_t size) {
    const auto* const first = static_cast<const int*>(from);
    return std::vector<int>(first, first + size);
  };
  const std::vector<int> first_row = numbers(factor.pi, factor.nsuper + 1);
  return {.node = numbers(factor.Perm, order.size()),
          .first_column = numbers(factor.super, factor.nsuper + 1),
          .first_row = first_row,
          .rows = numbers(factor.s, at(first_row.back()))};
}

}  // namespace nscdd
