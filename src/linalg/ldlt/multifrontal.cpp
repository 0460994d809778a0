// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/ldlt/factor.hpp"
#include <nscdd/linalg/inertia_factor.hpp>

#include <memory>
#include <mutex>
#include <numeric>
#include <optional>

namespace nscdd {
namespace {

std::vector<Index> last_rows(const InertiaPattern& pattern) {
  std::vector<Index> rows(at(pattern.border));
  std::iota(rows.begin(), rows.end(), pattern.lower.rows() - pattern.border);
  return rows;
}

// One analysis, and the interior of the matrix that was factorised last.
class Multifrontal {
 public:
  explicit Multifrontal(const InertiaPattern& pattern)
      : analysis_(pattern.lower, pattern.group, {}, last_rows(pattern)) {}

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
            return InertiaFamily{[own](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
                                   return own->factorise(lower, parameters);
                                 },
                                 [own] { own->release(); }};
          }};
}

}  // namespace nscdd
