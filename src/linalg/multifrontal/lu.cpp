// SPDX-License-Identifier: GPL-3.0-or-later
// See README.md, L U. U_12 is stored transposed: columns are exchanged and divided faster than rows.
#include "linalg/multifrontal/lu.hpp"

#include "core/fail.hpp"
#include "core/memory.hpp"
#include "linalg/multifrontal/fronts.hpp"
#include "linalg/sparse_entries.hpp"
#include "linalg/threads.hpp"

namespace nscdd {
namespace {

// Fronts of at most so many pivots are eliminated pivot by pivot: calls of LAPACK take longer than the arithmetic.
constexpr Index few_pivots = 16;

// Groups have several rows: zeros cost more than small fronts (measured with benchmarks/lu.cpp).
constexpr MergedColumns merged{1, 3, 8};

// Target of an entry of the matrix among the values of the factors.
struct LuEntry {
  int source;  // position among the stored values of the matrix
  std::ptrdiff_t target;
};

// The factors of a front, and its update for the parent.
struct LuFront {
  double *left, *upper;  // L_21 under L_11 and U_11, rows x pivots; U_12^T, update rows x pivots
  lapack_int* swaps;     // of the pivots, as LAPACK has them
  Index last_entry;      // its entries end before this one
  Matrix update;
};

SparseMatrix symmetric_lower(const SparseMatrix& pattern) {
  SparseEntries entries;
  for_entries(pattern, [&](Index i, Index j, double) { entries.add(std::max(i, j), std::min(i, j), 1); });
  for (Index i = 0; i < pattern.rows(); ++i) entries.add(i, i, 1);
  return entries.matrix(pattern.rows(), pattern.cols());
}

// Neighbouring rows tied to the same rows, as those of a body are, form a group.
std::vector<Index> groups_of_equal_rows(const SparseMatrix& lower) {
  std::vector<std::vector<Index>> tied(at(lower.rows()));
  for_entries(lower, [&](Index i, Index j, double) {
    tied[at(i)].push_back(j);
    if (i != j) tied[at(j)].push_back(i);
  });
  for (std::vector<Index>& rows : tied) std::ranges::sort(rows);
  std::vector<Index> group(tied.size(), 0);
  for (std::size_t i = 1; i < tied.size(); ++i) group[i] = group[i - 1] + Index{tied[i] != tied[i - 1]};
  return group;
}

Index values_of(const Front& front) { return front.pivots * (front.rows + front.update_rows()); }

// Eliminate a front: L_21 under L_11 and U_11 in `columns`, U_12^T in `rows`. False for a zero or infinite pivot.
bool eliminate_few(Block& columns, Block& rows, lapack_int* swaps) {
  const Index pivots = columns.cols();
  for (Index k = 0; k < pivots; ++k) {
    Index swapped = 0;
    columns.col(k).segment(k, pivots - k).cwiseAbs().maxCoeff(&swapped);
    swapped += k;
    swaps[k] = static_cast<lapack_int>(swapped) + 1;
    if (swapped != k) {
      columns.row(k).swap(columns.row(swapped));
      rows.col(k).swap(rows.col(swapped));
    }
    const double pivot = columns(k, k);
    if (pivot == 0 || !std::isfinite(pivot)) return false;
    auto below = columns.col(k).tail(columns.rows() - k - 1);
    below /= pivot;
    for (Index j = k + 1; j < pivots; ++j) {
      columns.col(j).tail(below.size()) -= columns(k, j) * below;
      rows.col(j) -= columns(j, k) * rows.col(k);
    }
  }
  return true;
}

bool eliminate_many(Block& columns, Block& rows, lapack_int* swaps) {
  const auto n = static_cast<lapack_int>(columns.cols());
  const auto pivots = columns.topRows(n);
  const lapack_int info =
      LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, columns.data(), static_cast<lapack_int>(columns.rows()), swaps);
  if (info != 0 || !pivots.diagonal().allFinite()) return false;
  if (rows.rows() == 0) return true;
  for (lapack_int k = 0; k < n; ++k)
    if (swaps[k] != k + 1) rows.col(k).swap(rows.col(swaps[k] - 1));
  pivots.triangularView<Eigen::UnitLower>().transpose().solveInPlace<Eigen::OnTheRight>(rows);
  auto below = columns.bottomRows(rows.rows());
  pivots.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(below);
  return true;
}

}  // namespace

