// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_matrix.hpp"
#include "linalg/linear_iteration.hpp"
#include "two_stage/step_solver.hpp"
#include <nscdd/ddm/bddc.hpp>
#include <nscdd/ddm/interface_operator.hpp>

namespace nscdd {

struct CutOptions {
  InterfacePreconditioner preconditioner = InterfacePreconditioner::active;
  double flexibility = 10;  ///< c: links of X_eta are c times as flexible as those of Stage 1
  double tolerance = 1e-6;  ///< largest jump of a solution, relative to jumps without interface impulses
  Index maximum_iterations = 500;
  Scaling scaling = Scaling::deluxe;
  CoarseSpace coarse_space = CoarseSpace::none;
  double kappa = 30;           ///< that GenEO shall keep
  Period period = {};          ///< of the cell, for rigid motions
  InertiaMethod inertia = {};  ///< factorises P, see InterfaceOperator::solve
  Bddc bddc = {};              ///< takes the place of Stage 1 and Stage 2, for symmetric systems
};

/// Linear systems  P r + Q W r = b  of the contacts of a step (see ContactMatrix), cut in the FETI way. E = P^-1 Q.
///   Stage 1  K_E V_E = H_E P^-1 b - A_E^T F,  K_E = M_E + H_E E H_E^T: one factorised solve per subdomain
///   Stage 2  S F = g by a Krylov method,  S = sum_E A_E K_E^-1 A_E^T, preconditioned by
///            P = sum_E A_E (M_E + H_E D H_E^T / c)^-1 A_E^T  or, with c = 1, by the local_preconditioner of this sum,
/// where D is the diagonal of E: X_eta with eta = c alpha on the active contacts. In space D keeps the symmetric part
/// of the tangential blocks of E: a sliding contact resists across its direction only. Then r = P^-1 b - E H_E^T V_E.
/// With BDDC the V_E are the copies R_E V of (sum_E R_E^T K_E R_E) V = sum_E R_E^T H_E P^-1 b instead.
/// No bit depends on the number of threads. Collective: each rank has its own subdomains and contacts, and whole
/// interface vectors. No bit depends on the number of ranks, but for those of the shared factor of X_eta, and of BDDC.
template <int D>
class CutContacts {
 public:
  /// `parts`: a decomposition with D columns per contact, normal and tangential; a rank has its own share.
  CutContacts(Decomposition parts, const CutOptions& options);

  /// As ContactMatrix::factorise.
  bool factorise(std::vector<ContactRelation<D>> relations);
  /// As ContactMatrix::solve. The iterations may end before their tolerance, see `work`.
  Vector solve(const Vector& b);

  /// As ContactMatrix::determinant_sign, after a solve: the sign of Stage 1 times that of P^-1 S on the largest Krylov
  /// space of Stage 2. It misses an eigenvalue if no right-hand side has a component along its vector.
  int determinant_sign() const;
  /// As ContactMatrix::take_operations, of Stage 1.
  double take_operations();

  const std::vector<ContactRelation<D>>& relations() const { return relations_; }
  Vector apply(const Vector& f) const;  ///< S F
  /// P^-1 g
  Vector precondition(const Vector& g) const { return local_ ? local_(g) : preconditioner_->solve(g); }
  Matrix dense() const;  ///< S

  /// Totals since construction.
  struct Work {
    Index solves = 0, iterations = 0, failures = 0;
    double flops = 0;       ///< of Stage 1 on this rank, at the last take_operations
    double path_flops = 0;  ///< on the critical path: the sum over take_operations of the maximum over ranks
  };
  const Work& work() const { return work_; }

 private:
  const Processes& processes() const { return parts_.interface.processes(); }
  std::vector<Vector> velocities(const std::vector<Vector>& impulses) const;  // K_E^-1 of them
  std::vector<Vector> glued_velocities(std::vector<Vector> impulses);         // the same with F, or by BDDC
  SparseMatrix system_of(Index subdomain) const;                              // K_E

  using Blocks = std::vector<Eigen::Matrix<double, D, D>>;
  // Zeros off the diagonal of blocks.
  enum class Zeros { stored, left_out };
  SparseMatrix blocks_of(Index subdomain, const Blocks& blocks, Zeros zeros) const;
  Decomposition stage_two() const;
  LinearMap local_map() const;

  Decomposition parts_;
  CutOptions options_;
  std::vector<std::vector<Index>> own_;  // component of this rank's vectors, for each column of H_E
  std::vector<ContactRelation<D>> relations_;
  Blocks e_;
  std::vector<std::optional<SparseLu>> lu_;
  BddcSystem bddc_;
  double bddc_flops_ = 0;
  std::optional<InterfaceOperator> preconditioner_;
  LinearMap local_;  // see local_preconditioner
  bool symmetric_ = false;
  IteratedSolution longest_;  // of the last relations
  Work work_;
};

}  // namespace nscdd
