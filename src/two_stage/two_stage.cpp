// SPDX-License-Identifier: GPL-3.0-or-later
#include "two_stage/two_stage.hpp"

#include "core/fail.hpp"
#include "core/memory.hpp"
#include "linalg/pencil.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/threads.hpp"
#include "spectra/spectrum_memory.hpp"

namespace nscdd {
namespace {

// Exact Stage 1 of one subdomain: (W + epsilon I)^-1, or in the rigid limit the pseudo-inverse (velocities are unique).
LinearMap exact_stage_one(const ContactSystem& contacts, double epsilon) {
  if (contacts.h.cols() == 0) return [](const Vector& right) { return right; };
  SparseMatrix w = contacts.h.transpose() * contacts.response;  // W = H^T M^-1 H
  if (epsilon == 0)
    return [inverse = minimum_norm_map(w, 1e-12)](const Vector& right) -> Vector { return inverse(right); };
  w.diagonal().array() += epsilon;
  return [cholesky = SparseCholesky(CholeskyAnalysis(w), w)](const Vector& right) -> Vector {
    return cholesky.solve(right);
  };
}

constexpr double unit_tolerance = 1e-9;

bool is_unit(std::complex<double> value) { return std::abs(value - 1.0) <= unit_tolerance; }

MapRadius map_radius_by_arpack(Index n, const LinearMap& map, const SpectralOptions& options, UnitEigenvalues units) {
  const bool pass_over = units == UnitEigenvalues::passed_over, counted = units == UnitEigenvalues::counted;
  const ArnoldiResult arpack = arnoldi(n, map, options.arpack, pass_over ? unit_tolerance : 0);
  // Eigenvalues that crowd at 1 (small epsilon) defeat Arnoldi; unit ones (rigid limit) hide those behind them.
  const bool doubtful = !arpack.converged || (counted && is_unit(arpack.value));
  MapRadius result;
  result.solver = "arpack";
  result.applications = arpack.applications;
  result.dominant = arpack.value;
  result.value = std::abs(arpack.value);
  result.residual = arpack.residual;
  result.subdominant = doubtful ? not_a_number : result.value;
  result.unit_multiplicity = pass_over ? arpack.units : counted ? -1 : 0;
  result.converged = arpack.converged && arpack.residual <= options.tolerance * std::max(1.0, result.value);
  if (!arpack.converged) result.failure = "Arnoldi has not converged";
  return result;
}

}  // namespace

TwoStageIteration::TwoStageIteration(const Decomposition& stage_one, const Law& law, InterfaceOperator preconditioner,
                                     std::optional<Index> sweeps, double relaxation, DecompositionScheme scheme)
    : parts_(stage_one),
      law_(law),
      preconditioner_(std::move(preconditioner)),
      sweeps_(sweeps),
      relaxation_(relaxation),
      scheme_(scheme) {
  const OneBlasThread serial_blas;
  if (sweeps && *sweeps < 1) fail("Gauss-Seidel sweeps: expected an integer >= 1, met {}", *sweeps);
  for (const Subdomain& subdomain : parts_.subdomains) {
    contacts_.emplace_back(subdomain.inertia, subdomain.h);
    if (!sweeps) exact_.push_back(exact_stage_one(contacts_.back(), flexibility(law)));
  }
}

Index TwoStageIteration::rows() const {
  Index rows = interface_size();
  for (const Subdomain& subdomain : parts_.subdomains) rows += subdomain.h.cols();
  return rows;
}

// Stage 1 of subdomain e: updates its impulses and returns its velocities. `on_grains`: F^d - A^T F.
Vector TwoStageIteration::stage_one(std::size_t e, const Vector& on_grains, Vector& r) const {
  const Subdomain& subdomain = parts_.subdomains[e];
  const Vector free_velocity = on_grains.cwiseQuotient(subdomain.inertia);
  if (!sweeps_) {
    r = exact_[e](-(subdomain.h.transpose() * free_velocity));
    return free_velocity + contacts_[e].response * r;
  }
  Vector velocity = free_velocity + contacts_[e].response * r;
  const auto sweep = [&](const auto& law) { gauss_seidel_sweep(contacts_[e], law, r, velocity); };
  for (Index k = 0; k < *sweeps_; ++k) std::visit(sweep, law_);
  return velocity;
}

Vector TwoStageIteration::iterate(Vector z, const std::vector<Vector>* loads) const {
  const OneBlasThread serial_blas;
  const Vector f =
      schwarz() ? Vector(-sum_of_others(parts_.interface, z.tail(interface_size()))) : z.tail(interface_size());
  std::vector<Vector> velocities;  // schwarz: resultants H_E r_E
  Index first = 0;
  for (std::size_t e = 0; e < parts_.subdomains.size(); ++e) {
    Vector on_grains = -parts_.interface.distribute(static_cast<Index>(e), f);
    if (loads != nullptr) on_grains += (*loads)[e];
    Vector r = z.segment(first, parts_.subdomains[e].h.cols());
    velocities.push_back(stage_one(e, on_grains, r));
    if (schwarz()) {
      r = z.segment(first, r.size()) + relaxation_ * (r - z.segment(first, r.size()));
      velocities.back() = parts_.subdomains[e].h * r;
    }
    z.segment(first, r.size()) = r;
    first += r.size();
  }
  if (schwarz())
    z.tail(f.size()) = parts_.interface.exchange(velocities);
  else
    z.tail(f.size()) += relaxation_ * preconditioner_.solve(parts_.interface.exchange(velocities));
  return z;
}

double TwoStageIteration::norm_of_impulses(const Vector& z) const {
  double sum = flexibility(law_) * z.head(rows() - interface_size()).squaredNorm();
  Index first = 0;
  for (const Subdomain& one : parts_.subdomains) {
    const Vector resultants = one.h * z.segment(first, one.h.cols());
    sum += resultants.cwiseProduct(resultants).cwiseQuotient(one.inertia).sum();
    first += one.h.cols();
  }
  return std::sqrt(sum);
}

MapRadius map_radius(const Matrix& map, const SpectralOptions& options, UnitEigenvalues units) {
  const OneBlasThread serial_blas;
  if (map.rows() == 0) return {};
  MapRadius result;
  result.solver = "dense";
  result.applications = map.cols();
  const GeneralEigen eigen = general_eigen(map);
  const Eigen::VectorXcd& values = eigen.values;
  if (values.size() == 0) {
    result.converged = false;
    result.value = result.subdominant = result.residual = not_a_number;
    result.failure = "LAPACK finds no eigenvalues";
    return result;
  }
  Index best = -1;
  for (Index k = 0; k < values.size(); ++k) {
    const bool unit = units != UnitEigenvalues::none && is_unit(values[k]);
    result.unit_multiplicity += unit;
    if (!unit) result.subdominant = std::max(result.subdominant, std::abs(values[k]));
    if (unit && units == UnitEigenvalues::passed_over) continue;
    if (best < 0 || std::abs(values[k]) > std::abs(values[best])) best = k;
  }
  if (best < 0) return result;  // the identity
  const Eigen::VectorXcd x = eigen.vector(best);
  result.dominant = {values[best].real(), std::abs(values[best].imag())};
  result.value = std::abs(values[best]);
  result.residual = (map * x - values[best] * x).norm() / x.norm();
  result.converged = result.residual <= options.tolerance * std::max(1.0, result.value);
  return result;
}

MapRadius map_radius(Index n, const LinearMap& given, const SpectralOptions& options, UnitEigenvalues units) {
  const OneBlasThread serial_blas;
  const LinearMap map = [&](const Vector& x) {
    if (options.checkpoint) options.checkpoint();
    return given(x);
  };
  const auto radius_by = [&](SpectralSolver solver) {
    if (solver == SpectralSolver::arpack) return map_radius_by_arpack(n, map, options, units);
    // Including its Hessenberg and Schur forms, their bases, and complex eigenvectors.
    require_memory(9 * bytes_of_matrix(n, n), fmt::format("a dense map of {} unknowns", n),
                   "fewer subdomains or grains, or the solver arpack");
    Matrix columns(n, n);
    for (Index j = 0; j < n; ++j) columns.col(j) = map(Vector::Unit(n, j));
    return map_radius(columns, options, units);
  };
  // ARPACK may meet unit eigenvalues that it does not count.
  const auto answers = [](const MapRadius& one) { return one.converged && !std::isnan(one.subdominant); };
  return first_answer(choose_inexact_solver(n, options), options.tolerance, radius_by, answers);
}

MapRadius inexact_radius(const TwoStageIteration& iteration, const SpectralOptions& options) {
  const LinearMap map = [&](const Vector& z) { return iteration.iterate(z); };
  return map_radius(iteration.rows(), map, options,
                    iteration.rigid() ? UnitEigenvalues::counted : UnitEigenvalues::none);
}

}  // namespace nscdd
