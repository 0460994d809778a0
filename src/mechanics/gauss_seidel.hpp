// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// The local step of a Gauss-Seidel sweep (the sweep over disks repeats it inline, for speed): r <- r + relaxation
/// (wanted - r), where `wanted` is the impulse of the law while the other contacts keep theirs. Returns the change,
/// which the caller applies to the bodies at once. Without `relaxed` the impulse is `wanted` to the last bit.
template <bool relaxed, class Impulse>
Impulse take_impulse(Impulse& impulse, Impulse wanted, double relaxation = 1) {
  const Impulse before = impulse;
  impulse = relaxed ? before + relaxation * (wanted - before) : wanted;
  return impulse - before;
}

struct ContactSystem {
  ContactSystem(const Vector& inertia, const SparseMatrix& connectivity)
      : h(connectivity), response(inertia.cwiseInverse().asDiagonal() * h), delassus(Vector::Zero(h.cols())) {
    for (Index c = 0; c < h.cols(); ++c) delassus[c] = h.col(c).dot(response.col(c));
  }

  SparseMatrix h;         ///< H, d n x c
  SparseMatrix response;  ///< M^-1 H: velocity change of the grains per unit impulse
  Vector delassus;        ///< diagonal of W = H^T M^-1 H, c entries
};

/// One nonlinear Gauss-Seidel sweep in the order of the contacts: each takes the impulse of its law at the present
/// velocities, and its grains are updated at once. W is never formed: velocities carry its off-diagonal part.
/// `impulses`: r, c entries; `velocities`: V, d n entries, on entry and exit V = V_free + M^-1 H r.
void gauss_seidel_sweep(const ContactSystem& contacts, const auto& law, Vector& impulses, Vector& velocities) {
  for (Index c = 0; c < contacts.h.cols(); ++c) {
    double velocity = 0;  // v = H_c^T V
    for (SparseMatrix::InnerIterator e(contacts.h, c); e; ++e) velocity += e.value() * velocities[e.row()];
    const double free_velocity = velocity - contacts.delassus[c] * impulses[c];
    const double change = take_impulse<false>(impulses[c], law.impulse(free_velocity, contacts.delassus[c]));
    for (SparseMatrix::InnerIterator e(contacts.response, c); e; ++e) velocities[e.row()] += e.value() * change;
  }
}

struct ProgressLimits {
  double tolerance = 0;      ///< of the indicator
  double growth = infinity;  ///< of the size of the solution over its scale
  double fall = 1;           ///< an indicator makes progress if it is below this part of the smallest so far
  Index patience = 1;        ///< the iteration stalls after so many steps without progress ...
  Index longer = 0;          ///< ... and so many times as many as it took to get there
};

/// Watches an iteration by an indicator and the size of its solution. `Status` has converged, stalled and diverged.
template <class Status>
class ProgressWatch {
 public:
  /// `not_finite`: the status of an indicator that is not a number or a size that is not finite.
  ProgressWatch(const ProgressLimits& limits, Status not_finite) : limits_(limits), not_finite_(not_finite) {}

  /// How the iteration ended; empty if it goes on. `may_converge`: whether a small indicator is enough.
  std::optional<Status> judge(Index step, double indicator, double size, double scale, bool may_converge = true) {
    if (std::isnan(indicator) || !std::isfinite(size)) return not_finite_;
    if (scale > 0 && size > limits_.growth * scale) return Status::diverged;
    if (indicator <= limits_.tolerance && may_converge) return Status::converged;
    if (indicator < limits_.fall * smallest_) {
      smallest_ = indicator;
      last_progress_ = step;
    }
    const Index waited = step - last_progress_;
    const bool stalled = waited >= std::max(limits_.patience, limits_.longer * last_progress_);
    return stalled && indicator < infinity ? std::optional(Status::stalled) : std::nullopt;
  }

  /// The step of the last progress; set it for progress by another test than the indicator.
  Index last_progress() const { return last_progress_; }
  void take_for_progress(Index step) { last_progress_ = step; }

 private:
  ProgressLimits limits_;
  Status not_finite_;
  double smallest_ = infinity;
  Index last_progress_ = 0;
};

}  // namespace nscdd
