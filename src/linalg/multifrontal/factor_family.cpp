// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/multifrontal/factor.hpp"

namespace nscdd {

SymmetricFactor SymmetricFamily::factorise(const SparseMatrix& lower, const std::array<double, 2>& parameters) {
  std::unique_lock lock(mutex_);
  if (!interior_ || parameters_ != parameters) {
    interior_.reset();  // frees its memory before the next one
    interior_ = eliminated_interior(analysis_, lower);
    parameters_ = parameters;
  }
  const SymmetricInterior interior = interior_;
  lock.unlock();
  return {interior, lower};
}

bool SymmetricFamily::keeps_interior(const std::array<double, 2>& parameters) {
  const std::lock_guard lock(mutex_);
  return interior_ && parameters_ == parameters;
}

void SymmetricFamily::release() {
  const std::lock_guard lock(mutex_);
  interior_.reset();
}

std::vector<char> groups_of_border(const InertiaPattern& pattern) {
  const Index groups = pattern.group.empty() ? 0 : *std::max_element(pattern.group.begin(), pattern.group.end()) + 1;
  std::vector<char> of_border(at(groups), 1);
  for (Index i = 0; i < pattern.lower.rows() - pattern.border; ++i)
    if (const Index g = pattern.group[at(i)]; g >= 0) of_border[at(g)] = 0;
  return std::ranges::count(of_border, 1) > 0 ? of_border : std::vector<char>{};
}

InertiaMethod multifrontal(std::shared_ptr<WorkCount> work) {
  const auto analyse = [work](const InertiaPattern& pattern) {
    std::vector<Index> border(at(pattern.border));
    std::iota(border.begin(), border.end(), pattern.lower.rows() - pattern.border);
    const GroupFlags flags{.last = groups_of_border(pattern), .kept = {}};
    const auto own = std::make_shared<SymmetricFamily>(SymmetricAnalysis(pattern.lower, pattern.group, flags, border));
    const EliminationWork amount = own->analysis().work();
    const auto count = [work](double flops) {
      for (double* total : {&work->flops, &work->path_flops}) WorkCount::add(*total, flops);
    };
    const auto factorise = [=](const SparseMatrix& lower, const std::array<double, 2>& parameters) -> InertiaFactor {
      count(amount.flops(!own->keeps_interior(parameters)));
      const SymmetricFactor factor = own->factorise(lower, parameters);
      if (!factor.regular()) return {};
      const auto solve = [&](auto how, Fronts up, Fronts down) {
        return [=](const Vector& b) {
          count(amount.solve_flops(up, down));
          return (factor.*how)(b);
        };
      };
      return {.regular = true,
              .negative_eigenvalues = factor.negative_eigenvalues(),
              .solve = solve(&SymmetricFactor::solve, Fronts::all, Fronts::all),
              .solve_from_border = solve(&SymmetricFactor::solve_from_border, Fronts::border, Fronts::all),
              .solve_to_border = solve(&SymmetricFactor::solve_to_border, Fronts::all, Fronts::border),
              .solve_on_border = solve(&SymmetricFactor::solve_on_border, Fronts::border, Fronts::border)};
    };
    return InertiaFamily{factorise, [own] { own->release(); }};
  };
  return {"multifrontal", analyse};
}

}  // namespace nscdd
