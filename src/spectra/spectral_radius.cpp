// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "core/memory.hpp"
#include "ddm/enriched_inertia.hpp"
#include "linalg/pencil.hpp"
#include "linalg/threads.hpp"
#include "spectra/spectrum_memory.hpp"

#include <Eigen/Cholesky>

namespace nscdd {
namespace {

SpectralRadius arpack_radius(const Contraction& b, const SpectralOptions& options, SpectrumMemory& memory) {
  const Index n = b.rows(), unit_multiplicity = b.system.nullity();
  if (unit_multiplicity > 0 && n > dense_kernel_limit)
    return not_converged(
        "arpack", fmt::format("the kernel of S is found densely up to {} unknowns: met {}", dense_kernel_limit, n),
        unit_multiplicity);
  if (unit_multiplicity > 0)
    require_memory(5 * bytes_of_matrix(n, n), fmt::format("the kernel of S of {} interface unknowns", n));
  SpectralRadius result;
  result.solver = "arpack";
  const auto counting = [&](auto product) -> LinearMap {
    return [&, product](const Vector& x) -> Vector {
      if (options.checkpoint) options.checkpoint();
      return ++result.applications, product(x);
    };
  };
  const LinearMap p_apply = counting([&](const Vector& x) { return b.preconditioner.apply(x); });
  const LinearMap p_solve = counting([&](const Vector& x) { return b.preconditioner.solve(x); });
  LinearMap s_apply = counting([&](const Vector& x) { return b.system.apply(x); });

  const double tilt = b.system.uncertainty();
  if (unit_multiplicity == n) return all_unit(n, "arpack", std::isfinite(tilt));
  if (unit_multiplicity > 0) {
    // Deflation: S + sigma P Z (Z^T P Z)^-1 Z^T P moves ker S = span Z to sigma, a Rayleigh quotient of the complement.
    const Vector root = b.system.scale().cwiseSqrt();
    const KernelSplit& split = b.system.kernel();  // in coordinates scaled by the root
    const Matrix z = root.cwiseInverse().asDiagonal() * split.kernel;
    const Vector inner = p_solve(root.asDiagonal() * split.range.rowwise().sum());  // in P^-1 range(S)
    const double sigma = inner.dot(s_apply(inner)) / inner.dot(p_apply(inner));
    Matrix pz(n, unit_multiplicity);
    for (Index j = 0; j < unit_multiplicity; ++j) pz.col(j) = p_apply(z.col(j));
    const Matrix gram = z.transpose() * pz;
    s_apply = [s = s_apply, pz, sigma, cholesky = Eigen::LLT<Matrix>(gram)](const Vector& x) -> Vector {
      return s(x) + sigma * (pz * cholesky.solve(pz.transpose() * x));
    };
  }
  // Products that have lost digits (small epsilon or eta) may not reach ARPACK's tolerance; the residual needs less.
  const auto find = [&](const LinearMap& a, const LinearMap& m, const LinearMap& m_inverse, SpectrumEnd end,
                        const Vector& start) {
    ArpackOptions accuracy = options.arpack;
    const LanczosResult first = lanczos(n, a, m, m_inverse, end, accuracy, start);
    if (first.vector.size() > 0) return first;
    accuracy.tolerance = std::max(accuracy.tolerance, 0.01 * options.tolerance);
    return lanczos(n, a, m, m_inverse, end, accuracy, start);
  };
  const LanczosResult high = find(s_apply, p_apply, p_solve, SpectrumEnd::largest, memory.largest);
  // For small epsilon the low end crowds at 0, and Lanczos on P^-1 S stalls. On S^-1 P it is isolated.
  const LinearMap s_solve = counting([&](const Vector& x) { return b.system.solve(x); });
  const LanczosResult low = b.system.flexibility() == 0
                                ? find(s_apply, p_apply, p_solve, SpectrumEnd::smallest, memory.smallest)
                                : find(p_apply, s_apply, s_solve, SpectrumEnd::largest, memory.smallest);
  // If an end was not found, the vector of the point before stays the start of the next.
  if (high.vector.size() > 0) memory.largest = high.vector;
  if (low.vector.size() > 0) memory.smallest = low.vector;
  if (high.vector.size() == 0 || low.vector.size() == 0) {
    SpectralRadius failed =
        not_converged("arpack", fmt::format("no eigenvalue at the {} end", high.vector.size() == 0 ? "low" : "high"));
    failed.applications = result.applications;
    return failed;
  }
  const auto [largest, high_residual] = rayleigh(high.vector, s_apply, b.preconditioner);
  const auto [smallest, low_residual] = rayleigh(low.vector, s_apply, b.preconditioner);
  set_ends(result, 1.0 - largest, 1.0 - smallest, unit_multiplicity);
  result.low = {result.subdominant_min};
  result.high = {result.subdominant_max};
  result.mode_min = high.vector;
  result.mode_max = low.vector;
  result.residual = std::max(high_residual, low_residual) + moved_by(tilt, largest, b);
  result.converged = high.converged && low.converged && accurate(result, options.tolerance);
  if (!high.converged || !low.converged) result.failure = "Lanczos has not converged";
  return result;
}

SpectralRadius slepc_radius(const Contraction& b, const SpectralOptions& options) {
  if (!options.slepc) throw Error("solver slepc: expected a program with SLEPc, nscdd-mpi, met one without");
  if (options.certify || options.eigenvalues > 1)
    throw Error("solver slepc: expected dense or shift-invert to certify and for more eigenvalues, met slepc");
  SpectralRadius result = options.slepc(b, options);
  if (result.low.empty()) return not_converged("slepc", "Krylov-Schur has not converged");
  result.solver = "slepc";
  set_ends(result, result.low.front(), result.high.front(), 0);
  result.converged = accurate(result, options.tolerance);
  return result;
}

}  // namespace

std::pair<double, double> rayleigh(const Vector& x, const LinearMap& s, const InterfaceOperator& p) {
  const Vector sx = s(x), px = p.apply(x);
  const double norm = x.dot(px);
  const double lambda = x.dot(sx) / norm;
  const Vector r = sx - lambda * px, y = p.solve(r);
  const bool solved = (p.apply(y) - r).norm() <= 0.1 * r.norm();
  return {lambda, solved ? std::sqrt(std::max(0.0, r.dot(y)) / norm) : infinity};
}

void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity) {
  result.subdominant_min = mu_min;
  result.subdominant_max = mu_max;
  result.subdominant = std::max(std::abs(mu_min), std::abs(mu_max));
  result.unit_multiplicity = unit_multiplicity;
  const bool unit = unit_multiplicity > 0;  // an eigenvalue 1 of B stays 1 for any omega
  result.eigenvalue_min = unit ? std::min(mu_min, 1.0) : mu_min;
  result.eigenvalue_max = unit ? std::max(mu_max, 1.0) : mu_max;
  result.value = std::max(std::abs(result.eigenvalue_min), std::abs(result.eigenvalue_max));
}

