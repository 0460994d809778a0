// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/ldlt/fronts.hpp"
#include "linalg/threads.hpp"
#include <nscdd/core/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace nscdd {

Vector SymmetricFactor::Implementation::solve(Vector x, Fronts forward, Fronts backward) const {
  std::vector<Vector> carried(at(tree.size()));  // updates on their way to the parent
  const bool up_border = forward == Fronts::border, down_border = backward == Fronts::border;
  tree.for_roots(up_border, [&](Index root) { tree.up(root, up_border, [&](Index s) { go_forward(s, x, carried); }); });
  tree.for_roots(down_border, [&](Index root) { tree.down(root, down_border, [&](Index s) { go_back(s, x); }); });
  return x;
}

void SymmetricFactor::Implementation::require_border() const {
  if (tree.analysis->border.empty())
    throw Error("solve from or to the border: expected an analysis with border rows, met one without");
}

Vector SymmetricFactor::Implementation::spread(const Vector& g) const {
  require_border();
  if (g.size() != count(tree.analysis->border))
    throw Error(fmt::format("solve from the border: expected a value for each of {} border rows, met {}",
                            tree.analysis->border.size(), g.size()));
  Vector x = Vector::Zero(tree.analysis->size);
  x(tree.analysis->border) = g;
  return x;
}

Vector SymmetricFactor::Implementation::on_border(const Vector& x) const { return x(tree.analysis->border); }

