// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/factor.hpp"

#include "core/memory.hpp"
#include "linalg/multifrontal/fronts.hpp"
#include "linalg/threads.hpp"

#include <fmt/format.h>
#include <sys/mman.h>
#include <tbb/parallel_for.h>

#include <new>

namespace nscdd {
namespace {

constexpr std::size_t huge_page = 2 << 20, large_from = 4 * huge_page;  // bytes
constexpr Index block_columns = 128;                                    // columns of an update matrix in one task

Index negative_pivots(const Block& diagonal, const double* e) {
  Index negative = 0;
  for (Index k = 0; k < diagonal.rows(); ++k) {
    if (k + 1 < diagonal.rows() && e[k] != 0) {  // 2 x 2: eigenvalues of either sign if ac < 1
      const double a = diagonal(k, k) / e[k], c = diagonal(k + 1, k + 1) / e[k];
      negative += a * c < 1 ? 1 : (diagonal(k, k) < 0 ? 2 : 0);
      ++k;
    } else {
      negative += diagonal(k, k) < 0;
    }
  }
  return negative;
}

// target -= left right^T on and below the diagonal of the target, by blocks of columns. `fresh`: the target counts as 0
void subtract_product(Block target, const Block& left, const auto& right, bool fresh) {
  const Index blocks = (target.cols() + block_columns - 1) / block_columns;
  const auto one = [&](Index b) {
    const Index first = b * block_columns, width = std::min(block_columns, target.cols() - first);
    const Index height = target.rows() - first;
    auto block = target.block(first, first, height, width);
    if (fresh) block.setZero();
    block.noalias() -= left.bottomRows(height) * right.middleRows(first, width).transpose();
  };
  if (blocks > 1) {
    tbb::parallel_for(Index{0}, blocks, one);
  } else if (blocks == 1) {  // most fronts are small
    one(0);
  }
}

// Nothing if a pivot is zero.
std::optional<Index> factorise_panel(Block& diagonal, lapack_int n, lapack_int stride, lapack_int* swaps, double* off) {
  double query = 0;
  LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, diagonal.data(), stride, swaps, &query, -1);
  Vector work(static_cast<Index>(query));
  const lapack_int info = LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', n, diagonal.data(), stride, swaps, work.data(),
                                              static_cast<lapack_int>(query));
  if (info != 0 || !std::isfinite(diagonal(n - 1, n - 1))) return std::nullopt;
  LAPACKE_dsyconv_work(LAPACK_COL_MAJOR, 'L', 'C', n, diagonal.data(), stride, swaps, off);
  return negative_pivots(diagonal, off);
}

// Turns the columns of a panel into L with D on its diagonal, and subtracts its product from those to the right.
std::optional<Index> eliminate_panel(FrontFactor& own, Block& columns, Matrix& multiples, Index first, Index width) {
  const Index rows = columns.rows(), next = first + width, rest = rows - next, columns_left = columns.cols() - next;
  Block diagonal(&columns(first, first), width, width, Eigen::OuterStride<>(rows));
  lapack_int* const swaps = own.swaps.data() + first;
  double* const off = own.off.data() + first;
  const std::optional<Index> negative =
      factorise_panel(diagonal, static_cast<lapack_int>(width), static_cast<lapack_int>(rows), swaps, off);
  if (!negative || rest == 0) return negative;
  Block left(&columns(next, first), rest, width, Eigen::OuterStride<>(rows));
  interchange(swaps, width, [&](Index i, Index j) { left.col(i).swap(left.col(j)); });
  diagonal.triangularView<Eigen::UnitLower>().transpose().template solveInPlace<Eigen::OnTheRight>(left);
  multiples.block(next, first, rest, width) = left;  // L D
  solve_diagonal(diagonal, off, left.transpose());   // L
  if (columns_left > 0)
    subtract_product(Block(&columns(next, next), rest, columns_left, Eigen::OuterStride<>(rows)), left,
                     multiples.block(next, first, columns_left, width), false);
  return negative;
}

// Update rows first ... first + length - 1 of a child, which follow each other in its parent from `place` on.
struct Run {
  Index first, place, length;
};

std::vector<Run> runs_of(const int* place, Index rows) {
  std::vector<Run> runs;
  for (Index i = 0; i < rows; ++i)
    if (i > 0 && place[i] == place[i - 1] + 1) {
      ++runs.back().length;
    } else {
      runs.push_back({i, place[i], 1});
    }
  return runs;
}