struct LuFactors {
  explicit LuFactors(const SparseMatrix& pattern) {
    const SparseMatrix lower = symmetric_lower(pattern);
    tree = SymmetricAnalysis(lower, groups_of_equal_rows(lower), {}, {}, merged).tree();
    Index values = 0;
    for (const Front& front : tree->fronts) {
      values += values_of(front);
      largest_front = std::max(largest_front, front.rows);
      const auto rows = static_cast<double>(front.rows), rest = static_cast<double>(front.update_rows());
      operations_of_factorisation += 2.0 / 3 * (rows * rows * rows - rest * rest * rest);
    }
    operations_of_solve = 2.0 * static_cast<double>(values);
    bytes_at_once = factor_memory(*tree, FactorShape::full).at_once +
                    sizeof(LuEntry) * static_cast<double>(pattern.nonZeros()) +
                    sizeof(LuFront) * static_cast<double>(tree->size());
    require_memory(bytes_at_once, fmt::format("L U of {} rows", tree->rows));
    memory = large_array(values);
    swaps.resize(at(tree->rows));
    double* next = memory.get();
    lapack_int* next_swap = swaps.data();
    for (const Front& front : tree->fronts) {
      fronts.push_back(
          {.left = next, .upper = next + front.rows * front.pivots, .swaps = next_swap, .last_entry = 0, .update = {}});
      next += values_of(front);
      next_swap += front.pivots;
    }
    place_entries(pattern);
  }

  Block left(Index s) const {
    const Front& front = tree->front(s);
    return {fronts[at(s)].left, front.rows, front.pivots, Eigen::OuterStride<>(front.rows)};
  }
  Block upper(Index s) const {
    const Front& front = tree->front(s);
    const Index rows = front.update_rows();  // none at a root, where BLAS asks for a stride nevertheless
    return {fronts[at(s)].upper, rows, front.pivots, Eigen::OuterStride<>(std::max(rows, Index{1}))};
  }

  // An entry belongs to the front that eliminates the earlier of its two rows.
  void place_entries(const SparseMatrix& pattern) {
    struct Placed {
      int source;
      Index row, column;
    };
    std::vector<std::vector<Placed>> of_front(fronts.size());
    int source = 0;
    for_entries(pattern, [&](Index i, Index j, double) {
      of_front[at(std::min(tree->front_of_row[at(i)], tree->front_of_row[at(j)]))].push_back({source++, i, j});
    });
    std::vector<Index> place(at(tree->rows));
    for (Index s = 0; s < tree->size(); ++s) {
      const Front& front = tree->front(s);
      for (Index k = 0; k < front.rows; ++k) place[at(tree->rows_of(front)[k])] = k;
      for (const Placed& entry : of_front[at(s)]) {
        const Index row = place[at(entry.row)], column = place[at(entry.column)];
        const double* to = column < front.pivots ? &left(s)(row, column) : &upper(s)(column - front.pivots, row);
        entries.push_back({entry.source, to - memory.get()});
      }
      fronts[at(s)].last_entry = count(entries);
    }
  }

  // Entries of the matrix, then the updates of the children in their order.
  void assemble(Index s, const double* values) {
    const Front& front = tree->front(s);
    LuFront& own = fronts[at(s)];
    std::fill_n(own.left, values_of(front), 0.0);
    for (Index k = s == 0 ? 0 : fronts[at(s - 1)].last_entry; k < own.last_entry; ++k)
      memory.get()[entries[at(k)].target] += values[entries[at(k)].source];
    own.update.setZero(front.update_rows(), front.update_rows());
    for (const Index c : front.children) {
      const Matrix& from = fronts[at(c)].update;
      const int* place = tree->places_of_updates(tree->front(c));  // ascending
      for (Index j = 0; j < from.cols(); ++j) {
        const double* column = from.data() + j * from.rows();
        Index i = 0;
        if (place[j] < front.pivots) {
          double* to = own.left + place[j] * front.rows;
          for (; i < from.rows(); ++i) to[place[i]] += column[i];
          continue;
        }
        double* above = own.upper + (place[j] - front.pivots);
        for (; i < from.rows() && place[i] < front.pivots; ++i) above[place[i] * front.update_rows()] += column[i];
        double* to = own.update.data() + (place[j] - front.pivots) * front.update_rows() - front.pivots;
        for (; i < from.rows(); ++i) to[place[i]] += column[i];
      }
      fronts[at(c)].update.resize(0, 0);
    }
  }

