// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <mutex>

namespace nscdd {

/// METIS draws from the C library's random numbers, which the whole process shares: orderings found at the
/// same time would disturb each other, and results depend on timing. Held around every call that may reach
/// METIS.
std::unique_lock<std::mutex> one_metis_at_a_time();

}  // namespace nscdd
