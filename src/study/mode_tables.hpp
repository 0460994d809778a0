// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/modes.hpp"
#include <nscdd/core/table.hpp>

#include <array>

namespace nscdd {

/// A mode as two tables, which plots/modes.py draws; columns are described in docs/formats.md. Without a mode
/// (Mode::found) both are empty. Both throw Error for a contact problem, of which no geometry is known.

/// A gluing row block of a mode: an interface impulse and the jump that it meets.
struct ModeImpulse {
  const Model& model;
  const ModeParameters& parameters;
  const Mode& mode;
  Index number;  ///< of the row block

  const Gluing& gluing() const { return model.parts.interface.gluing()[at(number)]; }
};
const ResultColumns<ModeImpulse>& mode_impulse_columns();
void mode_impulses(const Model& model, const ModeParameters& parameters, const Mode& mode,
                   const Sink<ModeImpulse>& sink);

/// The velocity of one copy of a grain, ordered by grain and subdomain. A grain that touches nothing has no
/// copy.
struct ModeVelocity {
  const Model& model;
  Index grain, subdomain;
  std::array<double, 2> velocity;
  double jump;  ///< largest distance to the velocity of another copy
};
const ResultColumns<ModeVelocity>& mode_velocity_columns();
void mode_velocities(const Model& model, const Mode& mode, const Sink<ModeVelocity>& sink);

}  // namespace nscdd
