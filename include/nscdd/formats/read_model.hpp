// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/model.hpp>

namespace nscdd {

/// The model of a case file with overrides of its keys, as `--set`: {"packing.grains", "8"}. Throws Error "file:line:
/// key: expected ..., met ..." for a case that cannot be read or built or must be settled by a simulation.
Model read_model(const std::string& case_file, const std::vector<std::pair<std::string, std::string>>& overrides = {});

}  // namespace nscdd