  void eliminate(Index s, const double* values) {
    assemble(s, values);
    Block columns = left(s), rows = upper(s);
    if (!(columns.cols() <= few_pivots ? eliminate_few : eliminate_many)(columns, rows, fronts[at(s)].swaps))
      singular = true;
    else if (rows.rows() > 0)
      fronts[at(s)].update.noalias() -= columns.bottomRows(rows.rows()) * rows.transpose();
  }

  // `local`: room for the rows of a front.
  void go_forward(Index s, Vector& x, Vector& local) const {
    const Front& front = tree->front(s);
    const int* row = tree->rows_of(front);
    const Block columns = left(s);
    auto values = local.head(front.rows);
    auto head = values.head(front.pivots), tail = values.tail(front.update_rows());
    for (Index i = 0; i < front.pivots; ++i) head[i] = x[row[i]];
    for (Index k = 0; k < front.pivots; ++k) std::swap(head[k], head[fronts[at(s)].swaps[k] - 1]);
    if (front.pivots <= few_pivots) {
      tail.setZero();
      for (Index k = 0; k < front.pivots; ++k)
        values.tail(front.rows - k - 1) -= values[k] * columns.col(k).tail(front.rows - k - 1);
    } else {
      columns.topRows(front.pivots).triangularView<Eigen::UnitLower>().solveInPlace(head);
      tail.noalias() = -columns.bottomRows(front.update_rows()) * head;
    }
    for (Index i = 0; i < front.pivots; ++i) x[row[i]] = head[i];
    for (Index i = 0; i < front.update_rows(); ++i) x[row[front.pivots + i]] += tail[i];
  }

  void go_back(Index s, Vector& x, Vector& local) const {
    const Front& front = tree->front(s);
    const int* row = tree->rows_of(front);
    const Block columns = left(s), rows = upper(s);
    auto head = local.head(front.pivots), tail = local.segment(front.pivots, front.update_rows());
    for (Index i = 0; i < front.rows; ++i) local[i] = x[row[i]];
    if (front.pivots <= few_pivots) {
      for (Index k = front.pivots - 1; k >= 0; --k) {
        head[k] = (head[k] - rows.col(k).dot(tail)) / columns(k, k);
        head.head(k) -= head[k] * columns.col(k).head(k);
      }
    } else {
      head.noalias() -= rows.transpose() * tail;
      columns.topRows(front.pivots).triangularView<Eigen::Upper>().solveInPlace(head);
    }
    for (Index i = 0; i < front.pivots; ++i) x[row[i]] = head[i];
  }

  std::shared_ptr<const FrontTree> tree;
  std::vector<LuFront> fronts;
  std::vector<LuEntry> entries;  // front by front
  std::vector<lapack_int> swaps;
  LargeArray memory;
  Index largest_front = 0;  // its rows
  std::atomic<bool> singular = false;
  double operations_of_factorisation = 0, operations_of_solve = 0, operations = 0, bytes_at_once = 0;
};

SparseLu::SparseLu(const SparseMatrix& pattern) : factors_(std::make_shared<LuFactors>(pattern)) {}

bool SparseLu::factorise(const SparseMatrix& a) {
  const FrontTree& tree = *factors_->tree;
  if (!a.isCompressed() || a.nonZeros() != count(factors_->entries))
    fail("L U: expected the {} stored entries of the pattern, met {}", factors_->entries.size(), a.nonZeros());
  factors_->singular = false;
  factors_->operations += factors_->operations_of_factorisation;
  with_threads([&] { tree.up(Fronts::all, [&](Index s) { factors_->eliminate(s, a.valuePtr()); }); });
  return !factors_->singular;
}

Vector SparseLu::solve(const Vector& b) const {
  const OneBlasThread serial_blas;
  factors_->operations += factors_->operations_of_solve;
  Vector x = b, local(factors_->largest_front);
  for (Index s = 0; s < factors_->tree->size(); ++s) factors_->go_forward(s, x, local);
  for (Index s = factors_->tree->size() - 1; s >= 0; --s) factors_->go_back(s, x, local);
  return x;
}

int SparseLu::determinant_sign() const {
  bool negative = false;
  for (Index s = 0; s < factors_->tree->size(); ++s) {
    const auto diagonal = factors_->left(s).diagonal();
    for (Index k = 0; k < diagonal.size(); ++k)
      negative ^= (diagonal[k] < 0) != (factors_->fronts[at(s)].swaps[k] != k + 1);
  }
  return negative ? -1 : 1;
}

double SparseLu::operations() const { return factors_->operations; }
double SparseLu::bytes_at_once() const { return factors_->bytes_at_once; }

}  // namespace nscdd
