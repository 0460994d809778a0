// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "spectra/pencil_end.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <fmt/format.h>

namespace nscdd {

/// What one point of a sweep leaves to the next: the elimination order of the shifted pencil, and the ends found last
/// with their vectors, from which the next are extrapolated. Saves work; changes results within their residuals only.
struct PencilMemory {
  struct End {
    double lambda = 0, slope_epsilon = 0, slope_eta = 0;  ///< d lambda / d log epsilon, d lambda / d log eta
    Vector vector;
  };
  struct Visited {
    double epsilon = 0, eta = 0;
    End smallest, largest;
  };
  std::array<std::optional<ShiftedPencilFamily>, 2> families;  ///< for a finite and for the infinite eta
  std::vector<Visited> visited;                                ///< the last two, newest last

  /// Where one end of the spectrum is expected at a point, on logarithmic axes: by Taylor's formula from the
  /// slopes at the last point visited, and if the two last points and this one differ in epsilon alone or in
  /// eta alone, by Hermite's cubic through both. None if nothing was visited.
  std::optional<EndGuess> expected(const PencilPoint& point, End Visited::*end) const;
};

/// What the rigid limit of an operator S is worked out from, whatever eta.
struct RigidLimit {
  InterfaceOperator met;  ///< S as it was asked for
  std::shared_ptr<const RigidSystem> system;
  std::optional<Index> kernel;  ///< dim ker S, where it is known
  bool confirmed = true;        ///< an inertia count of `system` next to 0 agrees with it
};

/// What one point of a sweep leaves to the next.
struct SpectrumMemory {
  PencilMemory flexible, rigid;  ///< of epsilon > 0, and of the rigid limit
  Vector smallest, largest;      ///< interface impulses at the ends that the matrix-free solver found last, or empty
  std::optional<RigidLimit> limit;

  void forget_ends() {  ///< what is known of the contacts stays
    flexible.visited.clear();
    rigid.visited.clear();
    smallest = largest = {};
  }
};

/// Both ends by shift-invert and from the dense pencil, for omega = 1. The other solvers, and the choice of one, are in
/// spectral_radius.cpp.
SpectralRadius shift_invert_radius(const Contraction& b, const SpectralOptions& options, SpectrumMemory& memory);
SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options);

/// Fills in everything that follows from the two ends of the spectrum of B outside ker S.
void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity);

/// A spectrum of which nothing is known, and why.
SpectralRadius not_converged(std::string_view solver, std::string_view failure, Index unit_multiplicity = 0);
SpectralRadius all_unit(Index size, std::string_view solver, bool converged);  ///< S = 0, B = I

/// Error of an eigenvalue lambda = 1 - mu in units of max(1, |lambda|): digits of M are lost beside K/epsilon
/// and K/eta. The bound is several times the largest error seen against dense spectra (tests/laws).
inline double lost_to_rounding(const Contraction& b) {
  const double lightest = 0.25 * b.system.scale().maxCoeff(), epsilon = b.system.flexibility();  // 1/mass, 1/kg
  return 4e-16 * (1 + (epsilon > 0 ? lightest / epsilon : 0) + lightest / b.preconditioner.flexibility());
}

/// An upper bound x of X_infinity over P = X_eta: x = 1 + L / eta, L = stiffest, for M_E + K_E / eta <= x M_E.
double generic_at_most(const InterfaceOperator& p);

/// By how much an eigenvalue lambda of (S, P) may be off where S is the rigid limit and uncertain by t, in units of
/// X_infinity (InterfaceOperator::uncertainty): |sqrt(lambda') - sqrt(lambda)| <= t sqrt(x), because f^T S f is a
/// squared length that changes by t^2 f^T X_infinity f at most; x is `generic_at_most`.
double moved_by(double t, double lambda, const InterfaceOperator& p);

inline bool accurate(const SpectralRadius& radius, double tolerance) {
  return radius.residual <= tolerance * std::max(1.0, radius.value);
}

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
