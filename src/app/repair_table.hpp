// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/interruption.hpp"
#include <nscdd/study/study.hpp>

#include <string>

namespace nscdd::app {

/// What became of the rows that were not proved.
struct Redone {
  Index rows = 0;           ///< computed again
  Index not_converged = 0;  ///< of these, still not
  Index not_certified = 0;  ///< of these, converged but not certified where that was asked for
  Index left = 0;           ///< not reached before an interruption: they stay as they were
};

/// Goes through a finished table of the sweep `work` and computes the rows with converged = false again (with
/// --certify also those with certified = false), with the solver options of `work`; the others keep their
/// bytes. The file is replaced when all is done, or when `interruption` asks to stop after the row at hand.
/// Throws Error where the table is not one of this sweep on this case.
Redone redo_unproved(const Model& model, const StudyTable& work, const std::string& path,
                     Interruption& interruption);

}  // namespace nscdd::app
