// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/pencil_end.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {

/// One side of the spectrum of (S, P) at a point of a sweep: which way is inwards, how near is near enough,
/// and the factorisations and solves. The search for the end (pencil_end.cpp) and the list of eigenvalues
/// behind it (pencil_list.cpp) share it.
class PencilSide {
 public:
  PencilSide(const ShiftedPencilFamily& family, const InterfaceOperator& preconditioner, const PencilPoint& at_point,
             SpectrumEnd at_end, const EndOptions& end_options)
      : point(at_point), end(at_end), options(end_options), family_(family), p_(preconditioner) {}

  const PencilPoint& point;
  const SpectrumEnd end;
  const EndOptions& options;
  SolutionAccuracy accuracy = SolutionAccuracy::enough_next_to_an_end;
  Index factorisations = 0, solves = 0;

  Index size() const { return p_.rows(); }
  Vector preconditioner(const Vector& x) const { return p_.apply(x); }  ///< P x

  /// Signed so that inwards is positive at both ends.
  double inward(double difference) const { return end == SpectrumEnd::smallest ? difference : -difference; }

  /// Of lambda. It is relative if |1 - lambda|, an eigenvalue of B, is above 1.
  double tolerance(double lambda) const { return options.tolerance * std::max(1.0, std::abs(1 - lambda)); }
  double rounding(double lambda) const { return point.rounding * std::max(1.0, std::abs(lambda)); }

  /// How far beyond an eigenvalue the last shift is placed. Within the rounding of the matrix a count would
  /// say nothing. A tenth of the tolerance, because a relaxation multiplies the distance to the residual of
  /// the relaxed spectrum.
  double margin(double lambda) const { return std::max(0.1 * tolerance(lambda), 2 * rounding(lambda)); }

  /// The pencil at the shift, or at one nearby whose factorisation can be relied on; none if there is no such
  /// shift. `side`: which way to step from an unreliable one, inwards (1) or outwards (-1).
  std::optional<ShiftedPencil> factorise(double shift, double side = -1);

  /// Eigenvalues beyond the shift.
  Index beyond(const ShiftedPencil& pencil) const {
    return end == SpectrumEnd::smallest ? pencil.below() - point.kernel : size() - pencil.below();
  }

  ShiftedPencil::Response respond(const ShiftedPencil& pencil, const Vector& g) { return ++solves, pencil.respond(g); }

  /// `towards`: the side of the shift that is looked at, see shift_invert_lanczos.
  ShiftInvertResult lanczos(const ShiftedPencil& pencil, SpectrumEnd towards, Index wanted,
                            const ShiftInvertOptions& lanczos_options, const Vector& start, const Matrix& locked = {});

 private:
  const ShiftedPencilFamily& family_;
  const InterfaceOperator& p_;
};

/// Adds to `result`, which has the end, the eigenvalues behind it, as many as the options want, from a shift
/// far enough out to see them all. `result` stays converged if they all are and a count proves that none is
/// missing.
void list_behind(PencilSide& side, PencilEnd& result);

}  // namespace nscdd
