// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {

/// How a contact problem is solved.
enum class FrictionAlgorithm {
  automatic,     ///< sweeps, then `continuation` from their impulses
  continuation,  ///< of a smoothed contact law along a curve to the law itself, then Newton on the statuses
  newton,        ///< proximal semismooth Newton, from a few sweeps
  nlgs,          ///< nonlinear Gauss-Seidel
  admm,          ///< alternating directions: all couplings without the law, then the law without couplings
  accelerated,   ///< sweeps with momentum
};
constexpr auto names_of(FrictionAlgorithm) {
  return std::to_array<std::string_view>({"auto", "continuation", "newton", "nlgs", "admm", "accelerated"});
}

/// The order in which a sweep visits the contacts. Two contacts are coupled if their block of W is stored.
enum class SweepOrder {
  natural,      ///< as numbered
  reverse,      ///< from the last to the first
  symmetric,    ///< as numbered and back again, each counted as a sweep
  random,       ///< one permutation for all sweeps, from `seed`
  coloured,     ///< colour by colour: contacts of one colour are not coupled and are swept in threads
  interleaved,  ///< in blocks of 256 as numbered, each by colours: no contact waits for the one before it
};
constexpr auto names_of(SweepOrder) {
  return std::to_array<std::string_view>({"natural", "reverse", "symmetric", "random", "coloured", "interleaved"});
}

struct FrictionSolverOptions {
  Choice<FrictionAlgorithm> algorithm = FrictionAlgorithm::automatic;
  double tolerance = 1e-8;         ///< on FrictionState::residual
  Index maximum_sweeps = 100'000;  ///< and iterations of admm
  Index maximum_factorisations = 1000;
  double relaxation = 1;  ///< omega in r_c <- r_c + omega (r_c' - r_c), in (0, 2)
  Choice<SweepOrder> order = SweepOrder::natural;
  Index seed = 1;          ///< of order `random`, >= 0
  Index check_every = 10;  ///< sweeps between evaluations of the residual
  /// Number of checks: sweeps stall if for so many checks, and for as many as preceded the last progress, the smallest
  /// residual has not fallen by 1 % and the impulses have moved less than a quarter of the length of their path.
  Index patience = 1000;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit(
        "solver", self.algorithm,
        Field{.description = "auto, continuation, newton, nlgs, admm or accelerated; auto: sweeps, then continuation"});
    visit("tolerance", self.tolerance, Field{.description = "on the residual", .above = 0, .maximum = 1});
    visit("maximum_sweeps", self.maximum_sweeps,
          Field{.description = "sweeps over all contacts at most, or iterations of admm", .minimum = 0});
    visit("maximum_factorisations", self.maximum_factorisations,
          Field{.description = "of all solvers but nlgs and accelerated", .minimum = 0});
    visit("relaxation", self.relaxation,
          Field{.description = "omega in r <- r + omega (r' - r), between 0 and 2", .above = 0, .maximum = 2});
    visit("order", self.order, Field{.description = "of the contacts in a sweep"});
    visit("seed", self.seed, Field{.description = "of order random", .minimum = 0});
    visit("check_every", self.check_every, Field{.description = "sweeps from one residual to the next", .minimum = 1});
  }
};

/// How well impulses solve the problem, and the status of the contacts.
struct FrictionState {
  Vector velocities;  ///< u = W r + q, D c entries
  /// Natural map m_c of every contact with rho_c = 1 / W_nn of that contact, N s:
  ///     || m || / max(|| r^1 ||, min(|| r ||, 10^5 max(|| r^1 ||, p))),
  /// r^1_c the impulse of contact c if it were the only one, p_c = s_c / W_nn with the speeds s_c of the problem, or
  /// |q_c|. So neither impulses near zero nor impulses that grow without bound are the scale. It is
  /// max(|| r ||, || r^1 ||, p) where || m || <= 10^-14 max(|| r ||, p) is rounding. The residual is 0 if m = 0.
  double residual = 0;
  double scale = 0;            ///< that || m || was divided by, N s
  double driven_residual = 0;  ///< || m || / max(|| r^1 ||, p), which does not fall as impulses grow
  /// That of Siconos 4.4 (fc2d_compute_error, fc3d_compute_error with the norm of q): || m || with rho = 1 for every
  /// contact, divided by max(|| r ||, || u ||, || q ||) unless that is below 2.2e-16. (Older versions divide by
  /// || q ||.) It adds velocities and impulses, so its value depends on the units.
  double siconos_residual = 0;
  bool siconos_relative = true;          ///< whether it was divided
  Index open = 0, stick = 0, slide = 0;  ///< contacts by status; a contact without friction slides
  Index worst = -1;                      ///< the contact with the largest || m_c ||; -1 if all vanish
};

