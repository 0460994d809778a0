// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "contact_solvers/contact_matrix.hpp"
#include "contact_solvers/sweep_rows.hpp"
#include "mechanics/contact_law.hpp"

namespace nscdd::testing {

/// Sweeps in the given order on the stored W; after each, r gains `momentum` times its change.
template <int D>
Vector literal_sweeps(const LocalFrictionProblem& problem, const std::vector<Index>& order, Vector r, Index sweeps,
                      double omega, double momentum) {
  Vector before = r;
  for (Index sweep = 0; sweep < sweeps; ++sweep) {
    for (const Index c : order) {
      const Vector u = (problem.w * r + problem.q).template segment<D>(D * c);
      const FullDelassus<D> w = diagonal_block<D>(problem, c);
      const LocalVector<D> now = component<D>(r, c);
      const LocalVector<D> wanted = Coulomb{}.impulse(stopping(w, now, component<D>(u, 0)), w, problem.friction[c]);
      set_component(r, c, now + omega * (wanted - now));
    }
    const Vector swept = r;
    r += momentum * (swept - before);
    before = swept;
  }
  return r;
}

/// P + Q W of the linear systems of the contacts.
template <int D>
Matrix literal_system(const Matrix& w, const std::vector<ContactRelation<D>>& relations) {
  Matrix p = Matrix::Zero(w.rows(), w.cols()), q = p;
  for (Index c = 0; c < count(relations); ++c) {
    p.block<D, D>(D * c, D * c) = relations[at(c)].p;
    q.block<D, D>(D * c, D * c) = relations[at(c)].q;
  }
  return p + q * w;
}

}  // namespace nscdd::testing
