// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/factor.hpp"
#include "linalg/sparse_entries.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

#include <mutex>
#include <numeric>

namespace nscdd {
namespace {

// One analysis, and the interior of the matrix that was factorised last.
class Multifrontal {
 public:
  explicit Multifrontal(const InertiaPattern& pattern)
      : analysis_(pattern.lower, pattern.group, groups_of_border(pattern), last_rows(pattern)) {}

  InertiaFactor factorise(const SparseMatrix& lower, const std::array<double, 2>& parameters) {
    const SymmetricFactor factor(interior(lower, parameters), lower);
    if (!factor.regular()) return {};
    return {.regular = true,
            .negative_eigenvalues = factor.negative_eigenvalues(),
            .solve = [factor](const Vector& b) { return factor.solve(b); },
            .solve_from_border = [factor](const Vector& g) { return factor.solve_from_border(g); },
            .solve_to_border = [factor](const Vector& b) { return factor.solve_to_border(b); },
            .solve_on_border = [factor](const Vector& g) { return factor.solve_on_border(g); }};
  }

  void release() {
    const std::lock_guard lock(mutex_);
    interior_.reset();
  }

 private:
  static std::vector<Index> last_rows(const InertiaPattern& pattern) {
    std::vector<Index> rows(at(pattern.border));
    std::iota(rows.begin(), rows.end(), pattern.lower.rows() - pattern.border);
    return rows;
  }

  // Marks groups that have no other row; none if there are none.
  static std::vector<char> groups_of_border(const InertiaPattern& pattern) {
    const Index groups = pattern.group.empty() ? 0 : *std::max_element(pattern.group.begin(), pattern.group.end()) + 1;
    std::vector<char> of_border(at(groups), 1);
    for (Index i = 0; i < pattern.lower.rows() - pattern.border; ++i)
      if (const Index g = pattern.group[at(i)]; g >= 0) of_border[at(g)] = 0;
    return std::ranges::count(of_border, 1) > 0 ? of_border : std::vector<char>{};
  }

  SymmetricInterior interior(const SparseMatrix& lower, const std::array<double, 2>& parameters) {
    const std::lock_guard lock(mutex_);
    if (!interior_ || parameters_ != parameters) {
      interior_.reset();  // before the next takes as much memory
      interior_.emplace(analysis_, lower);
      parameters_ = parameters;
    }
    return *interior_;
  }

  SymmetricAnalysis analysis_;
  std::mutex mutex_;
  std::optional<SymmetricInterior> interior_;
  std::array<double, 2> parameters_{};
};

}  // namespace

InertiaMethod multifrontal() {
  return {"multifrontal", [](const InertiaPattern& pattern) {
            const auto own = std::make_shared<Multifrontal>(pattern);
            return InertiaFamily{
                [own](const auto& lower, const auto& parameters) { return own->factorise(lower, parameters); },
                [own] { own->release(); }};
          }};
}

InertiaFactor with_whole_solves(Index negative_eigenvalues, InertiaFactor::Solve solve, const InertiaPattern& pattern) {
  const auto spread = [n = pattern.lower.rows()](const Vector& g) {
    Vector x = Vector::Zero(n);
    x.tail(g.size()) = g;
    return x;
  };
  const auto gather = [border = pattern.border](const Vector& x) -> Vector { return x.tail(border); };
  return {.regular = true,
          .negative_eigenvalues = negative_eigenvalues,
          .solve = solve,
          .solve_from_border = [=](const Vector& g) { return solve(spread(g)); },
          .solve_to_border = [=](const Vector& b) { return gather(solve(b)); },
          .solve_on_border = [=](const Vector& g) { return gather(solve(spread(g))); }};
}

double inexactness(const InertiaFactor& factor, const SparseMatrix& lower, Index border, const Processes& processes) {
  const Vector ones = Vector::Ones(border), x = factor.solve_from_border(ones);
  const Vector correction = factor.solve_to_border(border_residual(lower, x, ones, processes));
  const double ratio = correction.norm() / x.tail(border).norm();
  return std::isfinite(ratio) ? ratio : infinity;
}

InertiaMethod first_reliable(InertiaMethod first, InertiaMethod second) {
  const auto analyse = [first, second](const InertiaPattern& pattern) {
    const auto inexact = [border = pattern.border](const InertiaFactor& factor, const SparseMatrix& lower) {
      return factor.regular ? inexactness(factor, lower, border) : infinity;
    };
    const InertiaFamily usual = first.analyse(pattern), other = second.analyse(pattern);
    const auto factorise = [=](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
      InertiaFactor factor = usual.factorise(lower, parameters);
      const double error = inexact(factor, lower);
      if (error < reliable_inexactness) return factor;
      InertiaFactor again = other.factorise(lower, parameters);
      return inexact(again, lower) < error ? again : factor;
    };
    const auto release = [=] {
      usual.release();
      other.release();
    };
    return InertiaFamily{factorise, release};
  };
  return {first.name + ", then " + second.name, analyse};
}

Vector symmetric_residual(const SparseMatrix& lower, const Vector& x, const Vector& b) {
  Vector residual = b;
  for_entries(lower, [&](Index i, Index j, double value) {
    residual[i] -= value * x[j];
    if (i != j) residual[j] -= value * x[i];
  });
  return residual;
}

Vector border_residual(const SparseMatrix& lower, const Vector& x, const Vector& g, const Processes& processes) {
  const Index border = g.size();
  Vector right = Vector::Zero(x.size());
  if (processes.first()) right.tail(border) = g;
  Vector residual = symmetric_residual(lower, x, right);
  processes.add_up({residual.data() + residual.size() - border, at(border)});
  return residual;
}

}  // namespace nscdd
