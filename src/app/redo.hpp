// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/study.hpp>

#include <string>

namespace nscdd::app {

/// Goes through a finished table of the sweep `work` and computes the rows with converged = false again, with
/// the solver options of `work`; the others keep their bytes. The file is replaced when all is done. Throws
/// Error where the table is not one of this sweep on this case. Returns how many rows are still not
/// converged.
Index redo_unproved(const Model& model, const StudyTable& work, const std::string& path);

}  // namespace nscdd::app
