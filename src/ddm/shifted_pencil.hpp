// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/rigid_system.hpp"
#include <nscdd/ddm/contraction.hpp>

namespace nscdd {

/// How a ShiftedPencil represents the subdomains of S.
enum class SystemForm {
  condensed,  ///< M_E + K_E/epsilon
  augmented,  ///< with the contact impulses, for epsilon near 0
  rigid,      ///< the limit epsilon = 0: the velocities of a RigidSystem, with its contact impulses
};

/// When solutions take a step of refinement. Their relative error e moves an eigenvalue lambda by e |lambda - sigma|.
enum class SolutionAccuracy {
  enough_next_to_an_end,  ///< if the inexactness is above 1e-6
  refined,                ///< if it is above 1e-10, for eigenvalues far from the shift
};

struct SaddlePointFamily;  // the matrices of a family, in shifted_pencil.cpp

/// The pencil S f = lambda P f at a shift sigma >= 0: one sparse symmetric factorisation of the saddle-point matrix
///     [ M_E + K_E/epsilon                                A_E^T ]
///     [                    -(M_E + K_E/eta)  sqrt(sigma) A_E^T ]
///     [ A_E                 sqrt(sigma) A_E              0     ]
/// or, for eta = infinity,
///     [ M_E + K_E/epsilon   A_E^T   ]
///     [ A_E                 sigma X ]
/// whose Schur complement on the interface is sigma P - S. Hence (Sylvester, Haynsworth) it has as many negative
/// eigenvalues as its -P block has rows, plus n_Gamma, minus the number of eigenvalues lambda below sigma.
///
/// For epsilon near 0 the block M_E + K_E/epsilon loses digits of M_E. `SystemForm::augmented` replaces it by [M_E H_E;
/// H_E^T -epsilon I] with the contact impulses, which adds one negative eigenvalue per contact. For epsilon = 0
/// `SystemForm::rigid` has [Z^T M_E Z, Z^T H_E; H_E^T Z, 0] and A_E Z, with independent contacts outside clusters.
///
/// The scheme schwarz has the pencil S = P + P C^-1 P, P = M_b^-1 - F, with C = (1 1^T / (q - 1) - I) / m per grain
/// (Contraction of docs/theory.md, section 17): P f = (lambda - 1) C f. Its matrix
///     [ M_E + K_E/epsilon   N_E^T                             ]
///     [ N_E                 1 1^T / ((q - 1) m) - sigma C     ]
/// has the Schur complement Z = P + (1 - sigma) C, and (S - sigma P)^-1 P = I/(1 - sigma) - Z^-1 P/(1 - sigma): the
/// first term is the offset. With n_b rows of copies and n_s velocities of shared grains, n_b - n_s - negative(Z)
/// eigenvalues lie below sigma < 1, and n_s - negative(Z) above sigma > 1.
class ShiftedPencil {
 public:
  /// False if the factorisation broke down; then nothing else may be called.
  bool regular() const { return factor_.regular; }

  /// ||d|| / ||x|| on the interface, d the correction of a solution x by one step of iterative refinement. The factors
  /// are exact for some A + E, and the ratio estimates the size of (A + E)^-1 E. While it is below 1, no eigenvalue
  /// changes sign between A and A + E, so `below` holds for A itself.
  double inexactness() const { return inexactness_; }

  /// Whether counts and solutions may be used. If not, sigma is too near to an eigenvalue: take another shift.
  bool reliable() const { return regular() && inexactness() < reliable_inexactness; }

  /// The inexactness of `solve`, which takes a step of refinement if it pays.
  double solution_error() const { return refinement_ ? inexactness_ * inexactness_ : inexactness_; }

  double shift() const { return shift_; }
  Index below() const;                  ///< eigenvalues lambda of (S, P) below the shift, with multiplicity
  Vector solve(const Vector& g) const;  ///< (S - sigma P)^-1 g, without its part offset() P^-1 g
  double offset() const;                ///< 0 but for the scheme schwarz

  /// A solution f as of `solve`, and how f^T S f and f^T P f change with the flexibilities, from the velocities
  /// V = (M_E + K_E/epsilon)^-1 A_E^T f and V' = (M_E + K_E/eta)^-1 A_E^T f of that solution.
  struct Response {
    Vector f;
    double system = 0;          ///< d f^T S f / d log epsilon = V^T K_E V / epsilon
    double preconditioner = 0;  ///< d f^T P f / d log eta = V'^T K_E V' / eta, 0 for eta = infinity
  };
  Response respond(const Vector& g) const;

 private:
  friend class ShiftedPencilFamily;
  Vector residual(const Vector& x, const Vector& g) const;
  double scale() const;

  std::shared_ptr<const SaddlePointFamily> matrices_;
  double epsilon_ = 1, eta_ = 1, shift_ = 1, inexactness_ = infinity;
  InertiaFactor factor_;
  std::optional<SparseMatrix> refinement_;  // the matrix, if solutions are refined
};

/// Every shifted pencil of one pair of decompositions. The elimination order and its fronts serve all epsilon, eta
/// (finite, or all infinite) and sigma. Factors of rows that do not depend on sigma are kept from shift to shift.
class ShiftedPencilFamily {
 public:
  /// Of the flexibilities of `b` only matters whether eta is infinite. `rigid`: for `SystemForm::rigid` only.
  explicit ShiftedPencilFamily(const Contraction& b, SystemForm form = SystemForm::condensed,
                               const InertiaMethod& method = multifrontal(),
                               std::shared_ptr<const RigidSystem> rigid = {});

  /// Whether the family was made for the decompositions of `b`, its kind of eta, this form and this method.
  bool serves(const Contraction& b, SystemForm form = SystemForm::condensed,
              const InertiaMethod& method = multifrontal()) const;

  /// epsilon > 0 (not of the rigid form), eta > 0 (infinite if and only if the family's is), sigma >= 0 (0 gives S).
  ShiftedPencil at(double epsilon, double eta, double sigma,
                   SolutionAccuracy accuracy = SolutionAccuracy::enough_next_to_an_end) const;

  /// Frees the factors that are kept for another shift at the last epsilon and eta.
  void release() const { factors_.release(); }

 private:
  std::shared_ptr<const SaddlePointFamily> matrices_;
  std::string method_name_;
  InertiaFamily factors_;
};

}  // namespace nscdd
