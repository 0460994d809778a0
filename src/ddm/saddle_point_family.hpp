// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/shifted_pencil.hpp"
#include <nscdd/ddm/contraction.hpp>
#include <nscdd/linalg/inertia_factor.hpp>

#include <vector>

namespace nscdd {

/// The saddle-point matrices of all shifted pencils of two decompositions, see ShiftedPencil: what is added
/// up in them for given epsilon, eta and sigma. Their rows are, in this order, the velocities of the
/// subdomains of S, its contact impulses (augmented form only), the velocities of the subdomains of P (finite
/// eta only), and the interface.
struct SaddlePointFamily {
  SaddlePointFamily(const Contraction& b, SystemForm form);

  /// Lower triangle. Rows of the -P block are scaled by sqrt(sigma), so that sigma appears between rows of
  /// one interface grain or of two, and nowhere else.
  SparseMatrix matrix(double epsilon, double eta, double sigma) const;

  /// One pattern for all. All copies of a grain and the gluing of these copies are eliminated together, a
  /// contact impulse with the later of its grains.
  InertiaPattern pattern() const;

  Index rows() const { return inertia.rows(); }
  Index interface_size() const { return rows() - interface; }

  /// Negative eigenvalues of a matrix if no lambda is below its sigma; each lambda below takes one away.
  Index most_negative() const { return rows() - grain_rows; }

  /// What Response has, of a solution x for these epsilon, eta and sigma.
  ShiftedPencil::Response response(const Vector& x, double epsilon, double eta, double sigma) const;

  Contraction contraction;  ///< keeps the decompositions alive
  SystemForm form;
  bool generic;           ///< eta is infinite
  Index grain_rows = 0;   ///< first contact impulse of S
  Index system_size = 0;  ///< first row of the block of P
  Index interface = 0;    ///< first interface row
  /// Lower triangles of one pattern: the coefficients of 1, and those of 1/epsilon or 1/eta (of epsilon in
  /// the rows of the contact impulses).
  SparseMatrix inertia, stiffness;

 private:
  double energy(const Vector& x, Index first, Index last) const;
};

}  // namespace nscdd
