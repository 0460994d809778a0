// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/table.hpp>
#include <nscdd/study/case.hpp>
#include <nscdd/study/lead_in.hpp>
#include <nscdd/study/sweep.hpp>

#include <vector>

namespace nscdd {

/// A place on the way of a case, and how to get there.
struct Place {
  Index steps = 0;  ///< done
  LeadInSolver solver = LeadInSolver::plain;
};

/// Indicators of the iterations of the step after a place, one row each: all up to the twentieth, then about
/// forty per decade, and the last. Figures 9 and 11 of [ADI12].
std::vector<Column> indicator_columns();
void indicator_rows(const Case& one, Place before, LeadIn& lead_in, const RowSink& sink);

/// Disks at a place, one row each, and the contacts that carry an impulse in the step after it: Figures 8
/// and 10.
std::vector<Column> configuration_columns();
void configuration_rows(const Case& one, Place place, LeadIn& lead_in, const RowSink& sink);
std::vector<Column> chain_columns();
void chain_rows(const Case& one, Place place, LeadIn& lead_in, const RowSink& sink);

/// A run of `steps` steps with the solver of the case: iterations, residuals, and how far it has taken the
/// free disks from where plain Gauss-Seidel (LeadInSolver::plain) takes them. One row.
std::vector<Column> run_columns();
void run_row(const Case& one, Index steps, LeadIn& lead_in, const RowSink& sink);

/// Predicted beside observed rate of the step after a place, one row; returns whether both are known.
std::vector<Column> predicted_observed_columns();
bool predicted_observed_row(const Case& one, Place before, LeadIn& lead_in, const RowSink& sink);

}  // namespace nscdd
