// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/pencil_end.hpp"

#include <array>
#include <optional>
#include <vector>

namespace nscdd {

/// What one point of a sweep leaves to the next: the elimination order of the shifted pencil, and the ends found last
/// with their vectors, from which the next are extrapolated. Saves work; changes results within their residuals only.
struct PencilMemory {
  struct End {
    double lambda = 0, slope_epsilon = 0, slope_eta = 0;  ///< d lambda / d log epsilon, d lambda / d log eta
    Vector vector;
  };
  struct Visited {
    double epsilon = 0, eta = 0;
    End smallest, largest;
  };
  std::array<std::optional<ShiftedPencilFamily>, 2> families;  ///< for a finite and for the infinite eta
  std::vector<Visited> visited;                                ///< the last two, newest last

  /// Where one end of the spectrum is expected at a point, on logarithmic axes: by Taylor's formula from the
  /// slopes at the last point visited, and if the two last points and this one differ in epsilon alone or in
  /// eta alone, by Hermite's cubic through both. None if nothing was visited.
  std::optional<EndGuess> expected(const PencilPoint& point, End Visited::*end) const;
};

/// What the rigid limit of an operator S is worked out from, whatever eta.
struct RigidLimit {
  InterfaceOperator met;        ///< S as it was asked for
  InterfaceOperator regular;    ///< the same on contacts that are independent within their subdomain
  std::optional<Index> kernel;  ///< dim ker S, where it is known
  bool confirmed = true;        ///< an inertia count of `regular` next to 0 agrees with it
};

/// Interface impulses at the two ends of (S, P) that the matrix-free solver found last; empty where there are none.
struct MatrixFreeMemory {
  Vector smallest, largest;
};

struct Continuation {
  PencilMemory flexible, rigid;  ///< of epsilon > 0, and of the rigid limit
  MatrixFreeMemory matrix_free;
  std::optional<RigidLimit> limit;
  void forget_ends() {  ///< what is known of the contacts stays
    flexible.visited.clear();
    rigid.visited.clear();
    matrix_free = {};
  }
};

}  // namespace nscdd