void SymmetricFactor::Implementation::go_forward(Index s, Vector& x, std::vector<Vector>& carried) const {
  const Front& front = tree.front(s);
  const FrontFactor& own = factor(s);
  const int* row = tree.analysis->row_of.data() + front.first_row;
  Vector local = Vector::Zero(front.rows);
  for (Index i = 0; i < front.pivots; ++i) local[i] = x[row[i]];
  for (const Index c : front.children) {
    if (carried[at(c)].size() == 0) continue;  // a child in the interior, where all is zero
    const Front& child = tree.front(c);
    const int* place = tree.analysis->place_in_parent.data() + child.first_row + child.pivots;
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

void SymmetricFactor::Implementation::go_back(Index s, Vector& x) const {
  const Front& front = tree.front(s);
  const FrontFactor& own = factor(s);
  const int* row = tree.analysis->row_of.data() + front.first_row;
  Vector local(front.rows);
  for (Index i = 0; i < front.rows; ++i) local[i] = x[row[i]];
  for_panels_back(s, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
    auto head = local.segment(first, width);
    solve_diagonal(diagonal, own.off.data() + first, head);
    head.noalias() -= left.transpose() * local.tail(left.rows());
    diagonal.triangularView<Eigen::UnitLower>().transpose().solveInPlace(head);
    interchange_back(own.swaps.data() + first, width, [&](Index i, Index j) { std::swap(head[i], head[j]); });
  });
  for (Index i = 0; i < front.pivots; ++i) x[row[i]] = local[i];
}

Matrix SymmetricFactor::Implementation::inverse_block(const std::vector<Index>& rows) const {
  // The fronts that the right-hand sides reach, and a compact numbering of their pivot rows.
  const auto& analysis = *tree.analysis;
  std::vector<char> reached(at(tree.size()), 0);
  for (const Index row : rows)
    for (Index s = analysis.front_of_row[at(row)]; s >= 0 && !reached[at(s)]; s = tree.front(s).parent)
      reached[at(s)] = 1;
  std::vector<Index> path, compact(at(analysis.size), -1);
  Index reached_rows = 0;
  for (Index s = 0; s < tree.size(); ++s) {
    if (!reached[at(s)]) continue;
    path.push_back(s);
    const Front& front = tree.front(s);
    for (Index i = 0; i < front.pivots; ++i) compact[at(analysis.row_of[at(front.first_row + i)])] = reached_rows++;
  }
  Matrix x = Matrix::Zero(reached_rows, count(rows));
  for (Index k = 0; k < count(rows); ++k) x(compact[at(rows[at(k)])], k) = 1;
  const auto rows_of = [&](Index s) {
    const Front& front = tree.front(s);
    std::vector<Index> list;
    for (Index i = 0; i < front.rows; ++i) list.push_back(compact[at(analysis.row_of[at(front.first_row + i)])]);
    return list;
  };
  for (const Index s : path) {  // L^-1
    const std::vector<Index> list = rows_of(s);
    Matrix local = x(list, Eigen::all);
    for_panels(s, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock& left) {
      auto head = local.middleRows(first, width);
      interchange(factor(s).swaps.data() + first, width, [&](Index i, Index j) {
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
      solve_diagonal(diagonal, factor(*s).off.data() + first, head);
      head.noalias() -= left.transpose() * local.bottomRows(left.rows());
      diagonal.triangularView<Eigen::UnitLower>().transpose().solveInPlace(head);
      interchange_back(factor(*s).swaps.data() + first, width, [&](Index i, Index j) {
        if (i != j) head.row(i).swap(head.row(j));
      });
    });
    x(list, Eigen::all) = local;
  }
  Matrix block(count(rows), count(rows));
  for (Index k = 0; k < count(rows); ++k) block.row(k) = x.row(compact[at(rows[at(k)])]);
  return block;
}

std::vector<Index> SymmetricFactor::Implementation::smallest_pivots(Index wanted, Index first_row) const {
  std::vector<std::pair<double, Index>> pivots;
  for (Index s = 0; s < tree.size(); ++s) {
    const FrontFactor& own = factor(s);
    const int* row = tree.analysis->row_of.data() + tree.front(s).first_row;
    for_panels(s, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock&) {
      std::vector<Index> place(at(width));
      std::iota(place.begin(), place.end(), first);
      interchange(own.swaps.data() + first, width, [&](Index i, Index j) { std::swap(place[at(i)], place[at(j)]); });
      for (Index k = 0; k < width; ++k) {
        if (k + 1 < width && own.off[first + k] != 0) {
          ++k;  // a 2 x 2 block
        } else if (const Index r = row[place[at(k)]]; r >= first_row) {
          pivots.emplace_back(std::abs(diagonal(k, k)), r);
        }
      }
    });
  }
  std::sort(pivots.begin(), pivots.end());
  pivots.resize(std::min(pivots.size(), at(wanted)));
  std::vector<Index> rows;
  for (const auto& [size, r] : pivots) rows.push_back(r);
  std::sort(rows.begin(), rows.end());
  return rows;
}

std::vector<Index> SymmetricFactor::smallest_pivots(Index wanted, Index first) const {
  return implementation_->smallest_pivots(wanted, first);
}

using Fronts = SymmetricFactor::Implementation::Fronts;

Vector SymmetricFactor::solve(const Vector& b) const {
  Vector x;
  with_threads([&] { x = implementation_->solve(b, Fronts::all, Fronts::all); });
  return x;
}

Vector SymmetricFactor::solve_from_border(const Vector& g) const {
  Vector x;
  with_threads([&] { x = implementation_->solve(implementation_->spread(g), Fronts::border, Fronts::all); });
  return x;
}

Vector SymmetricFactor::solve_to_border(const Vector& b) const {
  implementation_->require_border();
  Vector x;
  with_threads([&] { x = implementation_->solve(b, Fronts::all, Fronts::border); });
  return implementation_->on_border(x);
}

Vector SymmetricFactor::solve_on_border(const Vector& g) const {
  Vector x;
  with_threads([&] { x = implementation_->solve(implementation_->spread(g), Fronts::border, Fronts::border); });
  return implementation_->on_border(x);
}

Matrix SymmetricFactor::inverse_block(const std::vector<Index>& rows) const {
  const OneBlasThread serial_blas;
  return implementation_->inverse_block(rows);
}

}  // namespace nscdd