void add(const double* from, double* to, Index length) {
  for (Index i = 0; i < length; ++i) to[i] += from[i];
}

// Eliminates fronts of one matrix, children before parents.
struct Elimination {
  const FrontTree& tree;
  const double* values;
  EliminatedFronts& result;
  const EliminatedFronts* below;  // the eliminated fronts of the interior, which keep their updates

  void eliminate(Index s) const {
    const Front& front = tree.front(s);
    FrontFactor& own = result.factors[at(s)];
    own.swaps.resize(at(front.pivots));
    own.off = Vector::Zero(front.pivots);
    Matrix& update = result.updates[at(s)];
    const bool fresh = front.children.empty() && front.pivots > 0;
    update.resize(front.update_rows(), front.update_rows());
    if (!fresh) update.setZero();
    Block columns(own.columns, front.rows, front.pivots, Eigen::OuterStride<>(front.rows));
    columns.setZero();
    assemble(s, columns, update);
    if (const auto negative = eliminate_front(front, own, update, fresh))
      result.negative += *negative;
    else
      result.singular = true;
  }

  // Entries of the matrix, then the updates of the children in their order.
  void assemble(Index s, Block& columns, Matrix& update) const {
    const Front& front = tree.front(s);
    for (Index k = front.first_entry; k < front.last_entry; ++k) {
      const FrontEntry& entry = tree.entries[at(k)];
      double& to = entry.column < front.pivots ? columns(entry.row, entry.column)
                                               : update(entry.row - front.pivots, entry.column - front.pivots);
      to += values[entry.source];
    }
    for (const Index c : front.children) {
      const Front& child = tree.front(c);
      const bool kept = child.on_border != front.on_border;
      const Matrix& from = (kept ? *below : result).updates[at(c)];
      const int* place = tree.places_of_updates(child);
      const std::vector<Run> runs = runs_of(place, from.rows());
      auto run = runs.begin();  // of the entry on the diagonal
      for (Index j = 0; j < from.cols(); ++j) {
        if (j == run->first + run->length) ++run;
        const Index column = place[j];
        double* to = column < front.pivots ? &columns(0, column)
                                           : update.data() + (column - front.pivots) * update.rows() - front.pivots;
        add(from.data() + j * from.rows() + j, to + column, run->first + run->length - j);
        for (auto other = run + 1; other != runs.end(); ++other)
          add(from.data() + j * from.rows() + other->first, to + other->place, other->length);
      }
      if (!kept) result.updates[at(c)].resize(0, 0);
    }
  }
};

// Size of the columns of all fronts on the border, or of the interior.
Index column_entries(const FrontTree& tree, bool on_border) {
  Index sum = 0;
  for (const Front& front : tree.fronts)
    if (front.on_border == on_border) sum += front.rows * front.pivots;
  return sum;
}

LargeArray memory_of_factor(const InteriorFronts& interior) {
  const std::lock_guard lock(interior.mutex);
  if (interior.left) return std::move(interior.left);
  require_memory(factor_memory(*interior.tree, FactorShape::symmetric).border, "another factor of one matrix");
  return large_array(column_entries(*interior.tree, true));
}

}  // namespace

LargeArray large_array(Index size) {
  const std::size_t bytes = at(size) * sizeof(double);
  const bool large = bytes >= large_from;
  const std::size_t whole_pages = (bytes / huge_page + 1) * huge_page;
  void* const memory =
      large ? std::aligned_alloc(huge_page, whole_pages) : std::malloc(std::max<std::size_t>(bytes, 1));
  if (memory == nullptr) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
  if (large) madvise(memory, whole_pages, MADV_HUGEPAGE);  // may be refused; small pages serve as well
#endif
  return LargeArray(static_cast<double*>(memory));
}

