// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/core/error.hpp>
#include <nscdd/ddm/spectral_radius.hpp>
#include <nscdd/linalg/pencil.hpp>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

constexpr Index rigid_kernel_limit = 4000;  // interface unknowns up to which ker S is computed densely

SpectralRadius not_converged(std::string_view solver) {
  SpectralRadius failed;
  failed.value = failed.subdominant = failed.residual = not_a_number;
  failed.solver = solver;
  failed.converged = false;
  return failed;
}

// Fills in everything that follows from the two ends of the spectrum of P^-1 S outside its kernel, given as
// mu = 1 - lambda, for relaxation omega.
void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity, double omega) {
  const auto relaxed = [omega](double mu) { return omega == 1.0 ? mu : 1.0 - omega * (1.0 - mu); };
  result.subdominant_min = std::min(relaxed(mu_min), relaxed(mu_max));
  result.subdominant_max = std::max(relaxed(mu_min), relaxed(mu_max));
  result.subdominant = std::max(std::abs(result.subdominant_min), std::abs(result.subdominant_max));
  result.unit_multiplicity = unit_multiplicity;
  const bool unit = unit_multiplicity > 0;  // an eigenvalue 1 of B stays 1 whatever omega
  result.eigenvalue_min = unit ? std::min(result.subdominant_min, 1.0) : result.subdominant_min;
  result.eigenvalue_max = unit ? std::max(result.subdominant_max, 1.0) : result.subdominant_max;
  result.value = std::max(std::abs(result.eigenvalue_min), std::abs(result.eigenvalue_max));
}

SpectralRadius all_unit(Index size, std::string_view solver) {  // S = 0, B = I
  SpectralRadius result;
  result.solver = solver;
  result.value = result.eigenvalue_min = result.eigenvalue_max = 1.0;
  result.unit_multiplicity = size;
  return result;
}

SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options) {
  const Matrix& s = b.system.dense();
  const Matrix& p = b.preconditioner.dense();
  const Matrix difference = p - s;  // P B: solved for mu directly, so that small radii keep their digits
  const bool rigid = b.system.eta() == 0;
  PencilEnds ends;
  Index unit_multiplicity = 0;
  if (rigid && b.system.kernel().kernel.cols() > 0) {
    // The P-orthogonal complement of ker S is P^-1 range(S): the pencil restricted to it has no unit
    // eigenvalue.
    const KernelSplit& split = b.system.kernel();
    unit_multiplicity = split.kernel.cols();
    if (split.range.cols() == 0) return all_unit(b.rows(), "dense");
    const Eigen::LLT<Matrix> cholesky(p);
    if (cholesky.info() != Eigen::Success) return not_converged("dense");
    const Matrix y = cholesky.solve(split.range);
    ends = pencil_ends(y.transpose() * difference * y, y.transpose() * p * y);
  } else {
    ends = pencil_ends(difference, p);
  }
  if (!ends.definite) return not_converged("dense");
  SpectralRadius result;
  result.solver = "dense";
  set_ends(result, ends.smallest, ends.largest, unit_multiplicity, b.relaxation);
  result.residual = b.relaxation * ends.residual;
  result.converged = result.residual <= options.tolerance;
  return result;
}

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

SpectralRadius arpack_radius(const Contraction& b, const SpectralOptions& options) {
  const Index n = b.rows();
  const bool rigid = b.system.eta() == 0;
  if (rigid && n > rigid_kernel_limit)
    throw Error(fmt::format(
        "ARPACK in the rigid limit (epsilon = 0): expected at most {} interface unknowns, met {}; "
        "use a small epsilon > 0 instead",
        rigid_kernel_limit, n));
  SpectralRadius result;
  result.solver = "arpack";
  const auto p_apply = [&](const Vector& x) -> Vector {
    return ++result.applications, b.preconditioner.apply(x);
  };
  const auto p_solve = [&](const Vector& x) -> Vector {
    return ++result.applications, b.preconditioner.solve(x);
  };
  LinearMap s_apply = [&](const Vector& x) -> Vector { return ++result.applications, b.system.apply(x); };

  Index unit_multiplicity = 0;
  if (rigid) {
    // Deflation: S + sigma P Z (Z^T P Z)^-1 Z^T P moves ker S = span Z to sigma, a Rayleigh quotient of the
    // complement and hence between its ends.
    const KernelSplit& split = b.system.kernel();
    unit_multiplicity = split.kernel.cols();
    if (unit_multiplicity == n) return all_unit(n, "arpack");
    if (unit_multiplicity > 0) {
      const Vector inner = b.preconditioner.solve(split.range.rowwise().sum());  // in P^-1 range(S)
      const double sigma = inner.dot(b.system.apply(inner)) / inner.dot(b.preconditioner.apply(inner));
      Matrix pz(n, unit_multiplicity);
      for (Index j = 0; j < unit_multiplicity; ++j) pz.col(j) = b.preconditioner.apply(split.kernel.col(j));
      const Matrix gram = split.kernel.transpose() * pz;
      s_apply = [s = s_apply, pz, sigma, cholesky = Eigen::LLT<Matrix>(gram)](const Vector& x) -> Vector {
        return s(x) + sigma * (pz * cholesky.solve(pz.transpose() * x));
      };
    }
  }
  const LanczosResult high = lanczos(n, s_apply, p_apply, p_solve, SpectrumEnd::largest, options.arpack);
  // The low end crowds at 0 for small epsilon, where Lanczos on P^-1 S stalls; on S^-1 P it is the isolated
  // end.
  const auto s_solve = [&](const Vector& x) -> Vector { return ++result.applications, b.system.solve(x); };
  const LanczosResult low = rigid
                                ? lanczos(n, s_apply, p_apply, p_solve, SpectrumEnd::smallest, options.arpack)
                                : lanczos(n, p_apply, s_apply, s_solve, SpectrumEnd::largest, options.arpack);
  if (high.vector.size() == 0 || low.vector.size() == 0) {
    SpectralRadius failed = not_converged("arpack");
    failed.applications = result.applications;
    return failed;
  }
  const End high_end = rayleigh(high.vector, s_apply, b.preconditioner);
  const End low_end = rayleigh(low.vector, s_apply, b.preconditioner);
  set_ends(result, 1.0 - high_end.lambda, 1.0 - low_end.lambda, unit_multiplicity, b.relaxation);
  result.residual = b.relaxation * std::max(high_end.residual, low_end.residual);
  result.converged = high.converged && low.converged && result.residual <= options.tolerance;
  return result;
}

}  // namespace

SpectralRadius spectral_radius(const Contraction& b, const SpectralOptions& options) {
  const Index n = b.rows();
  if (n == 0) return {};
  const bool dense = options.solver == SpectralSolver::dense || n < arpack_smallest_size ||
                     (options.solver == SpectralSolver::automatic && n <= options.dense_limit);
  return dense ? dense_radius(b, options) : arpack_radius(b, options);
}

}  // namespace nscdd
