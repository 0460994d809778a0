// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/lead_in.hpp"

namespace nscdd::app {

/// Words about steps whose boundaries may leave no room, see no_room; empty if there is none.
std::string lack_of_room(const RunTotals& totals);

/// The lines at the end of a run, among them warnings that a reader of the numbers must know.
std::string report_text(const RunTotals& totals, const Simulation& simulation, const RunOutcome& outcome);

}  // namespace nscdd::app
