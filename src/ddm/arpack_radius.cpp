// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/spectrum_ends.hpp"
#include "linalg/arpack.hpp"
#include "linalg/pencil.hpp"

#include <Eigen/Cholesky>

namespace nscdd {
namespace {

// One end of the pencil (S, P) as an eigenvalue lambda with its residual bound.
struct End {
  double lambda = not_a_number;
  double residual = infinity;
};

End rayleigh(const Vector& x, const LinearMap& s, const InterfaceOperator& p) {
  const Vector sx = s(x), px = p.apply(x);
  const double norm = x.dot(px);
  const double lambda = x.dot(sx) / norm;
  const Vector r = sx - lambda * px;
  return {lambda, std::sqrt(std::max(0.0, r.dot(p.solve(r))) / norm)};
}

}  // namespace

SpectralRadius arpack_radius(const Contraction& b, const SpectralOptions& options, Continuation& memory) {
  const Index n = b.rows();
  const bool rigid = b.system.eta() == 0;
  const Index unit_multiplicity = b.system.nullity();
  if (unit_multiplicity > 0 && n > dense_kernel_limit) {  // the kernel is found densely
    SpectralRadius failed = not_converged("arpack");
    failed.unit_multiplicity = unit_multiplicity;
    return failed;
  }
  SpectralRadius result;
  result.solver = "arpack";
  const auto p_apply = [&](const Vector& x) -> Vector { return ++result.applications, b.preconditioner.apply(x); };
  const auto p_solve = [&](const Vector& x) -> Vector { return ++result.applications, b.preconditioner.solve(x); };
  LinearMap s_apply = [&](const Vector& x) -> Vector { return ++result.applications, b.system.apply(x); };

  if (unit_multiplicity == n) return all_unit(n, "arpack");
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
  MatrixFreeMemory& last = memory.matrix_free;
  const LanczosResult high = lanczos(n, s_apply, p_apply, p_solve, SpectrumEnd::largest, options.arpack, last.largest);
  // For small epsilon the low end crowds at 0, and Lanczos on P^-1 S stalls there. On S^-1 P it is isolated.
  const auto s_solve = [&](const Vector& x) -> Vector { return ++result.applications, b.system.solve(x); };
  const LanczosResult low =
      rigid ? lanczos(n, s_apply, p_apply, p_solve, SpectrumEnd::smallest, options.arpack, last.smallest)
            : lanczos(n, p_apply, s_apply, s_solve, SpectrumEnd::largest, options.arpack, last.smallest);
  // If an end was not found, the next point starts from the vector of the point before.
  if (high.vector.size() > 0) last.largest = high.vector;
  if (low.vector.size() > 0) last.smallest = low.vector;
  if (high.vector.size() == 0 || low.vector.size() == 0) {
    SpectralRadius failed = not_converged("arpack");
    failed.applications = result.applications;
    return failed;
  }
  const End high_end = rayleigh(high.vector, s_apply, b.preconditioner);
  const End low_end = rayleigh(low.vector, s_apply, b.preconditioner);
  set_ends(result, 1.0 - high_end.lambda, 1.0 - low_end.lambda, unit_multiplicity);
  result.low = {result.subdominant_min};
  result.high = {result.subdominant_max};
  result.mode_min = high.vector;
  result.mode_max = low.vector;
  result.residual = std::max(high_end.residual, low_end.residual);
  result.converged = high.converged && low.converged && accurate(result, options.tolerance);
  return result;
}

}  // namespace nscdd
