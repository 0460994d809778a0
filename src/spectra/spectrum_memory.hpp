// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "spectra/pencil_end.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

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
  InterfaceOperator met;  ///< S as it was asked for
  std::shared_ptr<const RigidSystem> system;
  std::optional<Index> kernel;  ///< dim ker S, where it is known
  bool confirmed = true;        ///< an inertia count of `system` next to 0 agrees with it
};

/// What one point of a sweep leaves to the next.
struct SpectrumMemory {
  PencilMemory flexible, rigid;  ///< of epsilon > 0, and of the rigid limit
  Vector smallest, largest;      ///< interface impulses at the ends that the matrix-free solver found last, or empty
  std::optional<RigidLimit> limit;

  void forget_ends() {  ///< what is known of the contacts stays
    flexible.visited.clear();
    rigid.visited.clear();
    smallest = largest = {};
  }
};

/// Both ends by shift-invert and from the dense pencil, for omega = 1. The other solvers, and the choice of one, are in
/// spectral_radius.cpp.
SpectralRadius shift_invert_radius(const Contraction& b, const SpectralOptions& options, SpectrumMemory& memory);
SpectralRadius dense_radius(const Contraction& b, const SpectralOptions& options);

/// Fills in everything that follows from the two ends of the spectrum of B outside ker S.
void set_ends(SpectralRadius& result, double mu_min, double mu_max, Index unit_multiplicity);

/// A spectrum of which nothing is known, and why.
SpectralRadius not_converged(std::string_view solver, std::string_view failure, Index unit_multiplicity = 0);
SpectralRadius all_unit(Index size, std::string_view solver, bool converged);  ///< S = 0, B = I

/// Error of an eigenvalue lambda = 1 - mu in units of max(1, |lambda|): digits of M are lost beside K/epsilon
/// and K/eta. The bound is several times the largest error seen against dense spectra (tests/laws).
inline double lost_to_rounding(const Contraction& b) {
  const double lightest = 0.25 * b.system.scale().maxCoeff(), epsilon = b.system.flexibility();  // 1/mass, 1/kg
  return 4e-16 * (1 + (epsilon > 0 ? lightest / epsilon : 0) + lightest / b.preconditioner.flexibility());
}

/// By how much an eigenvalue lambda of (S, P) may be off where S is the rigid limit and uncertain by t, in units of
/// X_infinity (InterfaceOperator::uncertainty): |sqrt(lambda') - sqrt(lambda)| <= t sqrt(x), because f^T S f is a
/// squared length that changes by t^2 f^T X_infinity f at most, and x = 1 + L / eta bounds X_infinity over P = X_eta, L
/// the largest eigenvalue of all M_E^-1 K_E.
double moved_by(double t, double lambda, const InterfaceOperator& p);

inline bool accurate(const SpectralRadius& radius, double tolerance) {
  return radius.residual <= tolerance * std::max(1.0, radius.value);
}

}  // namespace nscdd
