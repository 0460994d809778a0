// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

namespace nscdd::testing {

/// Whether HDF5 has the error handler that was set before `work` afterwards, too.
bool keeps_error_handler(const std::function<void()>& work);

}  // namespace nscdd::testing
