// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "study/linear/curve.hpp"
#include "study/linear/values.hpp"

namespace nscdd {
namespace {

// What a proof asks for, beside the range.
void require_provable(const SweepParameters& sweep, std::string_view dashes) {
  for (const auto& sweeps : sweep.gauss_seidel_sweeps)
    if (sweeps)
      fail("{0}gauss-seidel-sweeps: expected inf with {0}curve (an inexact Stage 1 has no symmetric pencil), met {1}",
           dashes, *sweeps);
  for (const auto& relaxation : sweep.relaxation)
    if (!relaxation)
      fail("{0}relaxation: expected numbers with {0}curve (the optimal one changes along the curve), met optimal",
           dashes);
  const auto solver = sweep.spectral.solver;
  if (solver == SpectralSolver::arpack || solver == SpectralSolver::slepc)
    fail("{0}solver: expected auto, dense or shift-invert with {0}curve (others prove no end of a spectrum), met {1}",
         dashes, to_string(solver));
}

}  // namespace

CurveParameters curve_parameters(double tolerance, const std::string& epsilon, const std::string& eta,
                                 SweepParameters rest, std::string_view dashes) {
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    fail("{}curve: expected a finite tolerance > 0, met {}", dashes, tolerance);
  require_provable(rest, dashes);
  const auto along_epsilon = parse_range(epsilon, "epsilon"), along_eta = parse_range(eta, "eta");
  if (along_epsilon.has_value() == along_eta.has_value())
    fail(
        "{0}curve: expected one range FROM:TO without a count, of {0}epsilon or of {0}eta, met {0}epsilon {1} {0}eta "
        "{2}",
        dashes, epsilon, eta);
  CurveParameters curve{
      .sweep = std::move(rest), .axis = along_epsilon ? CurveAxis::epsilon : CurveAxis::eta, .tolerance = tolerance};
  if (along_epsilon) {
    curve.sweep.epsilon = {along_epsilon->from, along_epsilon->to};
    curve.sweep.relative_epsilon = along_epsilon->relative;
    std::tie(curve.sweep.eta, curve.sweep.relative_eta) = parse_eta(eta);
  } else {
    std::tie(curve.sweep.epsilon, curve.sweep.relative_epsilon) = parse_epsilon(epsilon);
    curve.sweep.eta = {along_eta->from, along_eta->to};
    curve.sweep.relative_eta = along_eta->relative;
  }
  return curve;
}

}  // namespace nscdd
