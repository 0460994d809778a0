// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/gauss_seidel.hpp"

namespace nscdd {

ContactSystem prepare_contacts(const Vector& inertia, const SparseMatrix& h) {
  ContactSystem system{h, inertia.cwiseInverse().asDiagonal() * h, Vector::Zero(h.cols())};
  for (Index c = 0; c < h.cols(); ++c) system.delassus[c] = h.col(c).dot(system.response.col(c));
  return system;
}

}  // namespace nscdd
