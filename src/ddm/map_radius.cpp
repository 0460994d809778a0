// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/map_radius.hpp"

#include "linalg/threads.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

constexpr double unit_tolerance = 1e-9;

bool is_unit(std::complex<double> value) { return std::abs(value - 1.0) <= unit_tolerance; }

}  // namespace

MapRadius map_radius(const Matrix& map, const SpectralOptions& options, UnitEigenvalues units) {
  const OneBlasThread serial_blas;
  if (map.rows() == 0) return {};
  MapRadius result;
  result.solver = "dense";
  result.applications = map.cols();
  const Eigen::EigenSolver<Matrix> solver(map);
  if (solver.info() != Eigen::Success) {
    result.converged = false;
    result.value = result.subdominant = result.residual = not_a_number;
    return result;
  }
  const Eigen::VectorXcd& values = solver.eigenvalues();
  Index best = -1;
  for (Index k = 0; k < values.size(); ++k) {
    const bool unit = units != UnitEigenvalues::none && is_unit(values[k]);
    result.unit_multiplicity += unit;
    if (!unit) result.subdominant = std::max(result.subdominant, std::abs(values[k]));
    if (unit && units == UnitEigenvalues::passed_over) continue;
    if (best < 0 || std::abs(values[k]) > std::abs(values[best])) best = k;
  }
  if (best < 0) return result;  // the identity
  const Eigen::VectorXcd x = solver.eigenvectors().col(best);
  result.dominant = {values[best].real(), std::abs(values[best].imag())};
  result.value = std::abs(values[best]);
  result.residual = (map * x - values[best] * x).norm() / x.norm();
  result.converged = result.residual <= options.tolerance * std::max(1.0, result.value);
  return result;
}

MapRadius map_radius(Index n, const LinearMap& map, const SpectralOptions& options, UnitEigenvalues units) {
  const OneBlasThread serial_blas;
  const SolverChoice choice = choose_inexact_solver(n, options);
  if (choice.solver == SpectralSolver::arpack) {
    const bool pass_over = units == UnitEigenvalues::passed_over, counted = units == UnitEigenvalues::counted;
    const ArnoldiResult arpack = arnoldi(n, map, options.arpack, pass_over ? unit_tolerance : 0);
    // Eigenvalues that crowd at 1 (small epsilon) defeat Arnoldi; unit ones (rigid limit) hide those behind them.
    const bool doubtful = !arpack.converged || (counted && is_unit(arpack.value));
    if (!doubtful || !choice.dense_fallback || pass_over) {
      MapRadius result;
      result.solver = "arpack";
      result.applications = arpack.applications;
      result.dominant = arpack.value;
      result.value = std::abs(arpack.value);
      result.residual = arpack.residual;
      result.subdominant = doubtful ? not_a_number : result.value;
      result.unit_multiplicity = pass_over ? arpack.units : counted ? -1 : 0;
      result.converged = arpack.converged && arpack.residual <= options.tolerance * std::max(1.0, result.value);
      return result;
    }
  }
  Matrix columns(n, n);
  for (Index j = 0; j < n; ++j) columns.col(j) = map(Vector::Unit(n, j));
  return map_radius(columns, options, units);
}

}  // namespace nscdd
