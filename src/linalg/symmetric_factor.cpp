// SPDX-License-Identifier: GPL-3.0-or-later
#include "symmetric_analysis.hpp"
#include <nscdd/linalg/threads.hpp>

#include <lapacke.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>

namespace nscdd {
namespace {

constexpr double parallel_subtree_flops = 2e6;  // below, a task costs more than it brings
constexpr Index block_columns = 128;            // of an update matrix, one task each
using Block = Eigen::Map<Matrix, 0, Eigen::OuterStride<>>;
using ConstBlock = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

// What stays of a front: columns of L with D on the diagonal, panel by panel.
struct FrontFactor {
  std::vector<double> columns;    // rows x pivots
  std::vector<lapack_int> swaps;  // LAPACK's ipiv, panel by panel
  Vector off;                     // subdiagonal of D
};

// Interchanges of one panel in LAPACK's order: swap(i, j) exchanges two indices of the panel.
template <class Swap>
void interchange(const lapack_int* ipiv, Index n, Swap&& swap) {
  for (Index k = 0; k < n; ++k) {
    if (ipiv[k] > 0) {
      swap(k, ipiv[k] - 1);
    } else {  // 2 x 2 block: the second row was exchanged
      swap(k + 1, -ipiv[k] - 1);
      ++k;
    }
  }
}
template <class Swap>
void interchange_back(const lapack_int* ipiv, Index n, Swap&& swap) {
  for (Index k = n - 1; k >= 0; --k) {
    if (ipiv[k] > 0) {
      swap(k, ipiv[k] - 1);
    } else {
      swap(k, -ipiv[k] - 1);
      --k;
    }
  }
}

// D^-1 applied to the rows of b from `first` on: d its diagonal, e its subdiagonal, 2 x 2 blocks where e is
// set.
template <class Diagonal, class Rows>
void solve_diagonal(const Diagonal& diagonal, const double* e, Rows&& b) {
  const Index n = diagonal.rows();
  for (Index k = 0; k < n; ++k) {
    if (k + 1 < n && e[k] != 0) {
      const double a = diagonal(k, k) / e[k], c = diagonal(k + 1, k + 1) / e[k], scale = (a * c - 1) * e[k];
      for (Index j = 0; j < b.cols(); ++j) {
        const double x = b(k, j), y = b(k + 1, j);
        b(k, j) = (c * x - y) / scale;
        b(k + 1, j) = (a * y - x) / scale;
      }
      ++k;
    } else {
      b.row(k) /= diagonal(k, k);
    }
  }
}

Index negative_pivots(const Block& diagonal, const double* e) {
  Index negative = 0;
  for (Index k = 0; k < diagonal.rows(); ++k) {
    if (k + 1 < diagonal.rows() && e[k] != 0) {  // Bunch-Kaufman takes 2 x 2 pivots of either sign only
      const double a = diagonal(k, k) / e[k], c = diagonal(k + 1, k + 1) / e[k];
      negative += a * c < 1 ? 1 : (diagonal(k, k) < 0 ? 2 : 0);
      ++k;
    } else {
      negative += diagonal(k, k) < 0;
    }
  }
  return negative;
}

// target -= left right^T on and below the diagonal of the target, by blocks of columns.
void subtract_product(Block target, const Block& left, const Matrix& right, bool parallel) {
  const Index blocks = (target.cols() + block_columns - 1) / block_columns;
  const auto one = [&](Index b) {
    const Index first = b * block_columns, width = std::min(block_columns, target.cols() - first);
    const Index height = target.rows() - first;
    target.block(first, first, height, width).noalias() -=
        left.bottomRows(height) * right.middleRows(first, width).transpose();
  };
  if (parallel && blocks > 1) {
    tbb::parallel_for(Index{0}, blocks, one);
  } else {
    for (Index b = 0; b < blocks; ++b) one(b);
  }
}

}  // namespace

class SymmetricFactor::Implementation {
 public:
  using Analysis = SymmetricAnalysis::Implementation;

  Implementation(std::shared_ptr<const Analysis> a, const SparseMatrix& lower)
      : analysis(std::move(a)),
        values(lower.valuePtr()),
        factors(analysis->fronts.size()),
        updates(factors.size()) {
    for_roots([this](Index root) { up_the_tree(root, [this](Index s) { eliminate(s); }); });
    updates.clear();
  }

