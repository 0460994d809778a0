// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "run_program.hpp"
#include "study/tables/study.hpp"
#include <nscdd/core/table.hpp>

#include <string>

namespace nscdd::testing {

/// A study of the source tree, its cases taken from its own folder or from cases/.
Study read_study(const std::string& name);

/// Table `number` of a study as its baseline file has it.
std::string baseline_path(const Study& study, std::size_t number);

/// Every row of a study table.
Table run(StudyTable definition);

}  // namespace nscdd::testing
