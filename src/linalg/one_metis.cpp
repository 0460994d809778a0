// SPDX-License-Identifier: GPL-3.0-or-later
#include "linalg/one_metis.hpp"

#include <cstdlib>

namespace nscdd {
namespace {

std::mutex& metis_mutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

OneMetis::OneMetis() : lock_(metis_mutex()), before_(initstate(1, state_.data(), state_.size())) {}
OneMetis::~OneMetis() { setstate(before_); }

}  // namespace nscdd
