// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/continuation.hpp"
#include "ddm/stiffest.hpp"
#include "linalg/krylov.hpp"
#include "linalg/pencil.hpp"
#include "linalg/threads.hpp"

#include <Eigen/Cholesky>

namespace nscdd {
namespace {

// The pencil (A, P) on the P-orthogonal complement of the span of `kernel`: with P = L L^T and Q an orthonormal basis
// of the complement of L^T kernel, the columns of L^-T Q are P-orthonormal and P-orthogonal to the kernel.
PencilEnds deflated_ends(const Matrix& a, const Matrix& p, const Matrix& kernel, Index wanted) {
  PencilEnds ends;
  const Eigen::LLT<Matrix> cholesky(p);
  ends.definite = cholesky.info() == Eigen::Success;
  if (!ends.definite) return ends;
  const Matrix image = cholesky.matrixU() * kernel;
  const Matrix q = orthonormal_complement(image);
  const Matrix y = cholesky.matrixU().solve(q);
  const Matrix reduced = y.transpose() * a * y;
  ends = pencil_ends(0.5 * (reduced + reduced.transpose()), Matrix::Identity(q.cols(), q.cols()), wanted);
  if (!ends.definite) return ends;
  ends.low_vectors = y * ends.low_vectors;
  ends.high_vectors = y * ends.high_vectors;
  const Matrix lower = cholesky.matrixL();  // the residual is that of the whole pencil
  ends.residual = std::max(pair_residual(a, p, lower, ends.low, ends.low_vectors),
                           pair_residual(a, p, lower, ends.high, ends.high_vectors));
  return ends;
}

// The map, with a look at the checkpoint before each product.
LinearMap watched(LinearMap map, const std::function<void()>& checkpoint) {
  if (!checkpoint) return map;
  return [map = std::move(map), checkpoint](const Vector& x) {
    checkpoint();
    return map(x);
  };
}

SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options) {
  const auto look = [&] {
    if (options.checkpoint) options.checkpoint();
  };
  // Both matrices are scaled by D^-1/2 from both sides, D = diag(X): unequal masses no longer spoil the condition.
  const Vector root = b.system.scale().cwiseSqrt().cwiseInverse();
  const Matrix p = root.asDiagonal() * b.preconditioner.dense() * root.asDiagonal();
  look();
  // P B. The pencil (P B, P) has the eigenvalues mu themselves, so that small radii keep their digits.
  const Matrix difference = p - root.asDiagonal() * b.system.dense() * root.asDiagonal();
  const Index n = b.rows(), unit_multiplicity = b.system.nullity();
  const double tilt = b.system.uncertainty();
  if (unit_multiplicity == n) return all_unit(n, "dense", std::isfinite(tilt));
  const auto ends_of = [&](Index wanted) {
    look();
    return unit_multiplicity == 0 ? pencil_ends(difference, p, wanted)
                                  : deflated_ends(difference, p, b.system.kernel().kernel, wanted);
  };
  const Index most = n - unit_multiplicity, listed = std::min(options.eigenvalues, most);
  Index wanted = listed;
  PencilEnds ends = ends_of(wanted);
  const auto uncertain = [&] { return moved_by(tilt, 1 - ends.low[0], b.preconditioner); };
  const auto margin = [&] {  // backward errors of LAPACK grow with the size and with the largest eigenvalue
    const double largest = std::max({1.0, std::abs(ends.low[0]), std::abs(ends.high[0])});
    return std::max(ends.residual, static_cast<double>(n) * 2.3e-16 * largest) + lost_to_rounding(b) * (1 + largest) +
           uncertain();  // of S and P as they were assembled
  };
  const auto may_converge = [&] {
    return uncertain() <= options.tolerance * std::max({1.0, std::abs(ends.low[0]), std::abs(ends.high[0])});
  };
  if (options.certify && ends.definite && may_converge())  // until the list has all copies of both ends
    while (ends.definite && wanted < most &&
           (ends.low[wanted - 1] - ends.low[0] <= margin() || ends.high[0] - ends.high[wanted - 1] <= margin()))
      ends = ends_of(wanted = std::min(2 * wanted, most));
  if (!ends.definite) return not_converged("dense");
  SpectralRadius result;
  result.solver = "dense";
  set_ends(result, ends.low[0], ends.high[0], unit_multiplicity);
  result.low.assign(ends.low.begin(), ends.low.begin() + listed);
  result.high.assign(ends.high.begin(), ends.high.begin() + listed);
  result.mode_min = root.asDiagonal() * ends.low_vectors.col(0);
  result.mode_max = root.asDiagonal() * ends.high_vectors.col(0);
  result.residual = ends.residual + uncertain();
  result.converged = accurate(result, options.tolerance);
  if (options.certify && result.converged) {  // the values come from Sturm counts, which miss no eigenvalue
    result.certified = true;
    result.interval_min = {ends.low[0] - margin(), ends.low[0] + margin()};
    result.interval_max = {ends.high[0] - margin(), ends.high[0] + margin()};
    const auto within = [&](const Vector& values) { return ((values.array() - values[0]).abs() <= margin()).count(); };
    result.within_min = within(ends.low);
    result.within_max = within(ends.high);
  }
  return result;
}

// An eigenvalue lambda of the pencil (S, P) from its vector, and the bound of its residual.
std::pair<double, double> rayleigh(const Vector& x, const LinearMap& s, const InterfaceOperator& p) {
  const Vector sx = s(x), px = p.apply(x);
  const double norm = x.dot(px);
  const double lambda = x.dot(sx) / norm;
  const Vector r = sx - lambda * px;
  return {lambda, std::sqrt(std::max(0.0, r.dot(p.solve(r))) / norm)};
}

SpectralRadius arpack_radius(const Contraction& b, const SpectralOptions& options, Continuation& memory) {
  const Index n = b.rows(), unit_multiplicity = b.system.nullity();
  if (unit_multiplicity > 0 && n > dense_kernel_limit)  // the kernel is found densely
    return not_converged("arpack", unit_multiplicity);
  SpectralRadius result;
  result.solver = "arpack";
  const auto counting = [&](auto product) {
    return watched([&result, product](const Vector& x) -> Vector { return ++result.applications, product(x); },
                   options.checkpoint);
  };
  const LinearMap p_apply = counting([&](const Vector& x) { return b.preconditioner.apply(x); });
  const LinearMap p_solve = counting([&](const Vector& x) { return b.preconditioner.solve(x); });
  LinearMap s_apply = counting([&](const Vector& x) { return b.system.apply(x); });

  const double tilt = b.system.uncertainty();
  if (unit_multiplicity == n) return all_unit(n, "arpack", std::isfinite(tilt));
  if (unit_multiplicity > 0) {
    // Deflation: S + sigma P Z (Z^T P Z)^-1 Z^T P moves ker S = span Z to sigma. This is a Rayleigh quotient
    // of the complement, so it lies between its ends.
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
  const LanczosResult high =
      lanczos(n, s_apply, p_apply, p_solve, SpectrumEnd::largest, options.arpack, memory.largest);
  // For small epsilon the low end crowds at 0, and Lanczos on P^-1 S stalls there. On S^-1 P it is isolated.
  const LinearMap s_solve = counting([&](const Vector& x) { return b.system.solve(x); });
  const LanczosResult low =
      b.system.eta() == 0
          ? lanczos(n, s_apply, p_apply, p_solve, SpectrumEnd::smallest, options.arpack, memory.smallest)
          : lanczos(n, p_apply, s_apply, s_solve, SpectrumEnd::largest, options.arpack, memory.smallest);
  // If an end was not found, the next point starts from the vector of the point before.
  if (high.vector.size() > 0) memory.largest = high.vector;
  if (low.vector.size() > 0) memory.smallest = low.vector;
  if (high.vector.size() == 0 || low.vector.size() == 0) {
    SpectralRadius failed = not_converged("arpack");
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
  result.residual = std::max(high_residual, low_residual) + moved_by(tilt, largest, b.preconditioner);
  result.converged = high.converged && low.converged && accurate(result, options.tolerance);
  return result;
}

SpectralRadius slepc_radius(const Contraction& b, const SpectralOptions& options) {
  if (!options.slepc) throw Error("solver slepc: expected a program with SLEPc, nscdd-mpi, met one without");
  if (options.certify || options.eigenvalues > 1)
    throw Error("solver slepc: expected dense or shift-invert to certify and for more eigenvalues, met slepc");
  SpectralRadius result = options.slepc(b, options);
  if (result.low.empty()) return not_converged("slepc");
  result.solver = "slepc";
  set_ends(result, result.low.front(), result.high.front(), 0);
  result.converged = accurate(result, options.tolerance);
  return result;
}

}  // namespace

void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity) {
  result.subdominant_min = mu_min;
  result.subdominant_max = mu_max;
  result.subdominant = std::max(std::abs(mu_min), std::abs(mu_max));
  result.unit_multiplicity = unit_multiplicity;
  const bool unit = unit_multiplicity > 0;  // an eigenvalue 1 of B stays 1 whatever omega
  result.eigenvalue_min = unit ? std::min(mu_min, 1.0) : mu_min;
  result.eigenvalue_max = unit ? std::max(mu_max, 1.0) : mu_max;
  result.value = std::max(std::abs(result.eigenvalue_min), std::abs(result.eigenvalue_max));
}

double moved_by(double t, double lambda, const InterfaceOperator& p) {
  if (t == 0) return 0;
  const double side = t * (std::isinf(p.eta()) ? 1 : std::sqrt(1 + stiffest(p.parts()) / p.eta()));
  return side * (2 * std::sqrt(std::max(0.0, lambda)) + side);
}

SpectralRadius not_converged(std::string_view solver, Index unit_multiplicity) {
  SpectralRadius failed;
  failed.unit_multiplicity = unit_multiplicity;
  failed.value = failed.subdominant = failed.residual = not_a_number;
  failed.solver = solver;
  failed.converged = false;
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
  // What the solver found is as good as before; the accuracy asked for may be another.
  result.converged = plain.converged ? accurate(result, tolerance) : false;
  return result;
}

SolverChoice choose_solver(Index size, bool rigid, const SpectralOptions& options) {
  const bool automatic = options.solver == SpectralSolver::automatic;
  if (size < arpack_smallest_size || (automatic && size <= options.dense_limit)) return {SpectralSolver::dense};
  if (automatic) return {SpectralSolver::shift_invert, rigid && size <= dense_kernel_limit};
  return {options.solver};
}

SolverChoice choose_inexact_solver(Index size, const SpectralOptions& options) {
  constexpr Index dense_limit = 400, fallback_limit = 2500;  // the latter: what may be waited for
  const bool automatic = options.solver == SpectralSolver::automatic;
  if (options.solver == SpectralSolver::dense || size < arpack_smallest_size || (automatic && size <= dense_limit))
    return {SpectralSolver::dense};
  return {SpectralSolver::arpack, automatic && size <= fallback_limit};
}

SpectralRadius spectral_radius(const Contraction& b, const SpectralOptions& options, Continuation* memory) {
  const OneBlasThread serial_blas;
  const Index n = b.rows();
  if (n == 0) {
    SpectralRadius empty;
    empty.certified = options.certify;  // no eigenvalue can be missed
    return empty;
  }
  Continuation local;
  Continuation& known = memory != nullptr ? *memory : local;
  const SolverChoice choice = choose_solver(n, b.system.eta() == 0, options);
  SpectralRadius plain = choice.solver == SpectralSolver::dense    ? dense_radius(b, options)
                         : choice.solver == SpectralSolver::arpack ? arpack_radius(b, options, known)
                         : choice.solver == SpectralSolver::slepc  ? slepc_radius(b, options)
                                                                   : shift_invert_radius(b, options, known);
  // A last resort, for small eta (docs/algorithms.md, section 7).
  if (!plain.converged && choice.dense_fallback) plain = dense_radius(b, options);
  return relaxed(plain, b.relaxation, options.tolerance);
}

}  // namespace nscdd
