// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/study/modes.hpp>
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// A mode as two tables, which plots/modes.py draws; columns are described in docs/formats.md. Without a mode
/// (Mode::found) they have no rows.
/// Interface impulses: one row per gluing row block.
std::vector<Column> mode_impulse_columns();
void mode_impulse_rows(const Model& model, const ModeParameters& parameters, const Mode& mode,
                       const RowSink& sink);

/// Grain velocities: one row per copy of a grain, ordered by grain and subdomain. A grain that touches
/// nothing has no copy.
std::vector<Column> mode_velocity_columns();
void mode_velocity_rows(const Model& model, const Mode& mode, const RowSink& sink);

}  // namespace nscdd
