// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/study/case.hpp>
#include <nscdd/study/sweep.hpp>

namespace nscdd {

/// Links of the contact network with the impulses behind a choice of contacts (NaN without an arriving
/// velocity), one row per contact: what Figures 2-4 draw. ContactSet::all shows those of the linear rigid
/// problem, as ContactSet::active does. Columns are described in docs/formats.md. Returns the choice.
std::vector<Column> link_columns(ContactSet contacts = ContactSet::active);
ContactChoice link_rows(const Model& model, const RowSink& sink, ContactSet contacts = ContactSet::active);

/// Grains with their multiplicity and prescribed velocity, one row each.
std::vector<Column> grain_columns();
void grain_rows(const Model& model, const RowSink& sink);

/// Grains by size, ten classes of radii, one row each.
std::vector<Column> size_columns();
void size_rows(const Model& model, const RowSink& sink);

}  // namespace nscdd