/// Evaluates impulses r. Sums in a fixed order: equal input gives equal bits. Throws Error unless r has D c entries.
FrictionState friction_state(const LocalFrictionProblem& problem, const Vector& impulses);

enum class FrictionStatus {
  converged,        ///< residual <= tolerance
  stalled,          ///< sweeps make no progress (`patience`), or no attempt of another solver succeeded
  maximum_reached,  ///< of sweeps or factorisations
  diverged,         ///< impulses grew to 10^12 times || r^1 || or the first ones
  not_finite,       ///< impulses or residual are not finite
  stopped,          ///< by the observer
};

constexpr auto names_of(FrictionStatus) {
  return std::to_array<std::string_view>(
      {"converged", "stalled", "maximum_reached", "diverged", "not_finite", "stopped"});
}

/// The step that led to impulses; NaN for a solver without such a step.
struct FrictionStep {
  double proximal_weight = not_a_number;  ///< alpha of Newton's steps, rho of admm, over W_nn of each contact
  double length = not_a_number;           ///< of Newton's step, at most 1; of a step along a curve, in log t
};

struct FrictionSolution {
  /// r, D c entries: those with the smallest || m ||; of `nlgs` those of the last sweep, of `accelerated` those of the
  /// last check if their residual is smaller.
  Vector impulses;
  FrictionState state;       ///< of these impulses
  FrictionStep step;         ///< the step that led to them
  Index status_changes = 0;  ///< contacts whose status differs from that at the check before
  Index sweeps = 0;          ///< Gauss-Seidel sweeps so far, or iterations of admm
  Index factorisations = 0;  ///< sparse matrices factorised so far
  /// Floating-point operations so far: 2 per entry of W for a sweep or a product with W, and those of sparse
  /// factorisations and solves as their library counts them. Not counted: checks, orderings, work per contact.
  double operations = 0;
  double seconds = 0;  ///< wall time of the solver without its checks; the one number that differs between equal runs
  /// False if the residual may be small only because impulses are large, as if there is no solution: || r || > E' and
  /// || m || > max(10^-3, tolerance) E, or || r || > 10^8 E'. E = max(|| r^1 ||, p) drives the problem; E' is the
  /// larger of E and || q || over the mean W_ii. True if || m || is rounding of the impulses of a guess. Ends no run.
  bool credible = false;
  FrictionStatus status = FrictionStatus::converged;
  std::vector<Index> unsettled;  ///< contacts whose status changed in the last 10 checks; only at the end of a run
};

/// The fewest contacts that hold `share` of the sum of squared natural maps (rho = 1 / W_nn), the largest first.
std::vector<Index> contacts_with_residual(const LocalFrictionProblem& problem, const FrictionSolution& solution,
                                          double share);

/// Called at every check, the one before the first sweep included. Returning false stops the solver.
using FrictionObserver = std::function<bool(const FrictionSolution&)>;

/// Solves a contact problem by one of the algorithms (see docs/algorithms.md). The problem must pass `check`.
/// `guess`: impulses to start from, D c entries, or empty for zero. If friction is large, a solution need not exist nor
/// be unique, and no algorithm need converge: see the status. Throws Error for bad guesses and options.
FrictionSolution solve_friction(const LocalFrictionProblem& problem, const FrictionSolverOptions& options = {},
                                const Vector& guess = {}, const FrictionObserver& observer = {});

}  // namespace nscdd
