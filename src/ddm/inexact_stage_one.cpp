// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/inexact_stage_one.hpp"

#include <nscdd/linalg/linear_operator.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

constexpr double unit_tolerance = 1e-9;

InexactRadius dense_radius(const InexactIteration& j, double tolerance) {
  InexactRadius result;
  result.solver = "dense";
  const Matrix matrix = dense(j);
  result.applications = matrix.cols();
  const Eigen::EigenSolver<Matrix> solver(matrix);
  if (solver.info() != Eigen::Success) {
    result.converged = false;
    result.value = result.subdominant = result.residual = not_a_number;
    return result;
  }
  Index best = 0;
  for (Index k = 0; k < matrix.cols(); ++k) {
    const std::complex<double> value = solver.eigenvalues()[k];
    const bool unit = j.iteration.rigid() && std::abs(value - 1.0) <= unit_tolerance;
    if (unit) ++result.unit_multiplicity;
    if (!unit) result.subdominant = std::max(result.subdominant, std::abs(value));
    if (std::abs(value) > std::abs(solver.eigenvalues()[best])) best = k;
  }
  const std::complex<double> value = solver.eigenvalues()[best];
  const Eigen::VectorXcd x = solver.eigenvectors().col(best);
  result.dominant = {value.real(), std::abs(value.imag())};
  result.value = std::abs(value);
  result.residual = (matrix * x - value * x).norm() / x.norm();
  result.converged = result.residual <= tolerance * std::max(1.0, result.value);
  return result;
}

}  // namespace

Vector InexactIteration::apply(const Vector& z) const {
  TwoStageState state = iteration.zero_state();
  Index offset = 0;
  for (Vector& r : state.impulses) {
    r = z.segment(offset, r.size());
    offset += r.size();
  }
  state.interface_impulses = z.tail(iteration.interface_size());
  state = iteration.iterate(std::move(state));
  Vector image(z.size());
  offset = 0;
  for (const Vector& r : state.impulses) {
    image.segment(offset, r.size()) = r;
    offset += r.size();
  }
  image.tail(iteration.interface_size()) = state.interface_impulses;
  return image;
}

InexactRadius inexact_radius(const InexactIteration& j, const SpectralOptions& options) {
  const Index n = j.rows();
  if (j.iteration.interface_size() == 0 && n == 0) return {};
  const SolverChoice choice = choose_inexact_solver(n, options);
  if (choice.solver == SpectralSolver::dense) return dense_radius(j, options.tolerance);
  const ArnoldiResult arpack = arnoldi(n, linear_map(j), options.arpack);
  // Eigenvalues that crowd at 1 (small epsilon) defeat Arnoldi; unit ones (rigid limit) hide those behind
  // them.
  const bool doubtful =
      !arpack.converged || (j.iteration.rigid() && std::abs(arpack.value - 1.0) <= unit_tolerance);
  if (doubtful && choice.dense_fallback) return dense_radius(j, options.tolerance);
  InexactRadius result;
  result.solver = "arpack";
  result.applications = arpack.applications;
  result.dominant = arpack.value;
  result.value = std::abs(arpack.value);
  result.residual = arpack.residual;
  result.subdominant = doubtful ? not_a_number : result.value;
  result.unit_multiplicity = j.iteration.rigid() ? -1 : 0;
  result.converged = arpack.converged && arpack.residual <= options.tolerance * std::max(1.0, result.value);
  return result;
}

}  // namespace nscdd
