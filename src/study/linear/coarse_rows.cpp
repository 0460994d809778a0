// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/solver_run.hpp"
#include "core/fail.hpp"
#include "linalg/random.hpp"
#include "linalg/sparse_entries.hpp"
#include "study/linear/coarse.hpp"

namespace nscdd {
namespace {

using Preconditioner = InterfacePreconditioner;

constexpr double softer = 10;  // eta / epsilon of X_eta
constexpr Index most_predicted = 2500;
constexpr IterationLimits limits{1e-8, 5000};
constexpr double most_residual = 1e-6;  // of a solution of PETSc

void predict(CoarseResult& result, const Vector& eigenvalues) {
  if (eigenvalues.size() > 0 && eigenvalues.size() <= most_predicted)
    result.predicted = static_cast<double>(predicted_iterations(eigenvalues.cast<std::complex<double>>(), limits));
}

ResultColumns<FactorWork> work_columns(const std::string& name, const std::string& words) {
  return {{name + "_entries", "1", "entries of the factors of " + words, &FactorWork::entries},
          {name + "_flops", "1", "additions and multiplications of their factorisation", &FactorWork::flops}};
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
  const auto begun = Clock::now();
  const double eta = result.method.preconditioner == Preconditioner::inertia ? infinity : softer * result.epsilon;
  const InterfaceFamily family(network, InterfaceFamily::default_dense_limit, options.inertia);
  const Contraction b{family.at(eta), InterfaceFamily(system).at(result.epsilon)};
  b.preconditioner.solve(Vector::Zero(b.rows()));  // factorises
  result.setup_seconds = seconds_since(begun);
  const auto ready = Clock::now();
  solve_interface(
      result, [&](const Vector& f) { return b.system.apply(f); },
      [&](const Vector& g) { return b.preconditioner.solve(g); }, b.rows(), {});
  result.seconds = seconds_since(ready);
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
  k += diagonal_matrix(own.inertia);
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

ResultColumns<CoarseResult> coarse_columns(bool relative) {
  using R = CoarseResult;
  const auto columns = joined<R>(
      {columns_of(&R::of_case, case_columns()),
       {{"epsilon", "1/kg", "flexibility of the linear law", &R::epsilon},
        {"preconditioner", "", "X, X_eta or X_eta_active (eta = 10 epsilon), lumped, dirichlet, or none",
         [](const R& r) { return name_of(r.method.preconditioner); }},
        {"scaling", "", "weights of the copies of shared grains: multiplicity, stiffness, deluxe, or none",
         [](const R& r) { return name_of(r.method.scaling); }},
        {"coarse_space", "", "none, rigid or geneo", [](const R& r) { return r.method.space; }},
        {"primal_dofs", "1", "velocities of shared grains n_P", &R::primal_size},
        {"rank_x0", "1", "rank of X_0: interface unknowns that the rigid network leaves free to move", &R::rank},
        {"self_stresses", "1", "that cross the interface: n_Gamma - rank X_0", &R::self_stresses},
        {"cross_points", "1", "grains that three or more subdomains share", &R::cross_points},
        {"modes", "1", "independent vectors of the coarse space", &R::modes},
        {"kappa", "1", "condition number of P^-1 X_epsilon, with the coarse space", &R::kappa},
        {"eigenvalue_low", "1", "smallest eigenvalue of P^-1 X_epsilon", &R::lambda_min},
        {"eigenvalue_high", "1", "largest eigenvalue of P^-1 X_epsilon", &R::lambda_max},
        {"certified", "", "inertia counts prove the largest, and that none is below the smallest", &R::certified},
        {"threshold", "1", "GenEO takes vectors with an eigenvalue below this", &R::threshold},
        {"bound", "1", "bound of kappa that the threshold implies", &R::bound},
        {"modes_30", "1", "fewest vectors of GenEO for no eigenvalue above 30", [](const R& r) { return r.fewest[0]; }},
        {"modes_100", "1", "fewest vectors of GenEO for no eigenvalue above 100",
         [](const R& r) { return r.fewest[1]; }},
        {"any_30", "1", "no deflation by fewer vectors has kappa <= 30", [](const R& r) { return r.any[0]; }},
        {"any_100", "1", "no deflation by fewer vectors has kappa <= 100", [](const R& r) { return r.any[1]; }},
        {"iterations", "1", "of conjugate gradients to 1e-8, for random jumps", &R::iterations},
        {"predicted", "1", "the same from the spectrum; nan above 2 500 unknowns", &R::predicted}},
       columns_of(&R::local, work_columns("local", "M_E + K_E/epsilon")),
       columns_of(&R::interface, work_columns("interface", "the primal interface C")),
       columns_of(&R::coarse, work_columns("coarse", "the coarse problem U^T C U")),
       columns_of(&R::undivided, work_columns("undivided", "M + K/epsilon of the undivided packing")),
       {{"clear_ranks", "", "no singular value is near the tolerance of a rank", &R::clear_ranks},
        {"converged", "", "spectrum and conjugate gradients converged", &R::converged}}});
  const ResultColumns<R> in_multiples{
      {"mean_w_nn", "1/kg", "mean of W_nn over the contacts", &R::scale},
      {"epsilon_relative", "1", "epsilon in multiples of mean_w_nn", [](const R& r) { return r.epsilon / r.scale; }}};
  return relative ? joined<R>({columns, in_multiples}) : columns;
}

}  // namespace nscdd
