// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/memory.hpp"
#include "linalg/pencil.hpp"
#include "spectra/spectrum_memory.hpp"

#include <Eigen/Cholesky>

namespace nscdd {
namespace {

// P, S, scaled copy, difference, two of LAPACK; in the rigid limit also a kernel, a basis and the restricted pencil.
constexpr double matrices_at_once = 6, rigid_matrices_at_once = 10;

// The pencil (A, P) on the P-orthogonal complement of `kernel`. With P = L L^T and Q an orthonormal basis of the
// complement of L^T kernel, L^-T Q is a P-orthonormal basis of it.
PencilEnds deflated_ends(const Matrix& a, const Matrix& p, const Matrix& kernel, Index wanted) {
  PencilEnds ends;
  const Eigen::LLT<Matrix> cholesky(p);
  if (cholesky.info() != Eigen::Success) return ends.failure = "P is not positive definite in double precision", ends;
  const Matrix image = cholesky.matrixU() * kernel;
  const Matrix q = orthonormal_complement(image);
  const Matrix y = cholesky.matrixU().solve(q);
  const Matrix reduced = y.transpose() * a * y;
  ends = pencil_ends(0.5 * (reduced + reduced.transpose()), Matrix::Identity(q.cols(), q.cols()), wanted);
  if (!ends.failure.empty()) return ends;
  ends.low_vectors = y * ends.low_vectors;
  ends.high_vectors = y * ends.high_vectors;
  const Matrix lower = cholesky.matrixL();  // residual of the whole pencil
  ends.residual = std::max(pair_residual(a, p, lower, ends.low, ends.low_vectors),
                           pair_residual(a, p, lower, ends.high, ends.high_vectors));
  return ends;
}

}  // namespace

SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options) {
  const auto look = [&] {
    if (options.checkpoint) options.checkpoint();
  };
  const Index n = b.rows();
  require_memory((b.system.flexibility() == 0 ? rigid_matrices_at_once : matrices_at_once) * bytes_of_matrix(n, n),
                 fmt::format("matrices of {} interface unknowns", n),
                 "fewer subdomains or grains, or the solver arpack");
  // Scaling both matrices by D^-1/2 from both sides, D = diag(X), keeps unequal masses from spoiling the condition.
  const Vector root = b.system.scale().cwiseSqrt().cwiseInverse();
  const Matrix p = root.asDiagonal() * b.preconditioner.dense() * root.asDiagonal();
  look();
  // P B. The pencil (P B, P) has the eigenvalues mu themselves: small radii keep their digits.
  const Matrix difference = p - root.asDiagonal() * b.system.dense() * root.asDiagonal();
  const Index unit_multiplicity = b.system.nullity();
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
  const auto largest = [&] { return std::max({1.0, std::abs(ends.low[0]), std::abs(ends.high[0])}); };
  const auto margin = [&] {  // backward errors of LAPACK grow with the size and with the largest eigenvalue
    return std::max(ends.residual, static_cast<double>(n) * 2.3e-16 * largest()) +
           lost_to_rounding(b) * (1 + largest()) + uncertain();
  };
  if (options.certify && ends.failure.empty() &&
      uncertain() <= options.tolerance * largest())  // until the lists hold all copies of both ends
    while (ends.failure.empty() && wanted < most &&
           (ends.low[wanted - 1] - ends.low[0] <= margin() || ends.high[0] - ends.high[wanted - 1] <= margin()))
      ends = ends_of(wanted = std::min(2 * wanted, most));
  if (!ends.failure.empty()) return not_converged("dense", ends.failure);
  SpectralRadius result;
  result.solver = "dense";
  set_ends(result, ends.low[0], ends.high[0], unit_multiplicity);
  result.low.assign(ends.low.begin(), ends.low.begin() + listed);
  result.high.assign(ends.high.begin(), ends.high.begin() + listed);
  result.mode_min = root.asDiagonal() * ends.low_vectors.col(0);
  result.mode_max = root.asDiagonal() * ends.high_vectors.col(0);
  result.residual = ends.residual + uncertain();
  result.converged = accurate(result, options.tolerance);
  if (options.certify && result.converged) {  // neither Sturm counts nor the QR iteration miss an eigenvalue
    result.certified = true;
    result.interval_min = {ends.low[0] - margin(), ends.low[0] + margin()};
    result.interval_max = {ends.high[0] - margin(), ends.high[0] + margin()};
    const auto within = [&](const Vector& values) { return ((values.array() - values[0]).abs() <= margin()).count(); };
    result.within_min = within(ends.low);
    result.within_max = within(ends.high);
  }
  return result;
}

}  // namespace nscdd
