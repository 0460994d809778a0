// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/core/types.hpp>
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/model.hpp>

#include <complex>
#include <optional>
#include <string>
#include <vector>

namespace nscdd {

/// What to vary and how to solve: rows are the product of the lists, the last one running fastest.
struct SweepParameters {
  std::vector<double> epsilon{1.0};  ///< 1/kg, or multiples of the scale of the case
  std::vector<double> eta{infinity};
  /// Whether these are multiples of flexibility_scale of the case. Tables then have columns of them too.
  bool relative_epsilon = false, relative_eta = false;
  std::vector<std::optional<double>> relaxation{1.0};                  ///< empty: the optimal one
  std::vector<std::optional<long>> gauss_seidel_sweeps{std::nullopt};  ///< empty: exact Stage 1
  ContactSet contacts = ContactSet::all;
  SpectralOptions spectral = {};
};

/// One point of a sweep, which is one row of its table.
struct SweepPoint {
  double epsilon = 1.0;
  double eta = infinity;
  std::optional<double> relaxation;         ///< empty: the optimal one
  std::optional<long> gauss_seidel_sweeps;  ///< empty: exact Stage 1
};

/// Scale of eta and epsilon, 1/kg: mean_normal_delassus, or 1 without contacts, where no flexibility matters.
double flexibility_scale(const Model& model);

/// How many points a sweep has, and the one of row `number`, counted from 0, as it is asked for.
Index point_count(const SweepParameters& parameters);
SweepPoint sweep_point(const SweepParameters& parameters, Index number);

/// Columns of the coordinates of a point, which are known before anything is computed.
const ResultColumns<SweepPoint>& point_columns();

/// Data of a case that tables of spectra list besides its results.
struct CaseSummary {
  std::string name;
  Index grains = 0, contacts = 0;
  Index active_contacts = 0;  ///< that Stage 1 works with
  Index subdomains = 0;       ///< empty ones included
  Index interface_size = 0;   ///< n_Gamma
  ContactSet contact_set = ContactSet::all;
  std::string rule;  ///< how these contacts were chosen, see ContactChoice
};
const ResultColumns<CaseSummary>& case_columns();

/// What the choice of contacts makes of a model.
struct Selection {
  CaseSummary of_case;
  std::optional<Decomposition> restricted;  ///< to the contacts Stage 1 works with, unless these are all
  bool certain = true;                      ///< false where the impulses behind the choice were not found to 1e-8

  /// The decomposition that Stage 1 works with, of the model that the contacts were chosen in.
  const Decomposition& stage_one(const Model& model) const { return restricted ? *restricted : model.parts; }
};

/// Throws Error where the choice depends on impulses and no grain has an arriving velocity.
Selection select(const Model& model, ContactSet contacts);

/// What is found at a point of a sweep.
struct SweepResult {
  CaseSummary of_case;
  SweepPoint point;               ///< with the relaxation used, the optimal one where that was asked for
  SpectralRadius radius;          ///< with an inexact Stage 1 its ends are not known
  std::complex<double> dominant;  ///< eigenvalue of largest modulus; of a pair the one above the real axis
  SweepPoint asked = {};          ///< the point with its flexibilities as asked for, maybe relative
  double scale = 1;               ///< flexibility_scale of the case, 1/kg
};

/// Columns of the case and the point only; of relative flexibilities, if these are asked for; and of a whole row. They
/// are described in docs/formats.md. Columns of certificates, further eigenvalues and relative flexibilities come last.
const ResultColumns<SweepResult>& place_columns();
ResultColumns<SweepResult> relative_columns(const SweepParameters& parameters);
ResultColumns<SweepResult> sweep_columns(const SweepParameters& parameters = {});

/// Spectral radius at every point of a sweep from point `first` on. Points that do not converge have
/// radius.converged = false; returns how many there are. Stops early where the monitor asks for it. Results
/// do not depend on where a sweep starts.
Index sweep(const Model& model, const SweepParameters& parameters, const Sink<SweepResult>& sink,
            const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
