// SPDX-License-Identifier: GPL-3.0-or-later
#include <nscdd/ddm/spectral_radius.hpp>
#include <nscdd/linalg/pencil.hpp>

#include <Eigen/Cholesky>
#include <Eigen/QR>

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

bool accurate(const SpectralRadius& radius, double tolerance) {
  return radius.residual <= tolerance * std::max(1.0, radius.value);
}

SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options) {
  // Both matrices scaled by D^-1/2, D = diag(X): the pencil keeps its eigenvalues, and unequal masses lose
  // their hold.
  const Vector root = b.system.scale().cwiseSqrt().cwiseInverse();
  const Matrix p = root.asDiagonal() * b.preconditioner.dense() * root.asDiagonal();
  // P B: solved for mu directly, so that small radii keep their digits
  const Matrix difference = p - root.asDiagonal() * b.system.dense() * root.asDiagonal();
  const Index n = b.rows(), unit_multiplicity = b.system.nullity();
  if (unit_multiplicity == n) return all_unit(n, "dense");
  PencilEnds ends;
  if (unit_multiplicity == 0) {
    ends = pencil_ends(difference, p);
    if (!ends.definite) return not_converged("dense");
  } else {
    // With P = L L^T and Q an orthonormal basis of the complement of L^T ker S, the columns of L^-T Q are
    // P-orthonormal and P-orthogonal to ker S: the pencil restricted to them has no unit eigenvalue.
    const Eigen::LLT<Matrix> cholesky(p);
    if (cholesky.info() != Eigen::Success) return not_converged("dense");
    const Matrix image = cholesky.matrixU() * b.system.kernel().kernel;
    const Matrix q =
        Matrix(Eigen::HouseholderQR<Matrix>(image).householderQ()).rightCols(n - unit_multiplicity);
    const Matrix y = cholesky.matrixU().solve(q);
    const Matrix reduced = y.transpose() * difference * y;
    ends = pencil_ends(0.5 * (reduced + reduced.transpose()), Matrix::Identity(q.cols(), q.cols()));
    const Matrix x = y * ends.vectors;  // the residual is that of the whole pencil
    Matrix r = difference * x;
    r.col(0) -= ends.smallest * (p * x.col(0));
    r.col(1) -= ends.largest * (p * x.col(1));
    r = cholesky.matrixL().solve(r).eval();
    ends.residual = std::max(r.col(0).norm(), r.col(1).norm());
  }
  SpectralRadius result;
  result.solver = "dense";
  set_ends(result, ends.smallest, ends.largest, unit_multiplicity, b.relaxation);
  result.residual = b.relaxation * ends.residual;
  result.converged = accurate(result, options.tolerance);
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
  const Index unit_multiplicity = b.system.nullity();
  if (unit_multiplicity > 0 && n > rigid_kernel_limit) {  // the kernel is found densely
    SpectralRadius failed = not_converged("arpack");
    failed.unit_multiplicity = unit_multiplicity;
    return failed;
  }
  SpectralRadius result;
  result.solver = "arpack";
  const auto p_apply = [&](const Vector& x) -> Vector {
    return ++result.applications, b.preconditioner.apply(x);
  };
  const auto p_solve = [&](const Vector& x) -> Vector {
    return ++result.applications, b.preconditioner.solve(x);
  };
  LinearMap s_apply = [&](const Vector& x) -> Vector { return ++result.applications, b.system.apply(x); };

  if (unit_multiplicity == n) return all_unit(n, "arpack");
  if (unit_multiplicity > 0) {
    // Deflation: S + sigma P Z (Z^T P Z)^-1 Z^T P moves ker S = span Z to sigma, a Rayleigh quotient of the
    // complement and hence between its ends.
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
  result.converged = high.converged && low.converged && accurate(result, options.tolerance);
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
