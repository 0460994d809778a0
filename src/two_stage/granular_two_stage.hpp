// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "two_stage/model_switch.hpp"

namespace nscdd {

/// Indicators of one iteration, [ADI12] eqs. (39), (40). |r| and |F| count as at least 1e-12 times the momenta of the
/// bodies that meet (ImpulseScale): if contacts exchange less, nothing is left to converge.
struct IterationRecord {
  Index iteration = 0, sweeps = 0;  ///< from 1; sweeps per subdomain so far
  double zeta = 0;                  ///< |r_i - r_{i-1}| / |r_i| over all contacts
  double interface_change = 0;      ///< Z = |F_i - F_{i-1}| / |F_i|; 0 without an interface
  /// |F_i - 2 F_{i-1} + F_{i-2}| / |F_i|. If self-stresses drift at a constant rate, Z stagnates, but this falls.
  double interface_second_change = 0;
  double gluing = 0;    ///< |sum A_E V_E| / max(|V_free|, |V|) over the copies of shared grains, after Stage 1
  double impulses = 0;  ///< |r_i|^2, (N s)^2
  /// sum |r_n,i - r_n,i-1| / sum |r_n,i| over all contacts, of the program of [ADI12]; NaN where it is not measured.
  double normal_change = not_a_number;
};

/// The residual of all subdomains from that of each, summed in their order; those of other ranks are empty.
ContactResidual added_up(const std::vector<ContactResidual>& of_subdomains, const Processes& processes);

/// Algorithm 1 of [ADI12] on the contact problem of one step; without an interface nonlinear Gauss-Seidel, bit by bit.
///   Stage 1  n_GS sweeps in every subdomain, in threads, F_Gamma frozen
///   Stage 2  F <- F + omega P^-1 sum_E A_E V_E,  V_E <- V_E - M_E^-1 A_E^T (change of F)
/// with P = X, solved in closed form grain by grain (generic), or P = X_eta (enriched). This is the paper's (16) for
/// any law, see TwoStageIteration. With conjugate gradients a trial Stage 1 follows: `sweeps` has both, zeta the trial.
///
/// No bit depends on the number of threads. Construction, iterations and sums are collective on ranks that share the
/// subdomains. In the generic Stage 2 neighbours exchange jumps, and no bit depends on the number of ranks. In the
/// enriched one all ranks do, and the rounding of the shared factor depends on their number.
template <int D>
class GranularTwoStage {
 public:
  /// `enriched`: X_eta of the same gluing, or nothing for the generic algorithm. Throws Error for another gluing.
  GranularTwoStage(GranularDecomposition<D> parts, const ContactLaw& law, const StepSolver& solver,
                   std::optional<InterfaceOperator> enriched);

  /// Sets V_E = M_E^-1 (F^d_E + H_E r_E - A_E^T F) for impulses r and gluing of the last step. A grain that other
  /// subdomains share now starts at F = 0.
  void start(const std::vector<RememberedGluing>& gluing);

  /// The state z = (r, F_Gamma) from which the algorithm continues: D impulses of each contact in the order of the step
  /// problem, then n_Gamma numbers. `restart` sets the velocities, too. Requires a single rank.
  Vector state() const;
  void restart(const Vector& z);

  /// Lets subdomains become linear once their statuses stand still, see ModelSwitch; call after `start`. `state`: the
  /// grains before the step and, for a warm start, the models of the last step. `scale`: W, 1/kg.
  void switch_models(const GranularSystem& system, const GranularState& state, double scale);

  void iterate();

  /// Record of the last iteration. Iterations need no such global sum: asking less often saves waiting.
  IterationRecord record() const;

  /// Keeps the impulses for normal_change, that of IterationRecord if one iteration lies between; collective.
  void remember_impulses() {
    remembered_.resize(parts_.subdomains.size());
    for (std::size_t e = 0; e < remembered_.size(); ++e) remembered_[e] = parts_.subdomains[e].contacts.impulses;
  }
  double normal_change() const;

  ContactResidual residual() const;

  /// Updates of single contacts in all sweeps so far, on this rank.
  Index contact_updates() const { return sweeps_ * parts_.contacts; }

  /// Status of every contact, in the order of the step problem.
  std::vector<ContactStatus> statuses() const;

  /// Contacts with their impulses, and velocities of bodies: of a shared grain the mean of its copies.
  struct Solution {
    std::vector<GrainContact<D>> contacts;
    std::vector<GrainVelocity<D>> velocities;
  };
  /// Gathers the results of the subdomains; collective. All ranks then know gluing and F_Gamma.
  Solution gather(const StepProblem<D>& problem);

  std::vector<RememberedGluing> gluing() const;
  std::vector<RememberedModel> models() const;  ///< one per subdomain; empty unless models are switched

  const Vector& interface_impulses() const { return interface_impulses_; }  ///< F_Gamma, n_Gamma
  const GranularDecomposition<D>& parts() const { return parts_; }

 private:
  // Sums of squares over the subdomains for a record.
  enum Quantity { changes, impulses, jumps, speeds, interface_changes, second_changes, interface_squares, quantities };
  // The sum of term(e) over the subdomains in their order: no bit depends on the ranks.
  double summed(const auto& term) const {
    Eigen::MatrixXd terms(1, count(parts_.subdomains));
    for (Index e = 0; e < terms.cols(); ++e) terms(0, e) = term(e);
    return parts_.interface.processes().sum_of_parts(std::move(terms))[0];
  }
  double dot(const Vector& f, const Vector& g) const {
    return summed([&](Index e) { return parts_.part_of_dot(e, f, g); });
  }
  void gather_interface_impulses();
  SweepSums sweeps(GranularSubdomain<D>& subdomain) const;
  std::vector<SweepSums> stage_one();
  bool enriched_now() const {
    return enriched_ && (solver_.enrichment == Enrichment::every_iteration || iteration_ == 1);
  }
  Vector preconditioned(const Vector& g) const {
    return enriched_now() ? enriched_->solve(g) : parts_.generic_interface_solve(g);
  }
  void correct(const Vector& change);
  // Whole copies then have the same velocity, that of all impulses.
  void exchange_resultants() { correct(parts_.generic_interface_solve(parts_.interface_jumps())); }
  Vector conjugate_step(const Vector& jumps, std::vector<SweepSums>& sums);

  GranularDecomposition<D> parts_;
  ContactLaw law_;
  StepSolver solver_;
  std::optional<InterfaceOperator> enriched_;
  Vector interface_impulses_ = Vector::Zero(parts_.interface_size()), last_change_ = interface_impulses_;
  Vector direction_, last_jumps_, last_preconditioned_;  // of conjugate gradients
  std::vector<ModelSwitch<D>> switches_;                 // of each subdomain; empty unless models are switched
  // |V_free|^2 over the copies of shared grains
  double free_speed_squared_ = summed([this](Index e) { return parts_.glued_speed_squared(e); });
  double impulse_floor_squared_ = 0;  // below it impulses are rounding of the momenta
  Index iteration_ = 0, sweeps_ = 0;
  std::vector<std::vector<SweptVector<D>>> remembered_;  // impulses of each subdomain
  // Terms of the last record: a row per Quantity, a column per subdomain.
  Eigen::MatrixXd last_terms_ = Eigen::MatrixXd::Zero(quantities, count(parts_.subdomains));
};

}  // namespace nscdd
