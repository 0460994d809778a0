// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/simulate_output.hpp"

namespace nscdd::app {

/// A warning about steps whose boundaries may leave no room (no_room); empty if there are none.
std::string lack_of_room(const RunTotals& totals);

/// The report that ends a run, with its warnings.
std::string report_text(const RunTotals& totals, const Simulation& simulation, const RunOutcome& outcome);

}  // namespace nscdd::app
