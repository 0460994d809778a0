// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/shifted_pencil.hpp"
#include "linalg/krylov.hpp"

namespace nscdd {

/// A point of a sweep as the search for an end of the spectrum sees it.
struct PencilPoint {
  double epsilon = 1;
  double eta = infinity;
  Index kernel = 0;        ///< eigenvalues at the low end that are left out: the zeros of the rigid limit
  double low = 0;          ///< no other eigenvalue is below; >= 0
  double high = infinity;  ///< no eigenvalue is above
  /// Lost digits may move an eigenvalue by this times max(1, |lambda|). Certificates keep as far away.
  double rounding = 0;
};

/// Where an end is expected.
struct EndGuess {
  double value = 0;        ///< > 0
  double uncertainty = 0;  ///< >= 0
};

struct EndOptions {
  double tolerance = 1e-8;  ///< of lambda, times max(1, |1 - lambda|)
  Index eigenvalues = 1;    ///< wanted, from the end inwards
  bool certify = false;
  Index maximum_factorisations = 40;
  Index steps = 24;  ///< of Lanczos from one shift; after more, a closer shift is worth its factorisation
};

/// One end of the spectrum of (S, P).
struct PencilEnd {
  Vector values;   ///< from the end inwards; empty if none was found
  Matrix vectors;  ///< n_Gamma x k, interface impulses
  /// The end lies within this distance of the first value, and an eigenvalue within it of each other value.
  /// The distance is that between two proved bounds of the end: the first value, a Rayleigh quotient, is
  /// never beyond the end; and no eigenvalue lies beyond a certain shift, by an inertia count or by what is
  /// known beforehand. An estimate of the error of the solves is added.
  double residual = infinity;
  bool converged = false;  ///< residual <= tolerance, and no copy missing among the values
  /// Inertia counts prove that no eigenvalue lies beyond `outside`, and how many lie between it and `inside`.
  bool certified = false;
  double outside = not_a_number, inside = not_a_number;
  Index within = 0;  ///< eigenvalues between the two, with multiplicity
  /// d lambda / d log epsilon and d lambda / d log eta of the first value (Hellmann and Feynman).
  double slope_epsilon = 0, slope_eta = 0;
  Index factorisations = 0, solves = 0;
};

/// Finds one end of the spectrum from shifts beyond it that close in on it.
/// 1. Choose a shift beyond the expected end and factorise there. The inertia proves that no eigenvalue lies
///    further out; if some do, step out and begin again.
/// 2. Run shift-inverted Lanczos from this shift. If the end is not crowded, a few steps bring it to within a
///    fraction of the tolerance.
/// 3. Place the next shift a tenth of the tolerance beyond what was found. If no eigenvalue lies beyond that one
///    either, the end is proved, and one solve completes the vector. If some do, the end is among these few:
///    look for them from there, and repeat from step 2.
/// A crowded end costs some factorisations more, not thousands of products.
/// `start`: a vector to start from, or empty. What does not converge is data: see PencilEnd::converged.
PencilEnd find_end(const ShiftedPencilFamily& family, const InterfaceOperator& preconditioner, const PencilPoint& point,
                   SpectrumEnd end, const std::optional<EndGuess>& guess, const Vector& start,
                   const EndOptions& options);

/// One side of the spectrum at a point of a sweep: which way is inwards, how near is near enough, the factorisations
/// and solves, and what was found. The search for the end and the list of eigenvalues behind it share it.
struct PencilSide {
  const ShiftedPencilFamily& family;
  const InterfaceOperator& p;
  const PencilPoint& point;
  const SpectrumEnd end;
  const EndOptions& options;
  SolutionAccuracy accuracy = SolutionAccuracy::enough_next_to_an_end;
  PencilEnd result = {};

  /// Signed so that inwards is positive at both ends.
  double inward(double difference) const { return end == SpectrumEnd::smallest ? difference : -difference; }

  /// Of lambda. It is relative if |1 - lambda|, an eigenvalue of B, is above 1.
  double tolerance(double lambda) const { return options.tolerance * std::max(1.0, std::abs(1 - lambda)); }
  double rounding(double lambda) const { return point.rounding * std::max(1.0, std::abs(lambda)); }

  /// How far beyond an eigenvalue the last shift is placed. Within the rounding of the matrix a count would say
  /// nothing. A tenth of the tolerance, because a relaxation multiplies the distance to give its residual.
  double margin(double lambda) const { return std::max(0.1 * tolerance(lambda), 2 * rounding(lambda)); }

  /// The pencil at the shift, or at one nearby whose factorisation can be relied on; none if there is no such
  /// shift. `side`: which way to step from an unreliable one, inwards (1) or outwards (-1).
  std::optional<ShiftedPencil> factorise(double shift, double side = -1);

  /// Eigenvalues beyond the shift.
  Index beyond(const ShiftedPencil& pencil) const {
    return end == SpectrumEnd::smallest ? pencil.below() - point.kernel : p.rows() - pencil.below();
  }

  ShiftedPencil::Response respond(const ShiftedPencil& pencil, const Vector& g) {
    return ++result.solves, pencil.respond(g);
  }

  /// `towards`: the side of the shift that is looked at, see shift_invert_lanczos.
  ShiftInvertResult lanczos(const ShiftedPencil& pencil, SpectrumEnd towards, Index wanted,
                            const ShiftInvertOptions& lanczos_options, const Vector& start, const Matrix& locked = {});

  /// Adds to the result, which has the end, the eigenvalues behind it, as many as the options want, from a shift far
  /// enough out to see them all. The result stays converged if they all are and a count proves that none is missing.
  void list_behind();

 private:
  struct Added {
    bool any = false;            // whether the list has grown
    std::optional<double> seen;  // the eigenvalue nearest to the shift, accurate or not
  };
  void polish(const ShiftedPencil& pencil);
  bool extend_list(const ShiftedPencil& pencil);
  Added add_to_list(const ShiftedPencil& pencil, Index wanted);
  double disturbance(const ShiftedPencil& pencil, const Vector& x, double lambda, const Matrix& locked,
                     const Vector& known);
  double just_outside(double lambda) const { return lambda - inward(1e-3 * lambda); }
};

}  // namespace nscdd