std::optional<Index> eliminate_front(const Front& front, FrontFactor& factor, Matrix& update, bool fresh) {
  Block columns(factor.columns, front.rows, front.pivots, Eigen::OuterStride<>(front.rows));
  Matrix multiples(front.rows, front.pivots);  // L D below each panel
  Index negative = 0, first = 0;
  for (const Index end : front.panels) {
    const std::optional<Index> of_panel = eliminate_panel(factor, columns, multiples, first, end - first);
    if (!of_panel) return std::nullopt;
    negative += *of_panel;
    first = end;
  }
  if (const Index below = front.update_rows(); below > 0 && front.pivots > 0) {
    const Block left(columns.data() + front.pivots, below, front.pivots, Eigen::OuterStride<>(front.rows));
    subtract_product(Block(update.data(), below, below, Eigen::OuterStride<>(below)), left, multiples.bottomRows(below),
                     fresh);
  }
  return negative;
}

DenseFront::DenseFront(Matrix lower, const std::vector<Index>& group_ends) {
  front_.rows = lower.rows();
  front_.pivots = group_ends.empty() ? 0 : group_ends.back();
  front_.panels = cut_panels(group_ends);
  columns_ = large_array(front_.rows * front_.pivots);
  factor_ = {.columns = columns_.get(),
             .swaps = std::vector<lapack_int>(at(front_.pivots)),
             .off = Vector::Zero(front_.pivots)};
  Block(columns_.get(), front_.rows, front_.pivots, Eigen::OuterStride<>(front_.rows)) = lower.leftCols(front_.pivots);
  update_ = lower.bottomRightCorner(front_.update_rows(), front_.update_rows());
  lower.resize(0, 0);  // frees its memory
  with_threads([&] { negative_ = eliminate_front(front_, factor_, update_, false); });
}

EliminatedFronts::EliminatedFronts(const FrontTree& tree, bool on_border, LargeArray memory)
    : columns(std::move(memory)), factors(at(tree.size())), updates(at(tree.size())) {
  double* next = columns.get();
  for (Index s = 0; s < tree.size(); ++s) {
    if (tree.front(s).on_border != on_border) continue;
    factors[at(s)].columns = next;
    next += tree.front(s).rows * tree.front(s).pivots;
  }
}

InteriorFronts::InteriorFronts(std::shared_ptr<const FrontTree> analysis, const SparseMatrix& lower)
    : tree(std::move(analysis)), fronts(*tree, false, large_array(column_entries(*tree, false))) {
  const Elimination elimination{*tree, lower.valuePtr(), fronts, nullptr};
  const std::vector<Index>& roots = tree->interior_roots;
  tbb::parallel_for(Index{0}, count(roots),
                    [&](Index k) { tree->up(roots[at(k)], Fronts::all, [&](Index s) { elimination.eliminate(s); }); });
}

FactorFronts::FactorFronts(std::shared_ptr<const InteriorFronts> interior_fronts, const SparseMatrix& lower,
                           Matrix& kept_block)
    : interior(std::move(interior_fronts)), tree(*interior->tree), border(tree, true, memory_of_factor(*interior)) {
  const Elimination elimination{tree, lower.valuePtr(), border, &interior->fronts};
  tree.up(Fronts::border, [&](Index s) { elimination.eliminate(s); });
  if (tree.keeps_rows) kept_block = std::move(border.updates.back());
  border.updates.clear();
}

FactorFronts::~FactorFronts() {
  const std::lock_guard lock(interior->mutex);
  interior->left = std::move(border.columns);
}

SymmetricInterior eliminated_interior(const SymmetricAnalysis& analysis, const SparseMatrix& lower) {
  require_memory(factor_memory(*analysis.tree(), FactorShape::symmetric).at_once,
                 fmt::format("a factor of {} rows", lower.rows()));
  SymmetricInterior interior;
  with_threads([&] { interior = std::make_shared<const InteriorFronts>(analysis.tree(), lower); });
  return interior;
}

SymmetricFactor::SymmetricFactor(const SymmetricAnalysis& analysis, const SparseMatrix& lower)
    : SymmetricFactor(eliminated_interior(analysis, lower), lower) {}

SymmetricFactor::SymmetricFactor(const SymmetricInterior& interior, const SparseMatrix& lower) {
  with_threads([&] { fronts_ = std::make_shared<const FactorFronts>(interior, lower, kept_block_); });
}

bool SymmetricFactor::regular() const { return !fronts_->interior->fronts.singular && !fronts_->border.singular; }

Index SymmetricFactor::negative_eigenvalues() const {
  return fronts_->interior->fronts.negative + fronts_->border.negative;
}

}  // namespace nscdd
