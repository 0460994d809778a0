// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "files/hdf5.hpp"
#include "study/case.hpp"

#include <vector>

namespace nscdd::app {

/// Versions, command line and the resolved cases, for a result file. Nothing in it changes from run to run.
Provenance provenance(const Context& context, const std::vector<Case>& cases);

}  // namespace nscdd::app
