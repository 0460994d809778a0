// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/spectra/spectral_radius.hpp>

#include <fmt/format.h>

namespace nscdd {

/// Result of the first solver of a choice that `answers`, tried in order. If none does, the most informative result,
/// with the reason of each in `failure`, and with all of them in `solver` unless it converged. `solve(solver)` is a
/// SpectralRadius or a MapRadius, whose `failure` may say why it has no answer.
template <class Solve, class Answers>
auto first_answer(const SolverChoice& choice, double tolerance, Solve&& solve, Answers&& answers) {
  const auto reason = [&](const auto& one) -> std::string {
    if (!one.failure.empty()) return one.failure;
    if (one.converged) return "its answer is not proved";
    if (one.residual <= tolerance * std::max(1.0, std::abs(one.value))) return "it has not converged";
    return fmt::format("residual {:.1e} above the tolerance {:.1e}", one.residual, tolerance);
  };
  const auto says_more = [](const auto& first, const auto& second) {
    if (first.converged != second.converged) return second.converged;
    return second.residual < first.residual || (std::isnan(first.residual) && !std::isnan(second.residual));
  };
  auto best = solve(choice.solver);
  if (answers(best)) return best;
  std::string tried = best.solver, failures = fmt::format("{}: {}", best.solver, reason(best));
  for (const SpectralSolver solver : choice.fallbacks) {
    auto next = solve(solver);
    if (answers(next)) return next;
    tried += "+" + next.solver;
    failures += fmt::format("; {}: {}", next.solver, reason(next));
    if (says_more(best, next)) best = std::move(next);
  }
  if (!best.converged) best.solver = tried;
  best.failure = failures;
  return best;
}

}  // namespace nscdd
