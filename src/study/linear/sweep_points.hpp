// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// The point with its flexibilities in 1/kg. `scale`: flexibility_scale of the case.
SweepPoint at_scale(SweepPoint point, const SweepParameters& parameters, double scale);

/// Fills in what follows at a point with an exact Stage 1 from the spectrum at omega = 1: the optimal relaxation where
/// that is asked for, the radius under the relaxation, and the dominant eigenvalue.
void set_exact(SweepResult& result, const SpectralRadius& plain, double tolerance);

inline constexpr std::string_view uncertain_choice = "the impulses that choose the contacts were not found to 1e-8";

/// A radius of contacts whose choice is uncertain proves nothing: it counts as not converged.
void withdraw_if_uncertain(SpectralRadius& radius, const Selection& selection);

/// The selection for a choice of contacts that was made before, and its sweep. `parameters.contacts` is that of it.
Selection select(const Model& model, ContactSet contacts, const ContactChoice& choice);
Index sweep(const Model& model, const Selection& selection, const SweepParameters& parameters,
            const Sink<SweepResult>& sink, const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
