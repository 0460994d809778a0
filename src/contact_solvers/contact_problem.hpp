// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_matrix.hpp"
#include "contact_solvers/contact_sums.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

namespace nscdd {

/// W as W_s + W_a with a symmetric W_s, as files of six digits need it, and the linear systems P r + Q W_s r = b of all
/// contacts, for many P and Q.
template <int D>
struct Couplings {
  std::function<Vector(const Vector& r)> product;  ///< W_s r
  std::function<Vector(const Vector& r)> rest;     ///< W_a r
  /// As those of ContactMatrix. A solution that is not found is not finite.
  std::function<bool(std::vector<ContactRelation<D>>)> factorise;
  std::function<Vector(const Vector& b)> solve;
  std::function<double()> take_operations;
  std::function<int()> determinant_sign;
  /// W_s, where it is all that is known: a positive multiple of the diagonal may then be added and factorised at once.
  std::shared_ptr<const SparseMatrix> without_bodies = nullptr;
};

/// A contact problem u = W r + q as contact solvers know it, whatever holds W. Where several processes share it, each
/// has some of the contacts, and all call the same functions together. Vectors have D entries per contact.
template <int D>
struct ContactProblem {
  Vector q, friction;  ///< as those of a LocalFrictionProblem
  Vector speeds;       ///< of each contact those of both bodies without contact impulses, or of q, m/s
  Vector normal;       ///< W_nn of its contact at each component, 1/kg
  ContactSums sums = {};
  std::function<Vector(const Vector& r)> product;          ///< W r
  std::function<FullDelassus<D>(Index contact)> diagonal;  ///< its block of W
  std::optional<double> alone = {};                        ///< || r^1 || where q does not tell it, N s
  double product_operations = 0;                           ///< of a product with W and of a sweep, in all processes
  std::shared_ptr<const ContactBlocks<D>> rows = nullptr;  ///< W by rows of blocks, where it is stored
  /// Does so many sweeps on impulses r, those with the numbers `first`, `first` + 1, ..., and returns r.
  using Sweeps = std::function<Vector(const Vector& r, Index first, Index many)>;
  std::function<Sweeps(const FrictionSolverOptions&)> sweeps;
  std::function<Couplings<D>()> couplings;

  Index contacts() const { return friction.size(); }  ///< of this process
};

/// The contacts of a problem whose W is stored, in one process. `problem` must outlive them.
template <int D>
ContactProblem<D> stored_contacts(const LocalFrictionProblem& problem);

}  // namespace nscdd
