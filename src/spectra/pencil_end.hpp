// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/shifted_pencil.hpp"
#include "linalg/krylov.hpp"

namespace nscdd {

/// A point of a sweep where an end of the spectrum is searched, with bounds that are known beforehand.
struct PencilPoint {
  double epsilon = 1;
  double eta = infinity;
  Index kernel = 0;        ///< eigenvalues to skip at the low end: the zeros of the rigid limit
  double low = 0;          ///< no other eigenvalue is below; >= 0
  double high = infinity;  ///< no eigenvalue is above
  /// Lost digits move an eigenvalue by up to this times max(1, |lambda|). Certificates keep this distance.
  double rounding = 0;
  /// Scheme schwarz: F_epsilon, where the inner product is X_inf - F, see ShiftedPencil. Must outlive the point.
  const InterfaceOperator* without = nullptr;
};

struct EndGuess {
  double value = 0;        ///< > 0
  double uncertainty = 0;  ///< >= 0
};

struct EndOptions {
  double tolerance = 1e-8;  ///< of lambda, times max(1, |1 - lambda|)
  Index eigenvalues = 1;    ///< wanted, from the end inwards
  bool certify = false;
  Index maximum_factorisations = 40;
  Index steps = 24;  ///< of Lanczos from one shift; then a closer shift is worth its factorisation
};

/// One end of the spectrum of (S, P).
struct PencilEnd {
  Vector values;   ///< from the end inwards; empty if none was found
  Matrix vectors;  ///< n_Gamma x k, interface impulses
  /// The end lies within this distance of the first value, and an eigenvalue within it of each other value. It is the
  /// distance between two proved bounds of the end, plus an estimate of the error of the solves. One bound is the first
  /// value: a Rayleigh quotient is never beyond the end. Beyond the other a count or prior knowledge excludes all.
  double residual = infinity;
  bool converged = false;  ///< residual <= tolerance, and no copy of a value is missing
  /// Inertia counts prove that no eigenvalue lies beyond `outside`, and that `within` lie between it and `inside`.
  bool certified = false;
  double outside = not_a_number, inside = not_a_number;
  Index within = 0;  ///< with multiplicity
  /// d lambda / d log epsilon and d lambda / d log eta of the first value (Hellmann and Feynman).
  double slope_epsilon = 0, slope_eta = 0;
  Index factorisations = 0, solves = 0;
};

/// Finds one end of the spectrum by shifts that approach it from outside.
/// 1. Factorise at a shift beyond the expected end. The inertia proves that no eigenvalue lies further out; if some do,
///    step out and begin again.
/// 2. Run shift-inverted Lanczos from this shift. Unless the end is crowded, a few steps bring it to within a fraction
///    of the tolerance.
/// 3. Factorise a tenth of the tolerance beyond the value found. If no eigenvalue lies beyond, the end is proved, and
///    one solve completes the vector. If some do, the end is among these few: search from there as in 2.
/// A crowded end costs some more factorisations, not thousands of products. `start`: initial vector, or empty.
PencilEnd find_end(const ShiftedPencilFamily& family, const InterfaceOperator& preconditioner, const PencilPoint& point,
                   SpectrumEnd end, const std::optional<EndGuess>& guess, const Vector& start,
                   const EndOptions& options);

/// One side of the spectrum at a point of a sweep, for the search for the end and the list of eigenvalues behind it.
struct PencilSide {
  const ShiftedPencilFamily& family;
  const InterfaceOperator& p;
  const PencilPoint& point;
  const SpectrumEnd end;
  const EndOptions& options;
  SolutionAccuracy accuracy = SolutionAccuracy::enough_next_to_an_end;
  PencilEnd result = {};

  /// Signed distance, positive inwards at both ends.
  double inward(double difference) const { return end == SpectrumEnd::smallest ? difference : -difference; }

  /// Tolerance of lambda, relative if |1 - lambda|, an eigenvalue of B, is above 1.
  double tolerance(double lambda) const { return options.tolerance * std::max(1.0, std::abs(1 - lambda)); }
  double rounding(double lambda) const { return point.rounding * std::max(1.0, std::abs(lambda)); }

  /// Distance of the last shift beyond an eigenvalue: clear of rounding, at least tolerance / 10 (omega scales errors).
  double margin(double lambda) const { return std::max(0.1 * tolerance(lambda), 2 * rounding(lambda)); }

  /// The pencil at the shift or, if unreliable, at a nearby one inwards (`side` = 1) or outwards (-1), or nothing.
  std::optional<ShiftedPencil> factorise(double shift, double side = -1);

  Index beyond(const ShiftedPencil& pencil) const {
    return end == SpectrumEnd::smallest ? pencil.below() - point.kernel : p.rows() - pencil.below();
  }

  /// P x, the inner product of the pencil.
  Vector apply(const Vector& x) const {
    return point.without == nullptr ? p.apply(x) : Vector(p.apply(x) - point.without->apply(x));
  }

  /// (S - sigma P)^-1 P x. `respond`: with slopes.
  Vector inverse(const ShiftedPencil& pencil, const Vector& x) {
    return ++result.solves, pencil.solve(apply(x)) + pencil.offset() * x;
  }
  ShiftedPencil::Response respond(const ShiftedPencil& pencil, const Vector& x, const Vector& px);

  /// `towards`: the side of the shift to search, see shift_invert_lanczos.
  ShiftInvertResult lanczos(const ShiftedPencil& pencil, SpectrumEnd towards, Index wanted,
                            const ShiftInvertOptions& lanczos_options, const Vector& start, const Matrix& locked = {});

  /// Adds eigenvalues behind the end to the result, which stays converged if all are and a count proves the list.
  void list_behind();

 private:
  struct Added {
    bool any = false;            // whether the list has grown
    std::optional<double> seen;  // nearest to the shift, accurate or not
  };
  void polish(const ShiftedPencil& pencil);
  bool extend_list(const ShiftedPencil& pencil);
  Added add_to_list(const ShiftedPencil& pencil, Index wanted);
  double disturbance(const ShiftedPencil& pencil, const Vector& x, double lambda, const Matrix& locked,
                     const Vector& known);
  double just_outside(double lambda) const { return lambda - inward(1e-3 * lambda); }
};

}  // namespace nscdd
