// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "linalg/shift_invert_lanczos.hpp"
#include <nscdd/ddm/shifted_pencil.hpp>

#include <optional>

namespace nscdd {

/// A point of a sweep as the search for an end of the spectrum sees it.
struct PencilPoint {
  double epsilon = 1;
  double eta = infinity;
  Index kernel = 0;        ///< eigenvalues at the low end that do not count (the rigid limit's zeros)
  double low = 0;          ///< no other eigenvalue is below; >= 0
  double high = infinity;  ///< no eigenvalue is above
  /// What lost digits may move an eigenvalue by, times max(1, |lambda|): certificates keep away as far.
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
  Index steps = 24;        ///< of Lanczos from one shift, after which a closer one is worth its factorisation
  Index list_steps = 300;  ///< the same where several eigenvalues are wanted
};

/// One end of the spectrum of (S, P).
struct PencilEnd {
  Vector values;   ///< from the end inwards; empty where nothing was found
  Matrix vectors;  ///< n_Gamma x k, interface impulses
  /// The end lies within this distance of the first value, and an eigenvalue of each other one. A Rayleigh
  /// quotient is never beyond the end, and an inertia count (or what is known before) leaves no eigenvalue
  /// beyond a shift: the distance is that between the two, plus an estimate of the error of the solves.
  double residual = infinity;
  bool converged = false;  ///< residual <= tolerance, and no copy missing among the values
  /// Inertia counts found every eigenvalue beyond `outside` and those of the list up to `inside`.
  bool certified = false;
  double outside = not_a_number, inside = not_a_number;
  Index within = 0;  ///< eigenvalues between the two, with multiplicity
  /// d lambda / d log epsilon and d lambda / d log eta of the first value (Hellmann and Feynman).
  double slope_epsilon = 0, slope_eta = 0;
  Index factorisations = 0, solves = 0;
};

/// Finds one end by shift-inverted Lanczos from shifts beyond it that close in on it: each factorisation says
/// by its inertia whether the shift is beyond the end. From the first, a few Lanczos steps bring the end to
/// within a fraction of the tolerance where it is not crowded; the next shift is placed a tenth of the
/// tolerance beyond what they found. If its count says that nothing was passed over, the end is proved, and
/// one solve completes the vector; if not, what lies beyond is looked for from there. Crowded ends cost
/// factorisations, not thousands of products. `start`: a vector to start from, or empty. Never throws for
/// what does not converge.
PencilEnd find_end(const ShiftedPencilFamily& family, const InterfaceOperator& preconditioner,
                   const PencilPoint& point, SpectrumEnd end, const std::optional<EndGuess>& guess,
                   const Vector& start, const EndOptions& options);

}  // namespace nscdd
