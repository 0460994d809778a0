// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/study/case.hpp>
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// Links of the contact network with the impulses of the linear rigid problem (NaN without a prescribed
/// velocity), one row per contact: what Figures 2-4 draw. Columns are described in docs/formats.md.
std::vector<Column> link_columns();
void link_rows(const Model& model, const RowSink& sink);

/// Grains with their multiplicity and prescribed velocity, one row each.
std::vector<Column> grain_columns();
void grain_rows(const Model& model, const RowSink& sink);

/// Grains by size, ten classes of radii, one row each.
std::vector<Column> size_columns();
void size_rows(const Model& model, const RowSink& sink);

}  // namespace nscdd
