// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/moderate_problem.hpp"

#include "core/fail.hpp"

namespace nscdd {

void require_moderate(const LocalFrictionProblem& problem, const std::string& name) {
  if (problem.contacts() == 0 || problem.q.isZero(0)) return;
  constexpr double most = 1e140;
  const auto require = [&](double size, std::string_view what) {
    if (!(size <= most && size >= 1 / most))
      fail("{}: {}: expected a number from {} to {}, met {}", name, what, 1 / most, most, size);
  };
  const double largest = problem.q.cwiseAbs().maxCoeff();
  require(largest, "largest |q|");
  require(largest / problem.w.diagonal().minCoeff(), "largest |q| over the least of W_nn and W_tt");
  require(largest / problem.w.diagonal().maxCoeff(), "largest |q| over the largest of W_nn and W_tt");
}

}  // namespace nscdd