  // Visits children before parents; subtrees worth a task run in parallel.
  template <class Visit>
  void up_the_tree(Index s, const Visit& visit) const {
    const Front& front = analysis->fronts[at(s)];
    if (front.subtree_flops < parallel_subtree_flops || front.children.size() < 2) {
      for (const Index c : front.children) up_the_tree(c, visit);
    } else {
      tbb::task_group tasks;
      for (std::size_t k = 1; k < front.children.size(); ++k)
        tasks.run([&, c = front.children[k]] { up_the_tree(c, visit); });
      up_the_tree(front.children[0], visit);
      tasks.wait();
    }
    visit(s);
  }
  template <class Visit>
  void down_the_tree(Index s, const Visit& visit) const {
    visit(s);
    const Front& front = analysis->fronts[at(s)];
    if (front.subtree_flops < parallel_subtree_flops || front.children.size() < 2) {
      for (const Index c : front.children) down_the_tree(c, visit);
    } else {
      tbb::task_group tasks;
      for (std::size_t k = 1; k < front.children.size(); ++k)
        tasks.run([&, c = front.children[k]] { down_the_tree(c, visit); });
      down_the_tree(front.children[0], visit);
      tasks.wait();
    }
  }
  template <class Visit>
  void for_roots(const Visit& visit) const {
    for (Index s = 0; s < count(analysis->fronts); ++s)
      if (analysis->fronts[at(s)].parent < 0) visit(s);
  }

  void eliminate(Index s) {
    const Front& front = analysis->fronts[at(s)];
    FrontFactor& own = factors[at(s)];
    own.columns.assign(at(front.rows * front.pivots), 0.0);
    own.swaps.resize(at(front.pivots));
    own.off = Vector::Zero(front.pivots);
    Matrix& update = updates[at(s)];
    const Index below = front.update_rows();
    update = Matrix::Zero(below, below);
    Block columns(own.columns.data(), front.rows, front.pivots, Eigen::OuterStride<>(front.rows));
    assemble(s, columns, update);
    Matrix multiples(front.rows, 0);  // L D of the panel at hand
    Matrix below_multiples(below, front.pivots);
    for (Index panel = 0, first = 0; panel < count(front.panels); ++panel) {
      const Index width = front.panels[at(panel)] - first, rest = front.rows - first - width;
      Block diagonal(&columns(first, first), width, width, Eigen::OuterStride<>(front.rows));
      const auto n = static_cast<lapack_int>(width), stride = static_cast<lapack_int>(front.rows);
      lapack_int* swaps = own.swaps.data() + first;
      if (!factorise_panel(diagonal, n, stride, swaps, own.off.data() + first)) return;
      Block left(columns.data() + first * front.rows + first + width, rest, width,
                 Eigen::OuterStride<>(front.rows));
      interchange(swaps, width, [&](Index i, Index j) {
        if (i != j) left.col(i).swap(left.col(j));
      });
      diagonal.triangularView<Eigen::UnitLower>().transpose().template solveInPlace<Eigen::OnTheRight>(left);
      multiples = left;  // L D
      Matrix transposed = left.transpose();
      solve_diagonal(diagonal, own.off.data() + first, transposed);
      left = transposed.transpose();  // L
      const Index columns_left = front.pivots - first - width;
      if (columns_left > 0) {
        Block target(&columns(first + width, first + width), rest, columns_left,
                     Eigen::OuterStride<>(front.rows));
        subtract_product(target, left, multiples.topRows(columns_left), true);
      }
      below_multiples.middleCols(first, width) = multiples.bottomRows(below);
      first += width;
    }
    if (below > 0) {
      const Block left(columns.data() + front.pivots, below, front.pivots, Eigen::OuterStride<>(front.rows));
      subtract_product(Block(update.data(), below, below, Eigen::OuterStride<>(below)), left, below_multiples,
                       true);
    }
  }

