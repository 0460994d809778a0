// SPDX-License-Identifier: GPL-3.0-or-later
#include "ddm/pencil_side.hpp"

namespace nscdd {

std::optional<ShiftedPencil> PencilSide::factorise(double shift, double side) {
  // The first steps stay within the tolerance of the end. The later ones go far enough to leave whatever made
  // the factorisation unreliable, usually an eigenvalue of a part of the packing.
  for (const double step : {0.2, 0.5, 3.0, 30.0, 300.0}) {
    ++factorisations;
    ShiftedPencil pencil = family_.at(point.epsilon, point.eta, shift, accuracy);
    if (pencil.reliable()) return pencil;
    shift = std::max(shift + side * inward(step * tolerance(shift)), 0.5 * shift);
  }
  return std::nullopt;
}

ShiftInvertResult PencilSide::lanczos(const ShiftedPencil& pencil, SpectrumEnd towards, Index wanted,
                                      const ShiftInvertOptions& lanczos_options, const Vector& start,
                                      const Matrix& locked) {
  const LinearMap p = [this](const Vector& x) -> Vector { return p_.apply(x); };
  const LinearMap inverse = [&](const Vector& x) -> Vector { return ++solves, pencil.solve(x); };
  return shift_invert_lanczos(size(), inverse, p, pencil.shift(), towards, wanted, lanczos_options, start, locked);
}

}  // namespace nscdd
