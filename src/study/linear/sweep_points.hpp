// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case.hpp"
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// The point with its flexibilities in 1/kg. `scale`: flexibility_scale of the case.
SweepPoint at_scale(SweepPoint point, const SweepParameters& parameters, double scale);

/// Sets the result with an exact Stage 1 from the spectrum at omega = 1: the relaxation if the optimal one is asked
/// for, the radius with the relaxation, and the dominant eigenvalue.
void set_exact(SweepResult& result, const SpectralRadius& plain, double tolerance);

inline constexpr std::string_view uncertain_choice = "the impulses that choose the contacts were not found to 1e-8";

/// Makes a radius count as not converged if the choice of contacts is uncertain.
void withdraw_if_uncertain(SpectralRadius& radius, const Selection& selection);

/// The selection of a choice of contacts, and its sweep with the same `parameters.contacts`.
Selection select(const Model& model, ContactSet contacts, const ContactChoice& choice);
Index sweep(const Model& model, const Selection& selection, const SweepParameters& parameters,
            const Sink<SweepResult>& sink, const Monitor& monitor = {}, Index first = 0);

/// Remarks on relaxations of the scheme schwarz with which it may not converge. Its eigenvalues at relaxation 1 are
/// above 1 - q with q copies of a body, where epsilon is 0 also 1 - q.
std::vector<std::string> remarks_on(const Model& model, const SweepParameters& sweep);

/// The model of a case, with these remarks for whoever takes remarks on the case.
Model built_for(const SweepParameters& sweep, const Case& one);

}  // namespace nscdd
