// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "linalg/multifrontal/factor.hpp"
#include "linalg/multifrontal/fronts.hpp"
#include "linalg/threads.hpp"

#include <set>

namespace nscdd {
namespace {

// `Values`: a vector, or a matrix of a column for each right-hand side.
template <class Values>
void go_forward(const FactorFronts& fronts, Index s, Values& x, std::vector<Values>& carried) {
  const Front& front = fronts.tree.front(s);
  const int* row = fronts.tree.rows_of(front);
  Values local = Values::Zero(front.rows, x.cols());
  for (Index i = 0; i < front.pivots; ++i) local.row(i) = x.row(row[i]);
  for (const Index c : front.children) {
    if (carried[at(c)].size() == 0) continue;  // a child in the interior, where all values are zero
    const Front& child = fronts.tree.front(c);
    const int* place = fronts.tree.places_of_updates(child);
    for (Index i = 0; i < child.update_rows(); ++i) local.row(place[i]) += carried[at(c)].row(i);
    carried[at(c)].resize(0, x.cols());
  }
  go_forward(front, fronts.factor(s), local);
  for (Index i = 0; i < front.pivots; ++i) x.row(row[i]) = local.row(i);
  if (front.pivots == 0)  // rows that are kept
    for (Index i = 0; i < front.rows; ++i) x.row(row[i]) += local.row(i);
  carried[at(s)] = local.bottomRows(front.update_rows());
}

template <class Values>
void go_back(const FactorFronts& fronts, Index s, Values& x) {
  const Front& front = fronts.tree.front(s);
  const int* row = fronts.tree.rows_of(front);
  Values local(front.rows, x.cols());
  for (Index i = 0; i < front.rows; ++i) local.row(i) = x.row(row[i]);
  go_back(front, fronts.factor(s), local);
  for (Index i = 0; i < front.pivots; ++i) x.row(row[i]) = local.row(i);
}

// L^-1 over all fronts, or over those on the border if b is zero elsewhere.
template <class Values>
Values forward(const FactorFronts& fronts, Values x, Fronts which) {
  std::vector<Values> carried(at(fronts.tree.size()));  // updates for the parents
  with_threads([&] { fronts.tree.up(which, [&](Index s) { go_forward(fronts, s, x, carried); }); });
  return x;
}

// D^-1 and L^-T likewise.
template <class Values>
Values back(const FactorFronts& fronts, Values x, Fronts which) {
  with_threads([&] { fronts.tree.down(which, [&](Index s) { go_back(fronts, s, x); }); });
  return x;
}

template <class Values>
Values solved(const FactorFronts& fronts, Values x, Fronts up, Fronts down) {
  return back(fronts, forward(fronts, std::move(x), up), down);
}

void require_border(const FrontTree& tree) {
  if (tree.border.empty())
    throw Error("solve from or to the border: expected an analysis with border rows, met one without");
}

Vector spread(const FrontTree& tree, const Vector& g) {  // E g
  require_border(tree);
  if (g.size() != count(tree.border))
    fail("solve from the border: expected a value for each of {} border rows, met {}", tree.border.size(), g.size());
  Vector x = Vector::Zero(tree.rows);
  x(tree.border) = g;
  return x;
}

}  // namespace

Vector SymmetricFactor::go_forward(const Vector& b, Fronts which) const { return forward(*fronts_, b, which); }
Vector SymmetricFactor::go_back(const Vector& x, Fronts which) const { return back(*fronts_, x, which); }
Vector SymmetricFactor::solve(const Vector& b) const { return solved(*fronts_, b, Fronts::all, Fronts::all); }
Matrix SymmetricFactor::solve_columns(Matrix b) const {
  return solved(*fronts_, std::move(b), Fronts::all, Fronts::all);
}

Vector SymmetricFactor::solve_from_border(const Vector& g) const {
  return solved(*fronts_, spread(fronts_->tree, g), Fronts::border, Fronts::all);
}

Vector SymmetricFactor::solve_to_border(const Vector& b) const {
  require_border(fronts_->tree);
  return solved(*fronts_, b, Fronts::all, Fronts::border)(fronts_->tree.border);
}

Vector SymmetricFactor::solve_on_border(const Vector& g) const {
  return solved(*fronts_, spread(fronts_->tree, g), Fronts::border, Fronts::border)(fronts_->tree.border);
}

Matrix SymmetricFactor::inverse_block(const std::vector<Index>& rows) const {
  const OneBlasThread serial_blas;
  const FactorFronts& fronts = *fronts_;
  const FrontTree& tree = fronts.tree;
  // The fronts on the paths from the rows to the root, and a compact numbering of their pivot rows.
  std::set<Index> path;
  for (const Index row : rows)
    for (Index s = tree.front_of_row[at(row)]; s >= 0 && path.insert(s).second;) s = tree.front(s).parent;
  std::vector<Index> compact(at(tree.rows), -1);
  Index reached_rows = 0;
  for (const Index s : path)
    for (Index i = 0; i < tree.front(s).pivots; ++i) compact[at(tree.rows_of(tree.front(s))[i])] = reached_rows++;
  Matrix x = Matrix::Zero(reached_rows, count(rows));
  for (Index k = 0; k < count(rows); ++k) x(compact[at(rows[at(k)])], k) = 1;
  const auto change_rows = [&](Index s, const auto& change) {
    std::vector<Index> list;
    for (Index i = 0; i < tree.front(s).rows; ++i) list.push_back(compact[at(tree.rows_of(tree.front(s))[i])]);
    Matrix local = x(list, Eigen::all);
    change(local);
    x(list, Eigen::all) = local;
  };
  for (const Index s : path)
    change_rows(s, [&](Matrix& local) { nscdd::go_forward(tree.front(s), fronts.factor(s), local); });
  for (auto s = path.rbegin(); s != path.rend(); ++s)
    change_rows(*s, [&](Matrix& local) { nscdd::go_back(tree.front(*s), fronts.factor(*s), local); });
  std::vector<Index> wanted;
  for (const Index row : rows) wanted.push_back(compact[at(row)]);
  return x(wanted, Eigen::all);
}

Vector SymmetricFactor::pivots() const {
  const FactorFronts& fronts = *fronts_;
  const FrontTree& tree = fronts.tree;
  Vector result = Vector::Zero(tree.rows);
  for (Index s = 0; s < tree.size(); ++s) {
    const FrontFactor& own = fronts.factor(s);
    const int* row = tree.rows_of(tree.front(s));
    for_panels(tree.front(s), own, [&](Index first, Index width, const ConstBlock& diagonal, const ConstBlock&) {
      std::vector<Index> place = natural_order(width);  // in the panel
      interchange(own.swaps.data() + first, width, [&](Index i, Index j) { std::swap(place[at(i)], place[at(j)]); });
      for (Index k = 0; k < width; ++k) {
        if (k + 1 < width && own.off[first + k] != 0)
          ++k;  // a 2 x 2 block
        else
          result[row[first + place[at(k)]]] = diagonal(k, k);
      }
    });
  }
  return result;
}

}  // namespace nscdd
