// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// What is known of the solutions of a contact problem.
enum class VerdictKind {
  exists,      ///< proved: there is a solution
  impossible,  ///< proved: there is none, unless impulses change a velocity by `proven_speed`
  undecided,   ///< neither is proved, as where friction jams
};
constexpr auto names_of(VerdictKind) { return std::to_array<std::string_view>({"exists", "impossible", "undecided"}); }

/// A verdict with its certificate. Relative velocities of a certificate v' are u = H^T v' + q, v' in m/s and rad/s, n
/// entries; or u = W y + q, y in N s, D c entries, where M and H are not known. Proofs are for the numbers as stored.
struct Verdict {
  VerdictKind kind = VerdictKind::undecided;
  /// The largest s found with u_n - mu |u_t| >= s at every contact, m/s; the search ends once s exceeds max |q_c|. If
  /// s > 0 and W is symmetric and positive semidefinite, as H^T M^-1 H is, a solution exists [V. Acary, F. Cadoux,
  /// C. Lemarechal, J. Malick, ZAMM 91 (2011) 155-175]. A lower bound, by outward rounding. Infinite without contacts.
  double margin = infinity;
  double speed = 0;   ///< |v'| of the certificate: (v'^T M v' / sum_c 1 / W_nn)^(1/2), or with y^T W y, m/s
  Vector velocities;  ///< v' or y with this margin
  /// The largest s found with u_n >= s at every contact, m/s, as `margin`. Below 0: the contacts penetrate at -s or
  /// more. Larger than `margin` where friction jams. NaN if a solution exists.
  double normal_margin = not_a_number;
  /// Contacts of a self-stress r >= 0, H_N r = 0, q_N^T r < 0, which no velocities with u_N >= 0 allow (Farkas); the
  /// fewest that were found, ascending; empty if there is none. Friction does not matter.
  std::vector<Index> chain;
  Vector stress;             ///< r of the chain; its largest entry is 1
  double closing_speed = 0;  ///< -q_N^T r, m/s: of two walls, one behind each end of a chain of grains
  /// Proved in outward-rounded arithmetic: u_N >= 0 takes an entry of v' above -q_N^T r / || H_N r ||_1. Without M and
  /// H an entry of y, times the mean of W_nn, m/s. It is infinite if H_N r = 0 exactly; normals are rounded.
  double proven_speed = 0;
  Index factorisations = 0;  ///< sparse matrices factorised
  double seconds = 0;        ///< wall time
};

/// The margin min_c (u_n - mu |u_t|) of velocities v', or y (see Verdict), rounded downwards, m/s. `friction`: mu.
double proven_margin(const LocalFrictionProblem& problem, const Vector& friction, const Vector& velocities);

/// Verdict::proven_speed of a self-stress, rounded downwards; 0 if its closing speed may be 0 or an entry is negative.
double proven_speed(const LocalFrictionProblem& problem, const std::vector<Index>& chain, const Vector& stress);

/// Whether a verdict proves that there is no solution. A solver that converged to a `driven_residual`
/// (FrictionState::driven_residual) below 1e-6 has found one: this refutes a proof for slow bodies.
bool proves_impossible(const Verdict& verdict, bool converged, double driven_residual);

/// Decides whether a contact problem has a solution: an interior point method looks for velocities with a margin and,
/// if it finds none, for a self-stress that the supports work against. Both are then proved without it, by
/// `proven_margin` > 0, and by `proven_speed` >= 10^6 max |q_c|. The problem must pass `check`. `monitor` is called
/// after every factorisation; if it stops the work, the verdict is that of what was found.
Verdict verdict_of(const LocalFrictionProblem& problem, const Monitor& monitor = {});

}  // namespace nscdd
