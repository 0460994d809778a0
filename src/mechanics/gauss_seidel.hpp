// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

namespace nscdd {

/// The local step of a Gauss-Seidel sweep (that over disks writes it out, for speed). `wanted` is the impulse
/// that the law of a contact gives while the others keep theirs; the contact takes the part `relaxation` of
/// the way to it. Returns the change, which its bodies must feel at once. Without `relaxed` the impulse is
/// `wanted` to the last bit.
template <bool relaxed, class Impulse>
Impulse take_impulse(Impulse& impulse, Impulse wanted, double relaxation = 1) {
  const Impulse before = impulse;
  impulse = relaxed ? before + relaxation * (wanted - before) : wanted;
  return impulse - before;
}

/// What a Gauss-Seidel sweep over contacts needs of a body of grains, prepared once.
struct ContactSystem {
  SparseMatrix h;         ///< H, d n x c
  SparseMatrix response;  ///< M^-1 H: velocity change of the grains per unit impulse
  Vector delassus;        ///< diagonal of W = H^T M^-1 H, c entries
};

ContactSystem prepare_contacts(const Vector& inertia, const SparseMatrix& h);

/// One NonLinear Gauss-Seidel sweep in the order of the contacts: each contact in turn takes the impulse its
/// law gives for the present velocities, and its grains are updated at once. Grain velocities carry the
/// off-diagonal part of W, which is never formed.
/// `impulses`: r, c entries; `velocities`: V, d n entries, on entry and exit V = V_free + M^-1 H r.
template <class Law>
void gauss_seidel_sweep(const ContactSystem& contacts, const Law& law, Vector& impulses, Vector& velocities) {
  for (Index c = 0; c < contacts.h.cols(); ++c) {
    double velocity = 0;  // v = H_c^T V
    for (SparseMatrix::InnerIterator e(contacts.h, c); e; ++e) velocity += e.value() * velocities[e.row()];
    const double free_velocity = velocity - contacts.delassus[c] * impulses[c];
    const double change = take_impulse<false>(impulses[c], law.impulse(free_velocity, contacts.delassus[c]));
    for (SparseMatrix::InnerIterator e(contacts.response, c); e; ++e) velocities[e.row()] += e.value() * change;
  }
}

}  // namespace nscdd
