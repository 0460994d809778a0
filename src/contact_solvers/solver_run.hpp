// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_problem.hpp"
#include "mechanics/gauss_seidel.hpp"

#include <chrono>

namespace nscdd {

using Clock = std::chrono::steady_clock;
inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The run of a contact solver: its start, and what it has found so far. A contact solver is one file in this folder
/// with a function of a ContactProblem and a run, and a word in solve_contacts.hpp. Arguments outlive the run.
template <int D>
class SolverRun {
 public:
  template <ContactProblem P>
  SolverRun(const P& problem, const FrictionSolverOptions& chosen, const Vector& guess,
            const FrictionObserver& observer)
      : SolverRun(
            problem.data, [&problem](const Vector& r) { return problem.product(r); }, chosen, guess, observer) {}

  const ContactData& data;
  const FrictionSolverOptions& options;
  FrictionSolution now;  ///< the present impulses, set by `judge`; solvers add to its counts

  /// Evaluates impulses and calls the observer, with the step that led to them. Returns whether the run is over:
  /// converged, stopped by the observer, or without finite impulses.
  bool judge(const Vector& impulses, const FrictionStep& step = {});
  /// Whether impulses are bounded: a nearly singular matrix, or a problem without a solution, produces huge ones.
  bool plausible(const Vector& impulses) const { return data.sums.norm(impulses) <= largest_plausible(); }
  /// Impulses that obey the law at the velocities of the present ones: P(r - rho (u + mu |u_t| n)).
  Vector projected() const;
  /// The impulses that converged or, if none did, those with the smallest || m ||, with the present status and counts.
  FrictionSolution best() const;
  /// Goes back to the impulses of `earlier`; counts stay.
  void go_back(const FrictionSolution& earlier) {
    now.impulses = earlier.impulses;
    now.state = earlier.state;
  }
  void keep_better(const FrictionSolution& found);  ///< takes it for the best if its || m || is smaller
  void begin_again();  ///< from zero impulses, as if without a guess and without a best so far; counts stay
  std::vector<Index> unsettled() const;  ///< contacts of this rank whose status changed in the last 10 checks
  /// Evaluates impulses of norm `size` with u = W r + q. Above the norm `believed`, natural maps are at least rounding.
  static FrictionState state_of(const ContactData& data, const Vector& impulses, Vector velocities, double size,
                                double believed);
  bool keeps_half = false;  ///< of the factorisations, for another beginning, while the best impulses are credible
  bool spent() const {
    const Index most = options.maximum_factorisations;
    return now.factorisations >= (keeps_half && best_.credible ? most - most / 2 : most);
  }

 private:
  using Product = std::function<Vector(const Vector& r)>;  // W r
  SolverRun(const ContactData& given, Product product, const FrictionSolverOptions& chosen, const Vector& guess,
            const FrictionObserver& observer);
  bool decide(const Vector& impulses, const FrictionStep& step);
  double largest_plausible() const;  // norm of impulses, N s
  Index changes_of_status();         // since the last call

  const Product product_;
  const FrictionObserver& observer_;
  FrictionSolution best_;
  std::vector<ContactStatus> statuses_;  // at the last check
  std::vector<Index> changed_;           // the check at which each of them was new
  Index checks_ = 0;
  double expected_ = 0, guessed_ = 0;         // norms of impulses to be expected, and of the guess, N s
  double best_maps_ = infinity;               // || m || of the best, N s
  Clock::time_point resumed_ = Clock::now();  // the end of the last check
};

/// Decides from the impulses whether iterations still make progress. While a soft mode drifts the residual may stagnate
/// for long, but the path of the impulses is straight. If statuses cycle, or only rounding is left, the path returns.
template <int D>
class StallWatch {
 public:
  explicit StallWatch(const SolverRun<D>& run, std::optional<Index> patience = {})  ///< in checks
      : sums_(run.data.sums),
        scale_(std::max(run.data.alone, sums_.norm(run.now.impulses))),
        watch_({.tolerance = -1,  // SolverRun::judge decides what has converged
                .growth = growth_allowed,
                .fall = progress_wanted,
                .patience = patience.value_or(run.options.patience),
                .longer = 1},
               FrictionStatus::not_finite),
        first_(run.now.impulses),
        last_(first_) {}

  /// To be called after every SolverRun::judge that ends nothing. Returns whether the run is over, and sets its status.
  bool ends(SolverRun<D>& run) {
    const Vector& impulses = run.now.impulses;
    length_ += sums_.norm(impulses - last_);
    last_ = impulses;
    const auto over = watch_.judge(check_, run.now.state.residual, sums_.norm(impulses), scale_);
    if (over == FrictionStatus::stalled && leads_on()) {
      watch_.take_for_progress(check_);
    } else if (over) {
      run.now.status = *over;
      return true;
    }
    if (watch_.last_progress() == check_++) {
      first_ = impulses;
      length_ = 0;
    }
    return false;
  }

 private:
  static constexpr double progress_wanted = 0.99;  // of the smallest residual, within `patience` checks
  static constexpr double growth_allowed = 1e12;
  static constexpr double straight = 0.25;         // distance of the ends of a path over its length
  static constexpr double above_rounding = 1e-12;  // the same distance over the impulses

  bool leads_on() const {
    const double gone = sums_.norm(last_ - first_);
    return gone > straight * length_ && gone > above_rounding * sums_.norm(last_);
  }

  const ContactSums& sums_;
  double scale_;
  ProgressWatch<FrictionStatus> watch_;
  Index check_ = 0;
  Vector first_, last_;  // impulses at the last progress and now
  double length_ = 0;    // of the path between
};

/// As solve_friction, for any ContactProblem; all ranks call it together. Vectors and the `worst` contact are those of
/// this rank, counts of contacts and residuals those of all. Sources of classes of problems instantiate it.
template <ContactProblem P>
FrictionSolution solve_contacts(P& problem, const FrictionSolverOptions& options, const Vector& guess,
                                const FrictionObserver& observer);

}  // namespace nscdd
