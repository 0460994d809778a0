// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/one_metis.hpp"

namespace nscdd {

std::unique_lock<std::mutex> one_metis_at_a_time() {
  static std::mutex mutex;
  return std::unique_lock(mutex);
}

}  // namespace nscdd
