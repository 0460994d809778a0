// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "ddm/enriched_inertia.hpp"
#include <nscdd/core/table.hpp>
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/model.hpp>

namespace nscdd {

/// An end of the spectrum of B without the unit eigenvalues of the rigid limit.
enum class SpectrumSide {
  slowest,  ///< of larger modulus, which dominates the iteration in the end
  low,      ///< the smallest eigenvalue
  high,     ///< the largest eigenvalue
};

constexpr auto names_of(SpectrumSide) { return std::to_array<std::string_view>({"slowest", "low", "high"}); }

struct ModeParameters {
  double epsilon = 1.0;   ///< 1/kg; 0 is the rigid limit
  double eta = infinity;  ///< 1/kg
  Choice<ContactSet> contacts = ContactSet::all;
  Choice<SpectrumSide> side = SpectrumSide::slowest;
  SpectralOptions spectral = {};
  Choice<DecompositionScheme> scheme = DecompositionScheme::nscdd;
};

/// An eigenvector of the contraction operator, B F = mu F, with its velocities. Without loads the algorithm started
/// from F runs
///     Stage 1   (M_E + K_E / epsilon) V_E = - A_E^T F        ([ADI12] eqs. (9), (14) with F^d_E = 0)
///     Stage 2   F' = F + P^-1 sum_E A_E V_E = mu F
/// so that the jumps are sum_E A_E V_E = - S F = - lambda P F, lambda = (1 - mu) / omega with a relaxation omega.
/// F is normalised to F^T P F = 1 J, with its largest component positive (the first of those equal within 1e-6). If an
/// eigenvalue is multiple, F is one vector of its eigenspace: see `next`.
///
/// Of the scheme schwarz, F are the resultants p of contact impulses on the copies, J p = mu p, and `rows` has the
/// copies. V_E are the velocities under the sums o of the resultants of the other copies, and `jumps` those of the
/// copies. p is normalised to - o^T M_b^-1 p / mu = 1 J, which is r^T (D + epsilon) r of the impulses r. The residual
/// is ||J p - mu p|| in the norm of M_b^-1, over that of p.
struct Mode {
  SpectralRadius spectrum;
  Interface rows;                          ///< of F
  SpectrumSide side = SpectrumSide::high;  ///< `low` or `high`
  double eigenvalue = not_a_number;        ///< mu
  double next = not_a_number;              ///< the eigenvalue next to it, inwards; NaN unless the solver finds two
  double residual = not_a_number;          ///< omega ||S F - lambda P F||_{P^-1}
  /// `residual` is within tolerance and the contacts are certain. `spectrum.converged`: no other mode is further out.
  bool converged = true;
  Vector impulses;                 ///< F, n_Gamma, kg m/s; empty without a mode (`found`)
  Vector jumps;                    ///< sum_E A_E V_E, n_Gamma, m/s
  std::vector<Vector> velocities;  ///< V_E, d n_E each, m/s
  /// F_k^T (P F)_k of every gluing row block k, with the sum 1. Below 0 only if P couples rows.
  std::vector<double> shares;

  bool found() const { return impulses.size() > 0; }
};

/// The mode of one end of a contraction. `certain`: see ContactChoice.
Mode mode_of(const Contraction& b, SpectrumSide side, SpectralOptions options, bool certain = true);

/// The mode of one end; none for an empty interface, B = I or B = 0, or if the solver failed. Errors: choose_contacts.
Mode interface_mode(const Model& model, const ModeParameters& parameters);

/// The end of larger modulus, `low` or `high`.
SpectrumSide slowest_side(const SpectralRadius& spectrum);

/// The sign that makes the largest component of F positive, as in Mode. F must not be zero.
double mode_sign(const Vector& f);

/// The velocities of Stage 1 for many interface impulses F: V_E = - (M_E + K_E / epsilon)^-1 A_E^T F.
class StageOneAnswers {
 public:
  /// `parts` must outlive this.
  explicit StageOneAnswers(const Decomposition& parts) : parts_(parts), prepared_(parts.subdomains.size()) {}

  std::vector<Vector> velocities(double epsilon, const Vector& f);  ///< d n_E each, m/s; f: n_Gamma, kg m/s

 private:
  struct Prepared {
    EnrichedInertiaFamily family;
    std::optional<EnrichedInertia> inertia = {};  // for `epsilon`
    double epsilon = not_a_number;
  };
  const Decomposition& parts_;
  std::vector<std::unique_ptr<Prepared>> prepared_;  // of each subdomain
};

/// F scaled to F^T P F = 1 and its sign fixed, as in Mode. F must not be zero.
Vector normalised(const Vector& f, const InterfaceOperator& preconditioner);

/// The part of a mode on the interface between two subdomains.
struct InterfaceShare {
  Index first = 0, second = 0;  ///< subdomains, first < second; of copies the first is -1
  Index rows = 0;               ///< gluing row blocks between them
  double share = 0;             ///< sum of their shares
};

/// Shares of every interface between two subdomains, largest first. A grain of several counts for pairs glued together.
std::vector<InterfaceShare> shares_by_interface(const Mode& mode);

/// The number of row blocks over which the mode spreads: (sum |s_k|)^2 / sum s_k^2.
double spread(const Mode& mode);

/// A gluing row block of a mode: its impulse and jump, of bodies that turn without the part of rotations. This table
/// and the next one are empty without a mode (Mode::found).
struct ModeImpulse {
  const Model& model;
  const ModeParameters& parameters;
  const Mode& mode;
  Index number;  ///< of the row block

  const Gluing& gluing() const { return mode.rows.gluing()[at(number)]; }
};
ResultColumns<ModeImpulse> mode_impulse_columns(Index dimension = 2);
void mode_impulses(const Model& model, const ModeParameters& parameters, const Mode& mode,
                   const Sink<ModeImpulse>& sink);

/// The velocity of a copy of a grain, ordered by grain and subdomain. A grain without contacts has no copy.
struct ModeVelocity {
  const Model& model;
  Index grain, subdomain;
  std::array<double, 3> velocity;  ///< m/s, along z 0 in the plane
  double jump;                     ///< largest distance to the velocity of another copy
};
ResultColumns<ModeVelocity> mode_velocity_columns(Index dimension = 2);
void mode_velocities(const Model& model, const Mode& mode, const Sink<ModeVelocity>& sink);

}  // namespace nscdd
