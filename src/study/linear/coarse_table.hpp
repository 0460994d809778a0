// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/factor_work.hpp"
#include "study/tables/coarse_parameters.hpp"
#include <nscdd/study/sweep.hpp>

namespace nscdd {

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

}  // namespace nscdd