double generic_at_most(const InterfaceOperator& p) {
  return std::isinf(p.flexibility()) ? 1.0 : 1 + stiffest(p.decomposition()) / p.flexibility();
}

double moved_by(double t, double lambda, const Contraction& b) {
  if (t == 0) return 0;
  if (b.schwarz())
    return static_cast<double>(largest_multiplicity(b.system.decomposition().interface) - 1) * t * (2 + t);
  const double side = t * std::sqrt(generic_at_most(b.preconditioner));
  return side * (2 * std::sqrt(std::max(0.0, lambda)) + side);
}

SpectralRadius not_converged(std::string_view solver, std::string_view failure, Index unit_multiplicity) {
  SpectralRadius failed;
  failed.unit_multiplicity = unit_multiplicity;
  failed.value = failed.subdominant = failed.residual = not_a_number;
  failed.solver = solver;
  failed.converged = false;
  failed.failure = failure;
  return failed;
}

SpectralRadius all_unit(Index size, std::string_view solver, bool converged) {
  SpectralRadius result;
  result.converged = converged;
  if (!converged) result.residual = infinity;
  result.solver = solver;
  result.value = result.eigenvalue_min = result.eigenvalue_max = 1.0;
  result.unit_multiplicity = size;
  return result;
}

SpectralRadius relaxed(const SpectralRadius& plain, double omega, double tolerance) {
  if (omega == 1.0 || plain.solver == "none" || std::isnan(plain.subdominant_min)) return plain;
  const auto shift = [omega](double mu) { return 1.0 - omega * (1.0 - mu); };
  SpectralRadius result = plain;
  set_ends(result, shift(plain.subdominant_min), shift(plain.subdominant_max), plain.unit_multiplicity);
  for (auto* values : {&result.low, &result.high})
    for (double& mu : *values) mu = shift(mu);
  for (auto* interval : {&result.interval_min, &result.interval_max})
    for (double& mu : *interval) mu = shift(mu);
  result.residual = omega * plain.residual;
  // The result is as good as before, but the tolerance may differ.
  result.converged = plain.converged && accurate(result, tolerance);
  if (plain.converged && !result.converged)
    result.failure =
        fmt::format("{}: the relaxation {} brings the residual to {:.1e}", plain.solver, omega, result.residual);
  return result;
}

