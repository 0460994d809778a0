// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_problem.hpp"
#include "mechanics/contact_law.hpp"

#include <chrono>

namespace nscdd {

/// The impulse that would bring a contact to rest, the others held:  r_c - W_c^-1 u_c.
template <int D>
LocalVector<D> stopping(const FullDelassus<D>& w, LocalVector<D> impulse, LocalVector<D> u) {
  return impulse - w.solve(u);
}

/// The run of a contact solver: what it solves, from where, and what it has found so far. A contact solver is one file
/// in this folder, a function of a run in the plane (D = 2) and in space (D = 3), and one word in the list of
/// friction_solver.cpp.
template <int D>
class SolverRun {
 public:
  SolverRun(const ContactProblem<D>& problem, const FrictionSolverOptions& options, const Vector& guess,
            const FrictionObserver& observer);

  const ContactProblem<D>& problem;
  const FrictionSolverOptions& options;
  const double alone;    ///< || r^1 ||, the impulses of the contacts each alone, N s
  FrictionSolution now;  ///< what the solver works with: set by `judge`, apart from what is counted

  /// Evaluates impulses and shows them to the observer, with the step that led to them. Returns whether the run is
  /// over: converged, stopped by the observer, or without finite impulses.
  bool judge(const Vector& impulses, const FrictionStep& step = {});
  /// Whether impulses are finite and not beyond all measure, as a matrix next to singular makes them, or a problem
  /// without a solution.
  bool plausible(const Vector& impulses) const;
  /// Impulses that obey the law for the velocities that the present ones cause: P(r - rho (u + mu |u_t| n)).
  Vector projected() const;
  /// The impulses that converged or, if none did, those whose natural maps were the smallest, || m || in N s, with the
  /// status and the counts of the end.
  FrictionSolution best() const;
  /// Goes on from earlier impulses.
  void go_back(const FrictionSolution& earlier);
  double natural_maps() const;  ///< || m || of the present impulses, N s
  /// Contacts of this process whose status changed in the last 10 checks.
  std::vector<Index> unsettled() const;
  bool spent() const { return now.factorisations >= options.maximum_factorisations; }

 private:
  bool decide(const Vector& impulses, const FrictionStep& step);
  double largest_plausible() const;  // norm of impulses, N s
  bool plausible(double size) const;
  Index changes_of_status();  // since the last call

  const FrictionObserver& observer_;
  FrictionSolution best_;
  std::vector<ContactStatus> statuses_;  // at the last check
  std::vector<Index> changed_;           // the check at which each of them was new
  Index checks_ = 0;
  double momenta_ = 0, expected_ = 0, guessed_ = 0;  // N s: p, impulses that are to be expected, those of the guess
  double best_maps_ = infinity;                      // N s
  std::chrono::steady_clock::time_point resumed_ = std::chrono::steady_clock::now();  // the end of the last check
};

/// As solve_friction, whatever holds W. Several processes that share the problem call it together; the solution is that
/// of the contacts of this process, its counts of contacts and its residuals are those of all, and `worst` is the worst
/// contact of this process. Without `rows` apgd cannot be asked for.
template <int D>
FrictionSolution solve_contacts(const ContactProblem<D>& problem, const FrictionSolverOptions& options,
                                const Vector& guess, const FrictionObserver& observer);

/// Sweeps until the run is over or `most` more are done. Returns whether it is over. See nlgs.cpp.
template <int D>
bool sweep(SolverRun<D>& run, Index most);

/// What Newton's steps ask of a contact, u = W r + q + proximal (r - r_now). Open: r = 0. Stick: u = 0. Slide: u_n = 0
/// and the tangential law of a FrozenContact, of which `rho` is that of z (kg; of no meaning in the plane).
template <int D>
ContactRelation<D> relation_of(const FrozenContact<D>& frozen, double proximal, double rho);

/// Newton's steps on the statuses from the present impulses, a few. Returns whether the run is over. See newton.cpp.
template <int D>
bool finish_by_newton(SolverRun<D>& run, const Couplings<D>& w);

/// Follows the curve of a smoothed contact law from the present impulses (if they are next to none: equal ones), where
/// the smoothing is so many times their mean square. Returns whether the run is over. See continuation.cpp.
template <int D>
bool follow_curve(SolverRun<D>& run, const Couplings<D>& w, double relative_smoothing);

/// The solvers.
template <int D>
void nlgs(SolverRun<D>& run);
template <int D>
void continuation(SolverRun<D>& run);
template <int D>
void newton(SolverRun<D>& run);
template <int D>
void automatic(SolverRun<D>& run);
template <int D>
void admm(SolverRun<D>& run);
template <int D>
void apgd(SolverRun<D>& run);

}  // namespace nscdd
