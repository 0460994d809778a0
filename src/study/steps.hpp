// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/study.hpp"

namespace nscdd {

/// Hands the results of every one of the steps of a table on as rows. `observe` hands over those of one step
/// (examined or done, see Observable::first_step) and returns how many of them are not known.
template <class Result>
Index each_step(const ObservedCase& work, const ResultColumns<Result>& columns,
                Index (*observe)(const ObservedCase& work, Index step, const Sink<Result>& sink)) {
  const std::vector<Index>& steps = work.table.steps;
  const Sink<Result> sink = as_rows(columns, work.sink);
  Index failed = 0;
  for (Index k = work.first; k < count(steps); ++k) {
    failed += observe(work, steps[at(k)], sink);
    if (work.table.observable->rows != nullptr && !report(work.monitor, k + 1, count(steps))) break;
  }
  return failed;
}

/// The case of a table after some steps.
inline Simulation simulation_at(const ObservedCase& work, Index steps) {
  return work.lead_in.at(work.one, steps, work.table.lead_in).simulation;
}

}  // namespace nscdd
