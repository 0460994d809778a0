// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/step_solver.hpp"
#include "mechanics/time_stepping.hpp"
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

/// One subdomain E of a step: its contacts in the order in which a sweep visits them, and the bodies that
/// they touch. A shared grain has its share of mass.
struct GranularSubdomain {
  std::vector<Index> bodies;   ///< numbers in the step problem, in the order the sweep meets them
  std::vector<Index> numbers;  ///< of the contacts in the step problem
  ContactRows contacts;
  std::vector<DiskVelocity> velocities;
};

/// A step cut in the FETI way: contacts are distributed, and shared free grains are split and glued by a
/// chain of equalities. Driven bodies are not glued, because every subdomain knows their motion.
struct GranularDecomposition {
  std::vector<GranularSubdomain> subdomains;
  Interface interface;  ///< 3 unknowns per grain: x, y, rim

  Index interface_size() const { return interface.size(); }  ///< n_Gamma
};

/// Permutation of the contacts: the order in which they are to lie in memory. `bodies`: velocities of the
/// disks (driven ones may be shared within a colour). `points`: where the contacts are, m, all of them for
/// `interleaved`.
std::vector<Index> contact_order(Choice<ContactOrder> order, std::span<const DiskContact> contacts,
                                 std::span<const DiskVelocity> bodies, std::uint64_t seed,
                                 std::span<const std::array<double, 2>> points);

/// Splits a step along a partition of its contacts; velocities start at V_free, impulses as the step has
/// them. `order`, `seed`: see contact_order. Throws Error if the partition does not fit.
GranularDecomposition decompose(const StepProblem& problem, const Partition& partition, Choice<ContactOrder> order,
                                std::uint64_t seed);

/// Jumps sum_E A_E V_E of the copies of shared grains, n_Gamma.
Vector interface_jumps(const GranularDecomposition& parts);

/// Sum over the copies of shared grains of |V|^2, rim speed included.
double glued_speed_squared(const GranularDecomposition& parts);

/// X_inf^-1 g, see Interface::solve_generic; the rims have their own inertia.
Vector generic_interface_solve(const GranularDecomposition& parts, const Vector& g);

/// V_E <- V_E - M_E^-1 A_E^T change, for a change of F_Gamma.
void apply_interface_impulses(GranularDecomposition& parts, const Vector& change);

/// M and H of a step for the linear analysis. A disk has three rows (x, y, rim; inertia m, m, m/2), empty
/// ones in H if it is driven. Columns 2 c and 2 c + 1 are the normal and the tangential direction of contact
/// c. The arriving velocity is V_free. The bodies of walls, which come after the disks, are left out.
ReferenceProblem reference_problem(const StepProblem& problem, Index disks);

/// The partition of the columns of reference_problem.
Partition partition_of_columns(const Partition& of_contacts);

/// How one iteration went, [ADI12] eqs. (39), (40). |r| counts as at least 1e-12 times the impulses that the
/// grains bring (|M V_free|): if contacts exchange less than that, nothing is left to converge.
struct IterationRecord {
  Index iteration = 0, sweeps = 0;  ///< from 1; Gauss-Seidel sweeps per subdomain so far
  double zeta = 0;                  ///< |r_i - r_{i-1}| / |r_i| over all contacts
  double interface_change = 0;      ///< Z = |F_i - F_{i-1}| / |F_i|; 0 without an interface
  /// |F_i - 2 F_{i-1} + F_{i-2}| / |F_i|. Impulses may drift within what networks carry: Z then stays, this falls.
  double interface_second_change = 0;
  double gluing = 0;    ///< |sum A_E V_E| / max(|V_free|, |V|) over the copies of shared grains, after Stage 1
  double impulses = 0;  ///< |r_i|^2, (N s)^2
};

/// Algorithm 1 of [ADI12] on the contact problem of one step; without an interface nonlinear Gauss-Seidel, bit by bit.
///   Stage 1  n_GS sweeps in every subdomain, in threads, F_Gamma frozen
///   Stage 2  F <- F + omega P^-1 sum_E A_E V_E,  V_E <- V_E - M_E^-1 A_E^T (change of F)
/// with P = X, solved in closed form grain by grain (generic), or P = X_eta (enriched). This is the paper's
/// (16) for any law, see TwoStageIteration. No bit depends on the number of threads. With conjugate gradients
/// an iteration has a second, trial Stage 1: `sweeps` counts both, zeta is the change in the second alone.
class GranularTwoStage {
 public:
  /// `enriched`: X_eta of the same gluing (decompose(reference_problem(...), partition_of_columns(...))), or
  /// nothing for the generic algorithm. Velocities must be those of the impulses: see `start`. Throws Error
  /// if the operator was made for another gluing.
  GranularTwoStage(GranularDecomposition parts, const ContactLaw& law, const StepSolver& solver,
                   std::optional<InterfaceOperator> enriched);

  /// Sets V_E = M_E^-1 (F^d_E + H_E r_E - A_E^T F) for the impulses of the contacts and the gluing impulses
  /// of the step before. A grain that other subdomains share now starts from zero.
  void start(const std::vector<RememberedGluing>& gluing);

  IterationRecord iterate();

  /// Sums over all subdomains at the present velocities.
  ContactResidual residual() const;

  /// Status of every contact, in the numbers of the step problem.
  std::vector<ContactStatus> statuses() const;

  /// In the numbers of the step problem. The velocity of a shared grain is the mean of its copies.
  std::vector<DiskContact> contacts(const StepProblem& problem) const;
  std::vector<DiskVelocity> velocities(const StepProblem& problem) const;
  std::vector<RememberedGluing> gluing() const;

  const Vector& interface_impulses() const { return interface_impulses_; }  ///< F_Gamma, n_Gamma
  const GranularDecomposition& parts() const { return parts_; }

 private:
  SweepSums stage_one();
  Vector preconditioned(const Vector& jumps) const;
  void correct(const Vector& change);
  Vector conjugate_step(const Vector& jumps, SweepSums& sums);

  GranularDecomposition parts_;
  ContactLaw law_;
  StepSolver solver_;
  std::optional<InterfaceOperator> enriched_;
  Vector interface_impulses_ = Vector::Zero(parts_.interface_size()), last_change_ = interface_impulses_;
  Vector direction_, last_jumps_, last_preconditioned_;  // of conjugate gradients
  // Impulses of the subdomains before Stage 1, where n_GS > 1.
  std::vector<std::vector<LocalVector>> before_{parts_.subdomains.size()};
  double free_speed_squared_ = glued_speed_squared(parts_);  // |V_free|^2 over the copies of shared grains
  double impulse_floor_squared_ = 0;  // impulses below it are rounding of those that grains bring
  Index iteration_ = 0, sweeps_ = 0;
};

}  // namespace nscdd