  bool factorise_panel(Block& diagonal, lapack_int n, lapack_int stride, lapack_int* swaps, double* off) {
    double query = 0;
    LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, diagonal.data(), stride, swaps, &query, -1);
    Vector work(static_cast<Index>(query));
    lapack_int info = LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, diagonal.data(), stride, swaps,
                                          work.data(), static_cast<lapack_int>(query));
    if (info != 0 || !std::isfinite(diagonal(n - 1, n - 1))) {
      singular = true;
      return false;
    }
    LAPACKE_dsyconv_work(LAPACK_COL_MAJOR, 'L', 'C', n, diagonal.data(), stride, swaps, off);
    negative += negative_pivots(diagonal, off);
    return true;
  }

  // Entries of the matrix, then the updates of the children in their order.
  void assemble(Index s, Block& columns, Matrix& update) {
    const Front& front = analysis->fronts[at(s)];
    const auto& entries = analysis->entries;
    const Index last =
        s + 1 < count(analysis->fronts) ? analysis->fronts[at(s + 1)].first_entry : count(entries);
    for (Index k = front.first_entry; k < last; ++k) {
      const FrontEntry& entry = entries[at(k)];
      columns(entry.row, entry.column) += values[entry.source];
    }
    for (const Index c : front.children) {
      const Front& child = analysis->fronts[at(c)];
      Matrix& from = updates[at(c)];
      const int* place = analysis->place_in_parent.data() + child.first_row + child.pivots;
      for (Index j = 0; j < from.cols(); ++j) {
        const Index column = place[j];
        double* to = column < front.pivots
                         ? &columns(0, column)
                         : update.data() + (column - front.pivots) * update.rows() - front.pivots;
        const double* source = from.data() + j * from.rows();
        for (Index i = j; i < from.rows(); ++i) to[place[i]] += source[i];
      }
      from.resize(0, 0);
    }
  }

  Vector solve(const Vector& b) const {
    Vector x = b;
    std::vector<Vector> carried(factors.size());  // updates on their way to the parent
    for_roots([&](Index root) { up_the_tree(root, [&](Index s) { forward(s, x, carried); }); });
    for_roots([&](Index root) { down_the_tree(root, [&](Index s) { backward(s, x); }); });
    return x;
  }

  // visit(first pivot, width, L with D on its diagonal, L below) for each panel of a front, up or down.
  template <class Visit>
  void panel(Index s, std::size_t k, const Visit& visit) const {
    const Front& front = analysis->fronts[at(s)];
    const Index first = k == 0 ? 0 : front.panels[k - 1], width = front.panels[k] - first;
    const double* start = factors[at(s)].columns.data() + first * front.rows + first;
    const Eigen::OuterStride<> stride(front.rows);
    visit(first, width, ConstBlock(start, width, width, stride),
          ConstBlock(start + width, front.rows - first - width, width, stride));
  }
  template <class Visit>
  void for_panels(Index s, const Visit& visit) const {
    for (std::size_t k = 0; k < analysis->fronts[at(s)].panels.size(); ++k) panel(s, k, visit);
  }
  template <class Visit>
  void for_panels_back(Index s, const Visit& visit) const {
    for (std::size_t k = analysis->fronts[at(s)].panels.size(); k > 0; --k) panel(s, k - 1, visit);
  }

  void forward(Index s, Vector& x, std::vector<Vector>& carried) const {
    const Front& front = analysis->fronts[at(s)];
    const FrontFactor& own = factors[at(s)];
    const int* row = analysis->row_of.data() + front.first_row;
    Vector local = Vector::Zero(front.rows);
    for (Index i = 0; i < front.pivots; ++i) local[i] = x[row[i]];
    for (const Index c : front.children) {
      const Front& child = analysis->fronts[at(c)];
      const int* place = analysis->place_in_parent.data() + child.first_row + child.pivots;
      for (Index i = 0; i < child.update_rows(); ++i) local[place[i]] += carried[at(c)][i];
      carried[at(c)].resize(0);
    }
    for_panels(s, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
      auto head = local.segment(first, width);
      interchange(own.swaps.data() + first, width, [&](Index i, Index j) { std::swap(head[i], head[j]); });
      diagonal.triangularView<Eigen::UnitLower>().solveInPlace(head);
      local.tail(left.rows()).noalias() -= left * head;
    });
    for (Index i = 0; i < front.pivots; ++i) x[row[i]] = local[i];
    carried[at(s)] = local.tail(front.update_rows());
  }

  void backward(Index s, Vector& x) const {
    const Front& front = analysis->fronts[at(s)];
    const FrontFactor& own = factors[at(s)];
    const int* row = analysis->row_of.data() + front.first_row;
    Vector local(front.rows);
    for (Index i = 0; i < front.rows; ++i) local[i] = x[row[i]];
    for_panels_back(s, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
      auto head = local.segment(first, width);
      solve_diagonal(diagonal, own.off.data() + first, head);
      head.noalias() -= left.transpose() * local.tail(left.rows());
      diagonal.triangularView<Eigen::UnitLower>().transpose().solveInPlace(head);
      interchange_back(own.swaps.data() + first, width,
                       [&](Index i, Index j) { std::swap(head[i], head[j]); });
    });
    for (Index i = 0; i < front.pivots; ++i) x[row[i]] = local[i];
  }

  Matrix inverse_block(const std::vector<Index>& rows) const {
    // Fronts that the right-hand sides reach, and the pivot rows of these.
    std::vector<char> reached(factors.size(), 0);
    for (const Index row : rows)
      for (Index s = analysis->front_of_row[at(row)]; s >= 0 && !reached[at(s)];
           s = analysis->fronts[at(s)].parent)
        reached[at(s)] = 1;
    std::vector<Index> path, compact(at(analysis->size), -1);
    Index reached_rows = 0;
    for (Index s = 0; s < count(factors); ++s) {
      if (!reached[at(s)]) continue;
      path.push_back(s);
      const Front& front = analysis->fronts[at(s)];
      for (Index i = 0; i < front.pivots; ++i)
        compact[at(analysis->row_of[at(front.first_row + i)])] = reached_rows++;
    }
    Matrix x = Matrix::Zero(reached_rows, count(rows));
    for (Index k = 0; k < count(rows); ++k) x(compact[at(rows[at(k)])], k) = 1;
    const auto rows_of = [&](Index s) {
      const Front& front = analysis->fronts[at(s)];
      std::vector<Index> list;
      for (Index i = 0; i < front.rows; ++i)
        list.push_back(compact[at(analysis->row_of[at(front.first_row + i)])]);
      return list;
    };
    for (const Index s : path) {  // L^-1
      const std::vector<Index> list = rows_of(s);
      Matrix local = x(list, Eigen::all);
      for_panels(s, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
        auto head = local.middleRows(first, width);
        interchange(factors[at(s)].swaps.data() + first, width, [&](Index i, Index j) {
          if (i != j) head.row(i).swap(head.row(j));
        });
        diagonal.triangularView<Eigen::UnitLower>().solveInPlace(head);
        local.bottomRows(left.rows()).noalias() -= left * head;
      });
      x(list, Eigen::all) = local;
    }
    for (auto s = path.rbegin(); s != path.rend(); ++s) {  // L^-T D^-1
      const std::vector<Index> list = rows_of(*s);
      Matrix local = x(list, Eigen::all);
      for_panels_back(*s, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
        auto head = local.middleRows(first, width);
        solve_diagonal(diagonal, factors[at(*s)].off.data() + first, head);
        head.noalias() -= left.transpose() * local.bottomRows(left.rows());
        diagonal.triangularView<Eigen::UnitLower>().transpose().solveInPlace(head);
        interchange_back(factors[at(*s)].swaps.data() + first, width, [&](Index i, Index j) {
          if (i != j) head.row(i).swap(head.row(j));
        });
      });
      x(list, Eigen::all) = local;
    }
    Matrix block(count(rows), count(rows));
    for (Index k = 0; k < count(rows); ++k) block.row(k) = x.row(compact[at(rows[at(k)])]);
    return block;
  }

  std::shared_ptr<const Analysis> analysis;
  const double* values;  // of the matrix, during the factorisation only
  std::vector<FrontFactor> factors;
  std::vector<Matrix> updates;
  std::atomic<Index> negative = 0;
  std::atomic<bool> singular = false;
};

