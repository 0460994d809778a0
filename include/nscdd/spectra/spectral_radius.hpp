// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/ddm/contraction.hpp>

namespace nscdd {

enum class SpectralSolver {
  automatic,     ///< dense up to `dense_limit` interface unknowns, shift-invert above; the others if these fail
  dense,         ///< both ends of the dense pencil (LAPACK)
  arpack,        ///< both ends by Lanczos on P^-1 S and S^-1 P, matrix-free (ARPACK)
  shift_invert,  ///< both ends by Lanczos on (S - sigma P)^-1 P from shifts beyond them
  slepc,         ///< Krylov-Schur of SLEPc, see SpectralOptions::slepc
};

constexpr auto names_of(SpectralSolver) {
  return std::to_array<std::string_view>({"auto", "dense", "arpack", "shift-invert", "slepc"});
}

struct SpectralOptions;
struct SpectralRadius;
/// An external solver for the ends of a spectrum. It sets the lists of a result (one eigenvalue each, empty if an end
/// was not found), modes, residual and counts; `spectral_radius` derives the rest.
using SpectrumSolver = std::function<SpectralRadius(const Contraction&, const SpectralOptions&)>;

struct SpectralOptions {
  Choice<SpectralSolver> solver = SpectralSolver::automatic;
  Index dense_limit = 800;  ///< for `automatic`
  double tolerance = 1e-8;  ///< largest residual / max(1, rho) that counts as converged
  Index eigenvalues = 1;    ///< at each end (`arpack` finds one)
  bool certify = false;     ///< prove by inertia counts that no eigenvalue was missed (dense, shift_invert)
  ArpackOptions arpack = {};
  InertiaMethod inertia = multifrontal();  ///< factorises and counts for shift_invert
  SpectrumSolver slepc = {};               ///< set by nscdd-mpi (nscdd/mpi/slepc.hpp)
  /// Called between products or solves of a matrix-free solver, between columns of a map made dense, and between the
  /// assembly of a dense pencil and its eigenvalues; may be empty. It runs in the caller's thread.
  std::function<void()> checkpoint = {};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("solver", self.solver,
          Field{.description =
                    "auto, dense, arpack, shift-invert, or slepc; auto: dense for small interfaces, else shift-invert; "
                    "arpack: matrix-free Lanczos; slepc: Krylov-Schur of SLEPc, by nscdd-mpi"});
    visit("residual_tolerance", self.tolerance,
          Field{.description = "largest residual that counts as converged", .above = 0});
    visit("certify", self.certify, Field{.description = "prove by inertia counts that no eigenvalue was missed"});
    visit("eigenvalues", self.eigenvalues,
          Field{.description = "eigenvalues at each end of the spectrum", .minimum = 1, .maximum = 100});
  }
};

/// Throws Error if arpack or slepc shall certify or find more than the ends. `dashes`: prefix of option names.
void check(const SpectralOptions& options, std::string_view dashes = "");

/// Throws Error for arpack and slepc with the scheme schwarz.
void require_solver_of(DecompositionScheme scheme, const SpectralOptions& options, std::string_view dashes = "");

struct SolverChoice {
  SpectralSolver solver = SpectralSolver::dense;  ///< never `automatic`
  std::vector<SpectralSolver> fallbacks = {};     ///< tried in this order if the one before has no proved answer
};

/// The solver of a pencil of `size` interface unknowns. `automatic` takes the dense pencil up to `dense_limit` unknowns
/// and shift-invert above. It falls back on the other of these two (dense up to `dense_fallback_limit`) and, if one
/// rank has all subdomains (`alone`), on ARPACK. Up to 4 unknowns, too few for Lanczos, every solver is dense.
SolverChoice choose_solver(Index size, const SpectralOptions& options, bool alone = true);

/// The solver of the unsymmetric map of an inexact Stage 1 with `size` unknowns: dense on request or, by `automatic`,
/// up to 400 unknowns; else ARPACK. `automatic` falls back on the other one, on dense up to 2 500 unknowns.
SolverChoice choose_inexact_solver(Index size, const SpectralOptions& options);

/// Largest dense pencil, in interface unknowns, after another solver has failed: bounds the waiting time.
inline constexpr Index dense_fallback_limit = 4000;

/// Largest S, in interface unknowns, of which the matrix-free solver computes the kernel densely in the rigid limit.
inline constexpr Index dense_kernel_limit = 4000;

/// Spectral radius of B with its certificate. Eigenvalues are real: 1 - omega lambda of the symmetric pencil (S, P).
struct SpectralRadius {
  double value = 0;                      ///< rho(B) = max(|eigenvalue_min|, |eigenvalue_max|); 0 for an empty interface
  double eigenvalue_min = not_a_number;  ///< smallest eigenvalue of B (NaN for an empty interface)
  double eigenvalue_max = not_a_number;  ///< largest eigenvalue of B
  Index unit_multiplicity = 0;  ///< of the eigenvalue 1 in the rigid limit, n_Gamma - rank X_0; 0 for epsilon > 0
  /// Largest modulus of the other eigenvalues, the rate of convergence on the complement of ker S; 0 if B = I.
  double subdominant = 0;
  double subdominant_min = not_a_number;  ///< ends of the spectrum without the unit eigenvalues
  double subdominant_max = not_a_number;
  /// "none" for an empty interface; without an answer all that were tried, "shift-invert+dense+arpack".
  std::string solver = "none";
  Index applications = 0;  ///< products with interface operators, or solves; 0 if they were assembled
  /// Maximum over both ends of omega ||S x - lambda P x||_{P^-1} / ||x||_P: an eigenvalue of B lies within this
  /// distance of each end given. For shift-invert: omega times the distance of the end from a shift with no eigenvalue
  /// beyond, so the end itself lies within it. The rigid limit adds InterfaceOperator::uncertainty.
  double residual = 0;
  bool converged = true;  ///< the solver converged, and residual <= tolerance x max(1, rho)
  /// If no solver answers: why each failed, such as "shift-invert: ...; dense: ...".
  std::string failure = {};

  std::vector<double> low, high;  ///< eigenvalues of B from each end inwards, without the unit eigenvalues
  bool certified = false;         ///< inertia counts leave no eigenvalue outside the intervals given
  std::array<double, 2> interval_min{not_a_number, not_a_number};  ///< holds subdominant_min
  std::array<double, 2> interval_max{not_a_number, not_a_number};  ///< holds subdominant_max
  /// Eigenvalues in these intervals, with multiplicity; in the rigid limit up to the error of S.
  Index within_min = 0, within_max = 0;
  Index factorisations = 0;   ///< of the shifted pencil
  Vector mode_min, mode_max;  ///< interface impulses (schwarz: resultants) of the two ends (empty if unknown)
};

struct SpectrumMemory;  // warm start of the next point of a sweep: spectra/spectrum_memory.hpp

/// Computes the spectral radius; see SpectralRadius::converged. In the rigid limit shift-invert counts unit eigenvalues
/// by ranks of H_E, above 10^6 contacts by shifts near 0; the matrix-free solver finds the unit eigenspace densely.
/// Throws Error for a list of no eigenvalues.
SpectralRadius spectral_radius(const Contraction& b, const SpectralOptions& options = {},
                               SpectrumMemory* memory = nullptr);

/// The spectrum `plain` (omega = 1) with another omega: 1 - omega (1 - mu) for its mu; unit eigenvalues stay.
SpectralRadius relaxed(const SpectralRadius& plain, double omega, double tolerance);

}  // namespace nscdd
