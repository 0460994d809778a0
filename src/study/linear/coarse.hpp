// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/linear/coarse_table.hpp"

namespace nscdd {

/// Every method at every epsilon > 0 of the sweep, from row `first` on. Returns how many did not converge. Throws Error
/// for an interface of one subdomain, for epsilon = 0, and if a proved bound is not kept (an error of nscdd). Several
/// ranks compute X, X_eta and bddc only, without factors of the undivided packing and of the interface.
Index coarse_spaces(const Model& model, const SweepParameters& sweep, const CoarseParameters& parameters,
                    const Sink<CoarseResult>& sink, const Monitor& monitor = {}, Index first = 0);

}  // namespace nscdd
