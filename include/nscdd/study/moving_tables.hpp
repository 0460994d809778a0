// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/monitor.hpp>
#include <nscdd/core/table.hpp>
#include <nscdd/study/case.hpp>
#include <nscdd/study/simulation.hpp>
#include <nscdd/study/sweep.hpp>

#include <map>
#include <string>
#include <vector>

namespace nscdd {

/// States of cases on the way, kept so that variants of the solver of a step start from the same one. The
/// steps before are solved by plain Gauss-Seidel, warm-started, to zeta <= 1e-6 or 2 000 sweeps, whatever the
/// solver of the case.
class LeadIn {
 public:
  /// The simulation of a case after `steps` steps, with the solver of the case. Throws Error for a case that
  /// is not made to move and where a step on the way breaks down.
  Simulation at(const Case& one, Index steps, const Monitor& monitor = {});

 private:
  std::map<std::string, Simulation> known_;  // by the case without its solver
};

/// Indicators of the iterations of step `step` (from 1), one row each: all up to the twentieth, then about
/// forty per decade, and the last. Figures 9 and 11 of [ADI12].
std::vector<Column> indicator_columns();
void indicator_rows(const Case& one, Index step, LeadIn& lead_in, const RowSink& sink,
                    const Monitor& monitor = {});

/// Disks after given numbers of steps, one row each, and the contacts that carry an impulse: Figures 8
/// and 10.
std::vector<Column> configuration_columns();
void configuration_rows(const Case& one, const std::vector<Index>& steps, LeadIn& lead_in,
                        const RowSink& sink, const Monitor& monitor = {});
std::vector<Column> chain_columns();
void chain_rows(const Case& one, const std::vector<Index>& steps, LeadIn& lead_in, const RowSink& sink,
                const Monitor& monitor = {});

/// Predicted beside observed rate of step `step`, one row per case; returns whether both are known.
std::vector<Column> predicted_observed_columns();
bool predicted_observed_row(const Case& one, Index step, LeadIn& lead_in, const RowSink& sink,
                            const Monitor& monitor = {});

}  // namespace nscdd
