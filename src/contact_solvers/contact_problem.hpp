// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_matrix.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/core/processes.hpp>

namespace nscdd {

/// Sums over all contacts of a problem, and what else all of them decide together. Vectors have D entries per contact
/// of this process. By default it has all contacts. Otherwise contacts belong to parts, the subdomains, and sums over
/// these add up in their order, whoever has them: no bit depends on the number of processes, which ask together.
class ContactSums {
 public:
  ContactSums() = default;
  ContactSums(std::vector<Index> part_of_contact, Index parts, Processes processes)
      : part_(std::move(part_of_contact)), parts_(parts), processes_(std::move(processes)) {}

  /// So many sums: add(c, sums) adds what contact c brings to them, for c = 0 ... contacts - 1.
  template <class Add>
  Vector add_up(Index quantities, Index contacts, const Add& add) const {
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(quantities, std::max<Index>(parts_, 1));
    for (Index c = 0; c < contacts; ++c) add(c, sums.col(parts_ == 0 ? 0 : part_[at(c)]));
    return parts_ == 0 ? Vector(sums) : processes_.sum_of_parts(std::move(sums));
  }
  double dot(const Vector& a, const Vector& b) const {
    if (parts_ == 0) return a.dot(b);
    const Index size = part_.empty() ? 0 : a.size() / count(part_);
    return add_up(1, count(part_),
                  [&](Index c, auto&& sum) { sum[0] += a.segment(size * c, size).dot(b.segment(size * c, size)); })[0];
  }
  double squared_norm(const Vector& a) const { return parts_ == 0 ? a.squaredNorm() : dot(a, a); }
  double norm(const Vector& a) const { return parts_ == 0 ? a.norm() : std::sqrt(dot(a, a)); }

  Index total(Index own) const { return processes_.sum(own); }
  bool any(bool own) const { return processes_.any(own); }
  bool all_zero(const Vector& a) const { return !any(!a.isZero(0)); }
  /// Of entries >= 0; infinite if one is not a number.
  double largest(const Vector& entries) const {
    double own = 0;
    for (const double entry : entries) own = std::isnan(entry) ? infinity : std::max(own, entry);
    return processes_.maximum(own);
  }

 private:
  std::vector<Index> part_;
  Index parts_ = 0;
  Processes processes_;
};

/// The impulse that would bring a contact to rest, the others held:  r_c - W_c^-1 u_c.
template <int D>
LocalVector<D> stopping(const FullDelassus<D>& w, LocalVector<D> impulse, LocalVector<D> u) {
  return impulse - w.solve(u);
}

/// The data of the contacts of a problem u = W r + q. Where several processes share the problem, each has some of the
/// contacts; sums are over all of them. Vectors have D entries per contact.
struct ContactData {
  Vector q, friction;             ///< as those of a LocalFrictionProblem
  Vector normal;                  ///< W_nn of its contact at each component, 1/kg
  double product_operations = 0;  ///< of a product with W and of a sweep, in all processes
  ContactSums sums = {};
  double alone = 0;    ///< || r^1 ||, the impulses of the contacts each alone, N s
  double momenta = 0;  ///< p, what the bodies that meet at the contacts bring, N s
  double trace = 0;    ///< of W, 1/kg

  Index contacts() const { return friction.size(); }  ///< of this process

  /// Sets the sums `alone`, `momenta` and `trace`. diagonal(c): the block of W of contact c. `speeds`: of
  /// each contact those of both bodies without contact impulses, or of q, m/s.
  template <int D, class Diagonal>
  void set_sums(const Diagonal& diagonal, const Vector& speeds) {
    const Vector totals = sums.add_up(3, contacts(), [&](Index c, auto&& sum) {
      const FullDelassus<D> w = diagonal(c);
      sum[0] += squared(Coulomb{}.impulse(stopping(w, {}, component<D>(q, c)), w, friction[c]));
      const double momentum = speeds[c] / normal[D * c];
      sum[1] += momentum * momentum;
      if constexpr (D == 2)
        sum[2] += w.nn + w.tt;
      else
        sum[2] += w.nn + w.tt.first + w.tt.second;
    });
    alone = std::sqrt(totals[0]);
    momenta = std::sqrt(totals[1]);
    trace = totals[2];
  }
};

/// A contact problem as contact solvers use it, for any storage of W: a class with the functions below. If several
/// processes share the problem, all call the same functions together.
///
/// The linear systems are those of W_s, where W = W_s + W_a with a symmetric W_s, as files of six digits need it. One
/// matrix is factorised at a time; a solution that is not found is not finite.
template <class P>
concept ContactProblem = requires(P& problem, const P& fixed, const Vector& r, Index number,
                                  const FrictionSolverOptions& options,
                                  std::vector<ContactRelation<P::dimension>> relations) {
  { fixed.data } -> std::convertible_to<const ContactData&>;
  { fixed.product(r) } -> std::same_as<Vector>;  // W r
  // A function that does `many` sweeps on impulses r, those numbered `first`, `first` + 1, ..., and returns r.
  { problem.sweeps(options)(r, number, number) } -> std::same_as<Vector>;
  { problem.symmetric_product(r) } -> std::same_as<Vector>;           // W_s r
  { problem.rest(r) } -> std::same_as<Vector>;                        // W_a r
  { problem.factorise(std::move(relations)) } -> std::same_as<bool>;  // as ContactMatrix
  { problem.factorise_shifted(r) } -> std::same_as<bool>;             // W_s + diag(r), r > 0
  { problem.solve(r) } -> std::same_as<Vector>;
  { problem.take_operations() } -> std::same_as<double>;
  { problem.determinant_sign() } -> std::same_as<int>;
};

/// One whose W is stored, in `rows()` of blocks.
template <class P>
concept StoredProblem = ContactProblem<P> && requires(const P& fixed) {
  { fixed.rows() } -> std::convertible_to<const ContactBlocks<P::dimension>&>;
};

}  // namespace nscdd
