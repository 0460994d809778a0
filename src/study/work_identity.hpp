// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/study.hpp>

#include <string>

namespace nscdd {

/// Everything that the rows of a table come from, as texts to be compared: equal records give equal rows (on
/// one machine; from one processor to another the BLAS may round otherwise).
struct WorkIdentity {
  std::string version;  ///< of the program, its build and the libraries
  std::string cases;    ///< resolved, with the content of packing files: their paths do not count
  std::string options;  ///< which points: columns, values of the lists, contacts, seed
  std::string effort;   ///< how hard each point is worked on: solver, tolerances, limits
};

WorkIdentity work_identity(const StudyTable& table);

/// First difference as "the options differ: expected ..., met ...", or "" where there is none.
std::string difference(const WorkIdentity& expected, const WorkIdentity& met);

}  // namespace nscdd
