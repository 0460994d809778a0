// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/coarse_rows.hpp"

#include "core/fail.hpp"
#include "linalg/random.hpp"

#include <chrono>

namespace nscdd {
namespace {

using Preconditioner = InterfacePreconditioner;

constexpr double softer = 10;  // eta / epsilon of X_eta
constexpr Index most_predicted = 2500;
constexpr IterationLimits limits{1e-8, 5000};
constexpr double most_residual = 1e-6;  // of a solution of PETSc

double clock_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void predict(CoarseResult& result, const Vector& eigenvalues) {
  if (eigenvalues.size() > 0 && eigenvalues.size() <= most_predicted)
    result.predicted = static_cast<double>(predicted_iterations(eigenvalues.cast<std::complex<double>>(), limits));
}

}  // namespace

void solve_interface(CoarseResult& result, const LinearMap& system, const LinearMap& inverse, Index size,
                     const Vector& eigenvalues) {
  const IteratedSolution found = conjugate_gradients(system, inverse, RandomStream(1).normal_vector(size), limits);
  result.iterations = static_cast<double>(found.iterations);
  result.converged &= found.converged;
  predict(result, eigenvalues);
}

void solve_stage_two(CoarseResult& result, const Decomposition& system, const Decomposition& network,
                     const SpectralOptions& options) {
  const double begun = clock_seconds();
  const double eta = result.method.preconditioner == Preconditioner::inertia ? infinity : softer * result.epsilon;
  const InterfaceFamily family(network, InterfaceFamily::default_dense_limit, options.inertia);
  const Contraction b{family.at(eta), InterfaceFamily(system).at(result.epsilon)};
  b.preconditioner.solve(Vector::Zero(b.rows()));  // factorises
  const double ready = clock_seconds();
  solve_interface(
      result, [&](const Vector& f) { return b.system.apply(f); },
      [&](const Vector& g) { return b.preconditioner.solve(g); }, b.rows(), {});
  result.setup_seconds = ready - begun;
  result.seconds = clock_seconds() - ready;
  SpectralOptions certified = options;
  certified.certify = true;
  const SpectralRadius radius = spectral_radius(b, certified);
  result.lambda_min = 1 - radius.eigenvalue_max;
  result.lambda_max = 1 - radius.eigenvalue_min;
  result.certified = radius.certified;
  result.converged &= radius.converged;
  if (system.interface.processes().alone() && b.rows() <= most_predicted)
    predict(result, symmetric_values(symmetric_product(b.system.dense(), [&](const Matrix& lower) -> Matrix {
              return Eigen::LLT<Matrix>(b.preconditioner.dense()).solve(lower);
            })));
}

void solve_bddc(CoarseResult& result, const Decomposition& parts, const CoarseParameters& parameters) {
  const bool adaptive = result.method.space == CoarseSpace::geneo;
  if (adaptive) result.threshold = parameters.threshold.value_or(parameters.kappa.value_or(30));
  const Subdomain& own = parts.subdomains[at(own_subdomain(parts))];
  SparseMatrix k = own.h * SparseMatrix(own.h.transpose()) / result.epsilon;
  k += SparseMatrix(own.inertia.asDiagonal());
  const BddcSystem system =
      parameters.bddc(parts, k, {*result.method.scaling, adaptive ? std::optional(result.threshold) : std::nullopt});
  const Vector right = RandomStream(1).normal_vector(system.size);
  Vector share = right(system.unknowns);
  for (Index row = 0; row < share.size(); ++row)
    share[row] /= static_cast<double>(parts.interface.multiplicity(own.grains[at(row / parts.dofs_per_grain())]));
  const BddcSolution found = system.solve(share);
  result.interface = result.coarse = {not_a_number, not_a_number};
  result.modes = static_cast<double>(system.coarse_size);
  result.lambda_min = found.lambda_min;
  result.lambda_max = found.lambda_max;
  result.iterations = static_cast<double>(found.iterations);
  result.setup_seconds = system.setup_seconds;
  result.seconds = found.seconds;
  result.converged = found.converged;
  Vector rest = Vector::Zero(system.size);
  rest(system.unknowns) = share - k * found.velocities;
  parts.interface.processes().add_up({rest.data(), at(rest.size())});
  const double residual = rest.norm() / right.norm();
  if (found.converged && !(residual < most_residual))
    fail("{}: bddc: expected a residual of at most {} by nscdd's matrices, met {}", result.of_case.name, most_residual,
         residual);
}

}  // namespace nscdd
