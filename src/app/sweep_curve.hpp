// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/tables.hpp"
#include "study/linear/curve.hpp"

namespace nscdd::app {

/// The table of curves: as that of a sweep, but the number of its rows is not known beforehand.
TableWork curve_work(const StudyTable& work, const CurveParameters& parameters);

/// Traces the curves and writes their rows, which `sink` takes too. Tells the user of curves that are not proved to the
/// tolerance; the exit code is then 1.
int trace(const Model& model, const CurveParameters& parameters, ResumableTable& csv, Interruption& interruption,
          const RowSink& sink);

/// Tells the user that an interrupted table of curves is given up, because it cannot be resumed; returns the exit code.
/// The table removes its files when it goes.
int leave_nothing(const std::string& path);

}  // namespace nscdd::app
