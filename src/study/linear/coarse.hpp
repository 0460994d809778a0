// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/linear_iteration.hpp"
#include "linalg/pencil.hpp"
#include "study/tables/coarse_parameters.hpp"
#include <nscdd/study/sweep.hpp>

#include <Eigen/Cholesky>

namespace nscdd {

/// Entries of a sparse factor and the operations of its factorisation, by its symbolic analysis.
struct FactorWork {
  double entries = not_a_number, flops = not_a_number;
};

/// A row of `nscdd coarse`.
struct CoarseResult {
  CaseSummary of_case;
  double epsilon = 1, scale = 1;  ///< 1/kg; flexibility_scale of the case
  CoarseMethod method;
  Index primal_size = 0;                                        ///< n_P
  Index rank = 0;                                               ///< of X_0
  Index self_stresses = 0;                                      ///< that cross the interface: n_Gamma - rank X_0
  Index cross_points = 0;                                       ///< grains shared by three or more subdomains
  bool clear_ranks = true;                                      ///< see InterfaceOperator::nullity_is_clear
  double lambda_min = not_a_number, lambda_max = not_a_number;  ///< of P^-1 X_eps, with the coarse space
  bool certified = false;       ///< inertia counts prove the largest, and that none is smaller than the smallest
  double modes = not_a_number;  ///< independent vectors of the coarse space
  double threshold = not_a_number, bound = not_a_number;  ///< of GenEO: N_n / threshold bounds kappa
  /// Fewest GenEO vectors, in the order of lambda, for eigenvalues of at most 30 and 100; a lower bound of the vectors
  /// of any deflation of this preconditioner with these condition numbers (interlacing). NaN where not computed.
  std::array<double, 2> fewest{not_a_number, not_a_number}, any{not_a_number, not_a_number};
  double iterations = not_a_number;  ///< of conjugate gradients, to 1e-8, for jumps drawn at random
  double predicted = not_a_number;   ///< the same from the spectrum
  FactorWork local, interface, coarse, undivided;
  /// Of X, X_eta and bddc: of the preconditioner and of the iterations; not in tables. NaN where not measured.
  double setup_seconds = not_a_number, seconds = not_a_number;
  bool converged = true;

  double kappa() const { return lambda_max / lambda_min; }
};

/// The condition numbers of CoarseResult::fewest.
inline constexpr std::array<double, 2> wanted_kappas{30, 100};

ResultColumns<CoarseResult> coarse_columns(bool relative);

/// A word of a method, "none" where it lacks one.
std::string_view name_of(const auto& word) { return word ? to_string(*word) : "none"; }

/// Every method at every epsilon > 0 of the sweep, from row `first` on. Returns how many did not converge. Throws Error
/// for an interface of one subdomain, for epsilon = 0, and if ends proved to 1e-6 violate a proved bound (an error of
/// nscdd). Several ranks compute X, X_eta and bddc only, without factors of the undivided packing and of the interface.
Index coarse_spaces(const Model& model, const SweepParameters& sweep, const CoarseParameters& parameters,
                    const Sink<CoarseResult>& sink, const Monitor& monitor = {}, Index first = 0);

/// L^T P^-1 L with the eigenvalues of P^-1 S, S = L L^T; `solve`: L -> P^-1 L.
Matrix symmetric_product(const Matrix& s, const auto& solve) {
  const Matrix lower = Eigen::LLT<Matrix>(s).matrixL();
  const Matrix product = lower.triangularView<Eigen::Lower>().transpose() * solve(lower);
  return 0.5 * (product + product.transpose());
}

/// Conjugate gradients for jumps drawn at random, and the iterations that the eigenvalues of P^-1 S predict, if any.
void solve_interface(CoarseResult& result, const LinearMap& system, const LinearMap& inverse, Index size,
                     const Vector& eigenvalues);

/// Fills the row of X, or of X_eta of the contacts of `network`, without a condensed interface: the spectrum of either
/// is 1 minus that of the contraction.
void solve_stage_two(CoarseResult& result, const Decomposition& system, const Decomposition& network,
                     const SpectralOptions& options);

/// Fills the row of BDDC: (M + K / epsilon) V = b, b drawn at random. Throws Error if our matrices refute the solution.
void solve_bddc(CoarseResult& result, const Decomposition& parts, const CoarseParameters& parameters);

}  // namespace nscdd
