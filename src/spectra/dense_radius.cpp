// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/memory.hpp"
#include "linalg/pencil.hpp"
#include "linalg/sparse_entries.hpp"
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

// Orthonormal basis of the range of M_b^-1/2 N_E H_E over all subdomains, that of Y for every epsilon. `root`: of M_b.
Matrix range_of_resultants(const Decomposition& parts, const Vector& root) {
  Matrix projector = Matrix::Zero(root.size(), root.size());
  for (const Subdomain& one : parts.subdomains) {
    const SparseMatrix resultants = one.a * one.h;
    std::vector<Index> rows, columns;
    for_entries(resultants, [&](Index i, Index j, double) {
      rows.push_back(i);
      columns.push_back(j);
    });
    sort_unique(rows);
    sort_unique(columns);
    if (rows.empty()) continue;
    const Matrix scaled = root.cwiseInverse().asDiagonal() * Matrix(selected_columns(resultants, columns));
    const auto [values, vectors] = left_singular(scaled(rows, Eigen::all));
    const Index rank = (values.array() > 1e-10 * values.maxCoeff()).count();
    const Matrix range = vectors.rightCols(rank);
    projector(rows, rows) += range * range.transpose();
  }
  parts.interface.processes().add_up({projector.data(), at(projector.size())});
  const auto [values, vectors] = symmetric_eigen(projector);
  return vectors.rightCols((values.array() > 0.5).count());
}

// The scheme schwarz. With Y = I - M_b^1/2 F M_b^1/2 the symmetric -Y^1/2 G Y^1/2, G = 1 1^T - I per grain, has the
// eigenvalues mu of J, with the resultants Y^1/2 x in units of M_b^1/2. The largest mu are the 1 of the kernel.
PencilEnds schwarz_ends(const Contraction& b, Index kernel) {
  const Interface& interface = b.system.decomposition().interface;
  const Index n = b.rows();
  const Vector root = b.system.scale().cwiseSqrt().cwiseInverse();
  Matrix y = -(root.asDiagonal() * b.system.dense() * root.asDiagonal());
  y.diagonal().array() += 1;
  PencilEnds ends;
  const Matrix basis = range_of_resultants(b.system.decomposition(), root);
  if (basis.cols() == 0) {  // no contact acts on a shared grain: J = 0
    ends.low = ends.high = Vector::Zero(n);
    ends.low_vectors = ends.high_vectors = Matrix::Zero(n, n);
    ends.residual = 0;
    return ends;
  }
  const auto [squares, vectors] = symmetric_eigen(basis.transpose() * y * basis);
  const Matrix half = basis * (vectors * squares.cwiseMax(0).cwiseSqrt().asDiagonal());  // Y = half half^T
  Matrix others(n, half.cols());
  for (Index j = 0; j < half.cols(); ++j) others.col(j) = sum_of_others(interface, half.col(j));
  const Matrix map = -half.transpose() * others;
  const auto [values, pairs] = symmetric_eigen(0.5 * (map + map.transpose()));
  if (!values.allFinite()) return ends.failure = "LAPACK finds no eigenvalues", ends;
  const Index kept = half.cols() - kernel;
  if (kept < 0) return ends.failure = "the kernel of S is larger than the range of Y", ends;
  const Index below = std::min<Index>((values.array() < 0).count(), kept), above = kept - below;
  ends.low = Vector::Zero(n - kernel);  // the kernel of Y has mu = 0
  ends.low.head(below) = values.head(below);
  ends.low.tail(above) = values.segment(below, above);
  ends.low_vectors = Matrix::Zero(n, n - kernel);
  ends.low_vectors.leftCols(below) = half * pairs.leftCols(below);
  ends.low_vectors.rightCols(above) = half * pairs.middleCols(below, above);
  ends.high = ends.low.reverse();
  ends.high_vectors = ends.low_vectors.rowwise().reverse();
  // An error e of Y moves its root by e / (2 sqrt(y_min)).
  const double condition = squares.maxCoeff() / std::max(squares.minCoeff(), 1e-16);
  ends.residual = static_cast<double>(n) * 2.3e-16 * std::max(1.0, values.cwiseAbs().maxCoeff()) * std::sqrt(condition);
  return ends;
}

}  // namespace

SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options) {
  const Index n = b.rows();
  require_memory((b.system.flexibility() == 0 ? rigid_matrices_at_once : matrices_at_once) * bytes_of_matrix(n, n),
                 fmt::format("matrices of {} interface unknowns", n),
                 "fewer subdomains or grains, or the solver arpack");
  // Scaling both matrices by D^-1/2 from both sides, D = diag(X), keeps unequal masses from spoiling the condition.
  const Vector root = b.system.scale().cwiseSqrt().cwiseInverse();
  Matrix p, difference;
  if (!b.schwarz()) p = root.asDiagonal() * b.preconditioner.dense() * root.asDiagonal();
  if (options.checkpoint) options.checkpoint();
  // P B. The pencil (P B, P) has the eigenvalues mu themselves: small radii keep their digits.
  if (!b.schwarz()) difference = p - root.asDiagonal() * b.system.dense() * root.asDiagonal();
  const Index unit_multiplicity = b.system.nullity();
  const double tilt = b.system.uncertainty();
  if (unit_multiplicity == n) return all_unit(n, "dense", std::isfinite(tilt));
  const auto ends_of = [&](Index wanted) {
    if (options.checkpoint) options.checkpoint();
    if (b.schwarz()) return schwarz_ends(b, unit_multiplicity);
    return unit_multiplicity == 0 ? pencil_ends(difference, p, wanted)
                                  : deflated_ends(difference, p, b.system.kernel().kernel, wanted);
  };
  const Index most = n - unit_multiplicity, listed = std::min(options.eigenvalues, most);
  Index wanted = listed;
  PencilEnds ends = ends_of(wanted);
  const auto uncertain = [&] { return moved_by(tilt, 1 - ends.low[0], b); };
  const auto largest = [&] { return std::max({1.0, std::abs(ends.low[0]), std::abs(ends.high[0])}); };
  // Backward errors of LAPACK grow with the size, and those of X_0 with the spread of masses.
  const bool rigid = b.system.flexibility() == 0 && !b.schwarz();
  const double backward = static_cast<double>(n) * 2.3e-16, lost = lost_to_rounding(b);
  const double by_masses = rigid ? backward * std::sqrt(b.system.ratio_of_masses()) : 0;
  const auto margin = [&] {
    return std::max(ends.residual, backward * largest()) + (lost + by_masses) * (1 + largest()) + uncertain();
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
  // Where these or a small eta cost many digits of the assembled pencil, products that are not assembled show it.
  const auto off = [&](double mu, const Vector& mode) {
    const auto [lambda, bound] = rayleigh(
        mode, [&](const Vector& x) { return b.system.apply(x); }, b.preconditioner);
    const double error = std::abs(1 - mu - lambda) + bound;
    return std::isfinite(error) ? error : infinity;
  };
  constexpr double many = 100;
  if (rigid && (lost > many * options.tolerance || by_masses > options.tolerance))
    ends.residual = std::max({ends.residual, off(ends.low[0], result.mode_min), off(ends.high[0], result.mode_max)});
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
