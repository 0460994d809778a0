// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/two_stage.hpp"

#include "core/fail.hpp"
#include "linalg/sparse_cholesky.hpp"
#include "linalg/threads.hpp"

#include <Eigen/QR>

namespace nscdd {
namespace {

// Exact Stage 1 of one subdomain: (W + epsilon I)^-1, or in the rigid limit the pseudo-inverse of W. There
// the impulses of a hyperstatic network are not unique, but the velocities that they give are.
LinearMap exact_stage_one(const ContactSystem& contacts, double epsilon) {
  if (contacts.h.cols() == 0) return [](const Vector& right) { return right; };
  SparseMatrix w = contacts.h.transpose() * contacts.response;  // W = H^T M^-1 H
  if (epsilon == 0) {
    Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
    decomposition.setThreshold(1e-12);
    decomposition.compute(Matrix(w));
    return [decomposition](const Vector& right) -> Vector { return decomposition.solve(right); };
  }
  w.diagonal().array() += epsilon;
  return [cholesky = SparseCholesky(CholeskyAnalysis(w), w)](const Vector& right) -> Vector {
    return cholesky.solve(right);
  };
}

}  // namespace

TwoStageIteration::TwoStageIteration(const Decomposition& stage_one, const Law& law, InterfaceOperator preconditioner,
                                     std::optional<Index> sweeps, double relaxation)
    : parts_(stage_one),
      law_(law),
      preconditioner_(std::move(preconditioner)),
      sweeps_(sweeps),
      relaxation_(relaxation) {
  const OneBlasThread serial_blas;
  if (sweeps && *sweeps < 1) fail("Gauss-Seidel sweeps: expected an integer >= 1, met {}", *sweeps);
  for (const Subdomain& subdomain : parts_.subdomains) {
    contacts_.push_back(prepare_contacts(subdomain.inertia, subdomain.h));
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
  const Vector f = z.tail(interface_size());
  std::vector<Vector> velocities;
  Index first = 0;
  for (std::size_t e = 0; e < parts_.subdomains.size(); ++e) {
    Vector on_grains = -parts_.interface.distribute(static_cast<Index>(e), f);
    if (loads != nullptr) on_grains += (*loads)[e];
    Vector r = z.segment(first, parts_.subdomains[e].h.cols());
    velocities.push_back(stage_one(e, on_grains, r));
    z.segment(first, r.size()) = r;
    first += r.size();
  }
  z.tail(f.size()) += relaxation_ * preconditioner_.solve(parts_.interface.exchange(velocities));
  return z;
}

MapRadius inexact_radius(const TwoStageIteration& iteration, const SpectralOptions& options) {
  const LinearMap map = [&](const Vector& z) { return iteration.iterate(z); };
  return map_radius(iteration.rows(), map, options,
                    iteration.rigid() ? UnitEigenvalues::counted : UnitEigenvalues::none);
}

}  // namespace nscdd
