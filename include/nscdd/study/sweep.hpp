// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/model.hpp>

#include <complex>

namespace nscdd {

/// The lists of a sweep and how to solve. Rows are the product of the lists, the last one running fastest.
struct SweepParameters {
  std::vector<double> epsilon{1.0}, eta{infinity};      ///< 1/kg, or multiples of flexibility_scale of the case
  bool relative_epsilon = false, relative_eta = false;  ///< whether multiples, for which tables have further columns
  std::vector<std::optional<double>> relaxation{1.0};   ///< empty: the optimal one
  std::vector<std::optional<long>> gauss_seidel_sweeps{std::nullopt};  ///< empty: exact Stage 1
  Choice<ContactSet> contacts = ContactSet::all;
  SpectralOptions spectral = {};
  Choice<DecompositionScheme> scheme = DecompositionScheme::nscdd;

  bool schwarz() const { return scheme == DecompositionScheme::schwarz; }
};

/// Throws Error if the scheme schwarz, which has no Stage 2, meets an eta, or a solver that does not know it, and if an
/// inexact Stage 1 meets the optimal relaxation, certified ends or several eigenvalues. `dashes` precede option names.
void check_sweep(const SweepParameters& parameters, std::string_view dashes = "");

/// One point of a sweep, which is one row of its table.
struct SweepPoint {
  double epsilon = 1.0;
  double eta = infinity;
  std::optional<double> relaxation = {};         ///< empty: the optimal one
  std::optional<long> gauss_seidel_sweeps = {};  ///< empty: exact Stage 1
};

/// Scale of eta and epsilon, 1/kg: mean_normal_delassus, or 1 without contacts, where no flexibility matters.
double flexibility_scale(const Model& model);

/// The number of points of a sweep, and the point of row `number`, from 0, in the units asked for.
Index point_count(const SweepParameters& parameters);
SweepPoint sweep_point(const SweepParameters& parameters, Index number);

ResultColumns<SweepPoint> point_columns();

/// Data of a case in tables of spectra.
struct CaseSummary {
  std::string name;
  Index grains = 0, contacts = 0;
  Index active_contacts = 0;  ///< of Stage 1
  Index subdomains = 0;       ///< empty ones included
  Index interface_size = 0;   ///< n_Gamma
  ContactSet contact_set = ContactSet::all;
  std::string rule;  ///< how these contacts were chosen, see ContactChoice
};
ResultColumns<CaseSummary> case_columns();

/// A model with a choice of contacts for Stage 1.
struct Selection {
  CaseSummary of_case;
  std::optional<Decomposition> restricted;  ///< to the contacts of Stage 1, unless these are all
  bool certain = true;                      ///< false if the impulses behind the choice were not found to 1e-8

  /// The decomposition of Stage 1. `model`: that of the choice.
  const Decomposition& stage_one(const Model& model) const { return restricted ? *restricted : model.parts; }
};

/// Throws Error as choose_contacts.
Selection select(const Model& model, ContactSet contacts);

/// The result at a point of a sweep.
struct SweepResult {
  CaseSummary of_case;
  SweepPoint point;               ///< with flexibilities in 1/kg and the relaxation used
  SpectralRadius radius;          ///< with an inexact Stage 1 without the ends of the spectrum
  std::complex<double> dominant;  ///< eigenvalue of largest modulus; of a pair the one above the real axis
  SweepPoint asked = {};          ///< the point in the units asked for
  double scale = 1;               ///< flexibility_scale of the case, 1/kg
};

/// Columns of the case and the point; of relative flexibilities and of the scheme schwarz, if asked for; and of a whole
/// row (docs/formats.md), those of certificates, further eigenvalues and what is asked for last.
ResultColumns<SweepResult> place_columns();
ResultColumns<SweepResult> asked_columns(const SweepParameters& parameters);
ResultColumns<SweepResult> sweep_columns(const SweepParameters& parameters = {});

/// Computes the spectral radius at every point of a sweep from point `first` on; results do not depend on it. Returns
/// the number of points that did not converge (radius.converged). The monitor may stop it.
Index sweep(const Model& model, const SweepParameters& parameters, const Sink<SweepResult>& sink,
            const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
