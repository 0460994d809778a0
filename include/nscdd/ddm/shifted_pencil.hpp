// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>
#include <nscdd/ddm/contraction.hpp>

#include <memory>

namespace nscdd {

/// How a ShiftedPencil holds the subdomains of S.
enum class SystemForm {
  condensed,  ///< M_E + K_E/epsilon
  augmented,  ///< with the contact impulses, for epsilon near 0
};

/// When solutions take a step of refinement. An error e of theirs moves an eigenvalue lambda by
/// e |lambda - sigma|.
enum class SolutionAccuracy {
  enough_next_to_an_end,  ///< where the inexactness is above 1e-6
  refined,                ///< above 1e-10, for eigenvalues far from the shift
};

/// The pencil S f = lambda P f of a contraction operator seen from a shift sigma > 0: one sparse symmetric
/// factorisation of the saddle-point matrix
///     [ M_E + K_E/epsilon                                A_E^T ]
///     [                    -(M_E + K_E/eta)  sqrt(sigma) A_E^T ]
///     [ A_E                 sqrt(sigma) A_E              0     ]
/// or, for eta = infinity,
///     [ M_E + K_E/epsilon   A_E^T   ]
///     [ A_E                 sigma X ]
/// whose Schur complement on the interface is sigma P - S. Hence (Sylvester, Haynsworth) it has as many
/// negative eigenvalues as its -P block has rows, plus n_Gamma, minus the number of eigenvalues lambda below
/// sigma.
///
/// For epsilon near 0 the block M_E + K_E/epsilon loses the digits of M_E: `SystemForm::augmented` keeps the
/// contact impulses, [M_E H_E; H_E^T -epsilon I] in its place, with as many more negative eigenvalues as
/// contacts.
class ShiftedPencil {
 public:
  bool regular() const;  ///< false where a pivot was exactly zero; nothing else may then be asked

  /// ||d|| / ||x|| on the interface, d the correction of one step of iterative refinement of a solution x:
  /// how far the factors are from exact. With A + E = L D L^T it estimates the size of (A + E)^-1 E, and
  /// while that is below 1 no eigenvalue changes sign on the way from A to A + E, so that the count below
  /// holds for A itself.
  double inexactness() const;

  /// Whether the inexactness is small enough for counts and solutions to be used. Where it is not, sigma is
  /// too near an eigenvalue, of the pencil or of a part of the packing, and one a little to the side serves
  /// as well.
  bool reliable() const { return regular() && inexactness() < 1e-3; }

  /// The same for what `solve` returns, which is refined by one step where that is worth it.
  double solution_error() const;

  double shift() const;
  Index below() const;  ///< eigenvalues lambda of (S, P) below the shift, with multiplicity

  Vector solve(const Vector& g) const;  ///< (S - sigma P)^-1 g

  /// A solution f = (S - sigma P)^-1 g and how f^T S f and f^T P f change with the flexibilities, from the
  /// velocities V = (M_E + K_E/epsilon)^-1 A_E^T f and V' = (M_E + K_E/eta)^-1 A_E^T f that come with it:
  struct Response {
    Vector f;
    double system = 0;          ///< d f^T S f / d log epsilon = V^T K_E V / epsilon
    double preconditioner = 0;  ///< d f^T P f / d log eta = V'^T K_E V' / eta, 0 for eta = infinity
  };
  Response respond(const Vector& g) const;

  class Implementation;
  explicit ShiftedPencil(std::shared_ptr<const Implementation> implementation);

 private:
  std::shared_ptr<const Implementation> implementation_;
};

/// Every shifted pencil of one pair of decompositions: the elimination order and its fronts are found once
/// and serve all epsilon, eta (finite, or all infinite) and sigma; what is eliminated apart from the
/// interface does not depend on sigma and is kept from shift to shift.
class ShiftedPencilFamily {
 public:
  /// S and P from the operators of `b`; their flexibilities do not matter but for eta being infinite or not.
  explicit ShiftedPencilFamily(const Contraction& b, SystemForm form = SystemForm::condensed);

  /// Whether the family was made for the decompositions, the kind of eta of `b`, and this form.
  bool serves(const Contraction& b, SystemForm form = SystemForm::condensed) const;

  /// epsilon > 0, eta > 0 (infinite if and only if the family's is), sigma > 0.
  ShiftedPencil at(double epsilon, double eta, double sigma,
                   SolutionAccuracy accuracy = SolutionAccuracy::enough_next_to_an_end) const;

  /// Frees the numbers that are kept for another shift at the last epsilon and eta.
  void release() const;

  Index unknowns() const;         ///< of the saddle-point matrix
  double factor_entries() const;  ///< of its factor and what is kept beside it, 8 bytes each

  class Preparation;

 private:
  std::shared_ptr<const Preparation> preparation_;
};

}  // namespace nscdd
