// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "spectra/pencil_end.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <fmt/format.h>

namespace nscdd {

/// Warm start of the next point of a sweep by shift-invert: the elimination order of the shifted pencil, and the last
/// ends with their vectors, from which the next are extrapolated. Changes results within their residuals only.
struct PencilMemory {
  struct End {
    double lambda = 0, slope_epsilon = 0, slope_eta = 0;  ///< d lambda / d log epsilon, d lambda / d log eta
    Vector vector;
  };
  struct Visited {
    double epsilon = 0, eta = 0;
    End smallest, largest;
  };
  std::array<std::optional<ShiftedPencilFamily>, 2> families;  ///< for finite, for infinite eta
  std::vector<Visited> visited;                                ///< the last two, newest last

  /// Extrapolates one end of the spectrum to a point, on logarithmic axes: by Taylor's formula from the slopes at the
  /// last point or, if the last two points and this one differ only in epsilon or only in eta, by Hermite's cubic.
  std::optional<EndGuess> expected(const PencilPoint& point, End Visited::*end) const;
};

/// Data of the rigid limit of an operator S, for any eta.
struct RigidLimit {
  InterfaceOperator met;  ///< S as it was asked for
  std::shared_ptr<const RigidSystem> system;
  std::optional<Index> kernel;  ///< dim ker S, if known
  bool confirmed = true;        ///< an inertia count of `system` next to 0 agrees with it
};

/// Warm start of the next point of a sweep, for all solvers.
struct SpectrumMemory {
  PencilMemory flexible, rigid;  ///< for epsilon > 0, and for the rigid limit
  Vector smallest, largest;      ///< modes of the last ends of the matrix-free solver, or empty
  std::optional<RigidLimit> limit;

  void forget_ends() {  ///< keeps what depends only on the contacts
    flexible.visited.clear();
    rigid.visited.clear();
    smallest = largest = {};
  }
};

/// Both ends by shift-invert or from the dense pencil, for omega = 1. The other solvers are in spectral_radius.cpp.
SpectralRadius shift_invert_radius(const Contraction& b, const SpectralOptions& options, SpectrumMemory& memory);
SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options);

/// Sets what follows from the two ends of the spectrum of B outside ker S.
void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity);

/// A spectrum without results, and why.
SpectralRadius not_converged(std::string_view solver, std::string_view failure, Index unit_multiplicity = 0);
SpectralRadius all_unit(Index size, std::string_view solver, bool converged);  ///< S = 0, B = I

/// Error of an eigenvalue in units of max(1, |lambda|): M loses digits against K/epsilon and K/eta. Several times the
/// largest error against dense spectra (tests/laws).
inline double lost_to_rounding(const Contraction& b) {
  const double lightest = (b.schwarz() ? 1 : 0.25) * b.system.scale().maxCoeff(),
               epsilon = b.system.flexibility();  // 1/mass, 1/kg
  return 4e-16 * (1 + (epsilon > 0 ? lightest / epsilon : 0) + lightest / b.preconditioner.flexibility());
}

/// lambda of (S, P) from its vector, with its residual bound: infinite if solutions with P are no solutions.
std::pair<double, double> rayleigh(const Vector& x, const LinearMap& s, const InterfaceOperator& p);

/// An upper bound x of X_infinity over P = X_eta: x = 1 + L / eta with L = stiffest, as M_E + K_E / eta <= x M_E.
double generic_at_most(const InterfaceOperator& p);

/// Error of an eigenvalue lambda of (S, P) if S is the rigid limit with uncertainty t, in units of X_infinity
/// (InterfaceOperator::uncertainty): |sqrt(lambda') - sqrt(lambda)| <= t sqrt(x) with x of `generic_at_most`, because
/// f^T S f is a squared length that changes by at most t^2 f^T X_infinity f. Of schwarz, the eigenvalues are those of
/// Pi G Pi with |G| = q - 1, and the projector Pi moves by t.
double moved_by(double t, double lambda, const Contraction& b);

inline bool accurate(const SpectralRadius& radius, double tolerance) {
  return radius.residual <= tolerance * std::max(1.0, radius.value);
}

/// Result of the first solver of a choice that `answers`, tried in order. If none does: the most informative result,
/// with all reasons in `failure` and, unless it converged, all names in `solver`.
auto first_answer(const SolverChoice& choice, double tolerance, auto&& solve, auto&& answers) {
  const auto reason = [&](const auto& one) -> std::string {
    if (!one.failure.empty()) return one.failure;
    if (one.converged) return "its answer is not proved";
    if (one.residual <= tolerance * std::max(1.0, std::abs(one.value))) return "it has not converged";
    return fmt::format("residual {:.1e} above the tolerance {:.1e}", one.residual, tolerance);
  };
  const auto is_better = [](const auto& next, const auto& best) {
    if (next.converged != best.converged) return next.converged;
    return next.residual < best.residual || (std::isnan(best.residual) && !std::isnan(next.residual));
  };
  auto best = solve(choice.solver);
  if (answers(best)) return best;
  std::string tried = best.solver, failures = fmt::format("{}: {}", best.solver, reason(best));
  for (const SpectralSolver solver : choice.fallbacks) {
    auto next = solve(solver);
    if (answers(next)) return next;
    tried += "+" + next.solver;
    failures += fmt::format("; {}: {}", next.solver, reason(next));
    if (is_better(next, best)) best = std::move(next);
  }
  if (!best.converged) best.solver = tried;
  best.failure = failures;
  return best;
}

}  // namespace nscdd
