// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/linear/coarse_table.hpp"

namespace nscdd {
namespace {

ResultColumns<FactorWork> work_columns(const std::string& name, const std::string& words) {
  return {{name + "_entries", "1", "entries of the factors of " + words, &FactorWork::entries},
          {name + "_flops", "1", "additions and multiplications of their factorisation", &FactorWork::flops}};
}

}  // namespace

ResultColumns<CoarseResult> coarse_columns(bool relative) {
  using R = CoarseResult;
  static const auto columns = joined<R>(
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
  static const ResultColumns<R> in_multiples{
      {"mean_w_nn", "1/kg", "mean of W_nn over the contacts", &R::scale},
      {"epsilon_relative", "1", "epsilon in multiples of mean_w_nn", [](const R& r) { return r.epsilon / r.scale; }}};
  return relative ? joined<R>({columns, in_multiples}) : columns;
}

}  // namespace nscdd
