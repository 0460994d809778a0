// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "dense.hpp"
#include "study/case/case.hpp"
#include "study/linear/optimum.hpp"
#include <nscdd/ddm/contraction.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

#include <vector>

namespace nscdd::testing {

/// The pencil (S, P) of a contraction operator from the dense interface operators, both scaled by
/// diag(X_inf)^-1/2, and all its eigenvalues by a solver that the library does not use (Eigen).
struct DenseSpectrum {
  explicit DenseSpectrum(const Contraction& b);
  Dense s, p;
  Vector root;    ///< the scaling, diag(X_inf)^-1/2
  Vector lambda;  ///< of P^-1 S, ascending

  Index below(double sigma) const { return (lambda.array() < sigma).count(); }
  Index between(double from, double to) const;  ///< [from, to]
};

/// I - X_eta^-1 X_epsilon of a case with all its contacts.
Contraction contraction_of(const Case& one, double epsilon, double eta = infinity);

/// spectral_radius by the dense pencil.
SpectralRadius dense_pencil_radius(const Contraction& b);

/// N disks of a hexagonal lattice of about as many rows as columns are wide, unit masses, cut by a grid.
Case lattice_in_grid(Index grains, std::array<Index, 2> grid);

/// A random deposit, cut by a grid or (parts > 0) by METIS.
Case deposit(Index grains, std::array<Index, 2> grid, Index parts = 0);

/// The packing with masses from 1e-2 to 1e2 kg, drawn at random.
Case with_unequal_masses(Case one, std::uint64_t seed);

/// Packings of every kind with up to about `largest` interface unknowns: strips, grids with cross points,
/// METIS parts, deposits, vacancies, masses of ratio 1e4, two copies side by side (every eigenvalue double).
std::vector<Case> packings_up_to(Index largest);

/// The only row of a table of optima.
Optimum optimum_of(const Model& model, double epsilon = 0, ContactSet contacts = ContactSet::active);

}  // namespace nscdd::testing
