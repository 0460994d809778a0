// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/strict_toml.hpp"
#include "simulation/dynamics.hpp"

#include <optional>

namespace nscdd {

/// The sections [dynamics], [interaction], [solver] and [[boundary]] of a case file. Without [dynamics] the
/// result is empty, and any of the other sections throws Error.
std::optional<Dynamics> read_dynamics(StrictTable& root);

}  // namespace nscdd
