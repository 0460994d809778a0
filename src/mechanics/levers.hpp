// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/step_contacts.hpp"

namespace nscdd {

/// The levers of a contact with a body with free directions; null for others. Tangential impulses that move nothing are
/// left out: their rows are 0, see Levers::rubs. Throws Error naming both bodies if W is singular in another way and
/// there is friction.
template <int D>
std::shared_ptr<const Levers<D>> levers_of(const StepStart& start, const Configuration& where,
                                           const StepContact& contact);

/// A lever on spins in place of the speeds of rims of these lengths.
template <int D>
Lever<D> on_spins(Lever<D> lever, const std::array<double, 3>& rims);

/// Relative velocity of a contact by the driven unknowns of bodies with free directions.
template <int D>
LocalVector<D> driven_part(const GrainContact<D>& contact, const std::vector<GrainVelocity<D>>& bodies);

}  // namespace nscdd
