// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/two_stage.hpp"

#include "linalg/sparse_cholesky.hpp"
#include "linalg/threads.hpp"
#include "mechanics/gauss_seidel.hpp"
#include <nscdd/core/error.hpp>

#include <Eigen/QR>
#include <fmt/format.h>

#include <variant>

namespace nscdd {
namespace {

// Exact Stage 1 of one subdomain: (W + epsilon I)^-1, or in the rigid limit the pseudo-inverse of W. There
// the impulses of a hyperstatic network are not unique, but the velocities that they give are.
using ExactStageOne = std::variant<std::monostate, SparseCholesky, Eigen::CompleteOrthogonalDecomposition<Matrix>>;

ExactStageOne factorise(const ContactSystem& contacts, double epsilon) {
  if (contacts.h.cols() == 0) return {};
  SparseMatrix w = contacts.h.transpose() * contacts.response;  // W = H^T M^-1 H
  if (epsilon == 0) {
    Eigen::CompleteOrthogonalDecomposition<Matrix> decomposition;
    decomposition.setThreshold(1e-12);
    decomposition.compute(Matrix(w));
    return decomposition;
  }
  w.diagonal().array() += epsilon;
  return SparseCholesky(CholeskyAnalysis(w), w);
}

Vector solve(const ExactStageOne& stage, const Vector& right) {
  if (const auto* cholesky = std::get_if<SparseCholesky>(&stage)) return cholesky->solve(right);
  if (const auto* orthogonal = std::get_if<Eigen::CompleteOrthogonalDecomposition<Matrix>>(&stage))
    return orthogonal->solve(right);
  return Vector(0);
}

}  // namespace

class TwoStageIteration::Implementation {
 public:
  Decomposition parts;
  Law law;
  InterfaceOperator preconditioner;
  std::optional<Index> sweeps;
  double relaxation;
  std::vector<ContactSystem> contacts;
  std::vector<ExactStageOne> exact;

  // Stage 1 of subdomain e: updates its impulses and returns its velocities.
  Vector stage_one(std::size_t e, const Vector& impulse_on_grains, Vector& r) const {
    const Subdomain& subdomain = parts.subdomains[e];
    const Vector free_velocity = impulse_on_grains.cwiseQuotient(subdomain.inertia);  // M^-1 (F^d - A^T F)
    if (!sweeps) {
      if (r.size() > 0) r = solve(exact[e], -(subdomain.h.transpose() * free_velocity));
      return free_velocity + contacts[e].response * r;
    }
    Vector velocity = free_velocity + contacts[e].response * r;
    std::visit(
        [&](const auto& one) {
          for (Index sweep = 0; sweep < *sweeps; ++sweep) gauss_seidel_sweep(contacts[e], one, r, velocity);
        },
        law);
    return velocity;
  }
};

TwoStageIteration::TwoStageIteration(const Decomposition& stage_one, const Law& law, InterfaceOperator preconditioner,
                                     std::optional<Index> sweeps, double relaxation) {
  const OneBlasThread serial_blas;
  if (sweeps && *sweeps < 1) throw Error(fmt::format("Gauss-Seidel sweeps: expected an integer >= 1, met {}", *sweeps));
  auto prepared = std::make_shared<Implementation>(
      Implementation{stage_one, law, std::move(preconditioner), sweeps, relaxation, {}, {}});
  for (const Subdomain& subdomain : stage_one.subdomains) {
    prepared->contacts.push_back(prepare_contacts(subdomain.inertia, subdomain.h));
    if (!sweeps) prepared->exact.push_back(factorise(prepared->contacts.back(), flexibility(law)));
  }
  implementation_ = std::move(prepared);
}

bool TwoStageIteration::rigid() const { return flexibility(implementation_->law) == 0; }

Index TwoStageIteration::interface_size() const { return implementation_->parts.interface_size(); }

Index TwoStageIteration::contacts() const {
  Index all = 0;
  for (const Subdomain& subdomain : implementation_->parts.subdomains) all += subdomain.h.cols();
  return all;
}

TwoStageState TwoStageIteration::zero_state() const {
  TwoStageState state{Vector::Zero(interface_size()), {}};
  for (const Subdomain& subdomain : implementation_->parts.subdomains)
    state.impulses.push_back(Vector::Zero(subdomain.h.cols()));
  return state;
}

TwoStageState TwoStageIteration::iterate(TwoStageState state, const std::vector<Vector>* loads) const {
  const OneBlasThread serial_blas;
  const Interface& interface = implementation_->parts.interface;
  std::vector<Vector> velocities;
  for (std::size_t e = 0; e < state.impulses.size(); ++e) {
    // F^d - A^T F
    Vector on_grains = -interface.distribute(static_cast<Index>(e), state.interface_impulses);
    if (loads != nullptr) on_grains += (*loads)[e];
    velocities.push_back(implementation_->stage_one(e, on_grains, state.impulses[e]));
  }
  state.interface_impulses +=
      implementation_->relaxation * implementation_->preconditioner.solve(interface.exchange(velocities));
  return state;
}

std::vector<Vector> impact_loads(const Decomposition& parts, const Vector& arriving_velocity) {
  std::vector<Vector> loads;
  const Index d = parts.dofs_per_grain();
  for (const Subdomain& subdomain : parts.subdomains) {
    Vector load(subdomain.inertia.size());
    for (Index i = 0; i < count(subdomain.grains); ++i)
      load.segment(d * i, d) =
          subdomain.inertia.segment(d * i, d).cwiseProduct(arriving_velocity.segment(d * subdomain.grains[at(i)], d));
    loads.push_back(std::move(load));
  }
  return loads;
}

}  // namespace nscdd
