// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "files/resumable_table.hpp"
#include "study/study.hpp"

namespace nscdd {

/// What the rows of a table of a study come from.
WorkIdentity work_identity(const StudyTable& table);

/// The table as a resumable file takes it. `table` must outlive the result.
TableWork table_work(const StudyTable& table);

}  // namespace nscdd
