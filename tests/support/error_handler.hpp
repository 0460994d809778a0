// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace nscdd::testing {

/// Whether HDF5 has the same error handler after `work` as before.
bool keeps_error_handler(const std::function<void()>& work);

}  // namespace nscdd::testing