SymmetricFactor::SymmetricFactor(const SymmetricAnalysis& analysis, const SparseMatrix& lower) {
  with_threads(
      [&] { implementation_ = std::make_shared<const Implementation>(analysis.implementation_, lower); });
}

bool SymmetricFactor::regular() const { return !implementation_->singular; }
Index SymmetricFactor::negative_eigenvalues() const { return implementation_->negative; }
Vector SymmetricFactor::solve(const Vector& b) const {
  Vector x;
  with_threads([&] { x = implementation_->solve(b); });
  return x;
}
Matrix SymmetricFactor::inverse_block(const std::vector<Index>& rows) const {
  return implementation_->inverse_block(rows);
}

Vector symmetric_residual(const SparseMatrix& lower, const Vector& x, const Vector& b) {
  Vector residual = b;
  for (Index j = 0; j < lower.outerSize(); ++j)
    for (SparseMatrix::InnerIterator e(lower, j); e; ++e) {
      residual[e.row()] -= e.value() * x[j];
      if (e.row() != j) residual[j] -= e.value() * x[e.row()];
    }
  return residual;
}

double backward_error(const SparseMatrix& lower, const Vector& x, const Vector& b) {
  if (!x.allFinite()) return infinity;
  const Vector residual = symmetric_residual(lower, x, b);
  const Vector size = -symmetric_residual(lower.cwiseAbs(), x.cwiseAbs(), -b.cwiseAbs());  // |A| |x| + |b|
  double worst = 0;
  for (Index i = 0; i < b.size(); ++i)
    if (size[i] > 0) worst = std::max(worst, std::abs(residual[i]) / size[i]);
  return worst;
}

}  // namespace nscdd