void check(const SpectralOptions& options, std::string_view dashes) {
  using enum SpectralSolver;
  if ((options.solver == arpack || options.solver == slepc) && (options.certify || options.eigenvalues > 1))
    fail("{0}solver: expected auto, dense or shift-invert with {0}certify or {0}eigenvalues, met {1}", dashes,
         to_string(options.solver));
}

void require_solver_of(DecompositionScheme scheme, const SpectralOptions& options, std::string_view dashes) {
  using enum SpectralSolver;
  if (scheme == DecompositionScheme::schwarz && (options.solver == arpack || options.solver == slepc))
    fail("{0}solver: expected auto, dense or shift-invert with {0}scheme schwarz, met {1}", dashes,
         to_string(options.solver));
}

SolverChoice choose_solver(Index size, const SpectralOptions& options, bool alone) {
  using enum SpectralSolver;
  if (size < arpack_smallest_size) return {dense};
  if (options.solver != automatic) return {options.solver};
  SolverChoice choice{shift_invert};
  if (size <= options.dense_limit)
    choice = {dense, {shift_invert}};
  else if (size <= dense_fallback_limit)
    choice = {shift_invert, {dense}};
  if (alone) choice.fallbacks.push_back(arpack);
  return choice;
}

SolverChoice choose_inexact_solver(Index size, const SpectralOptions& options) {
  using enum SpectralSolver;
  constexpr Index dense_limit = 400, fallback_limit = 2500;  // the latter bounds the waiting time
  if (size < arpack_smallest_size || options.solver == dense) return {dense};
  if (options.solver != automatic) return {arpack};
  if (size <= dense_limit) return {dense, {arpack}};
  if (size <= fallback_limit) return {arpack, {dense}};
  return {arpack};
}

SpectralRadius spectral_radius(const Contraction& b, const SpectralOptions& options, SpectrumMemory* memory) {
  if (options.eigenvalues < 1) fail("eigenvalues: expected at least 1, met {}", options.eigenvalues);
  const OneBlasThread serial_blas;
  const Index n = b.rows();
  if (n == 0) {
    SpectralRadius empty;
    empty.certified = options.certify;  // no eigenvalue can be missed
    return empty;
  }
  require_solver_of(b.scheme, options);
  const bool alone = b.system.decomposition().interface.processes().alone();
  const SolverChoice choice = choose_solver(n, options, alone && !b.schwarz());  // ARPACK has no pencil of schwarz
  const auto solve = [&](SpectralSolver solver) {
    SpectrumMemory none;  // a fallback does not depend on the points before
    SpectrumMemory& known = memory != nullptr && solver == choice.solver ? *memory : none;
    if (solver == SpectralSolver::dense) return dense_radius(b, options);
    if (solver == SpectralSolver::arpack) return arpack_radius(b, options, known);
    if (solver == SpectralSolver::slepc) return slepc_radius(b, options);
    return shift_invert_radius(b, options, known);
  };
  const auto answers = [&](const SpectralRadius& one) { return one.converged && (!options.certify || one.certified); };
  return relaxed(first_answer(choice, options.tolerance, solve, answers), b.relaxation, options.tolerance);
}

}  // namespace nscdd
