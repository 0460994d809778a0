// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/case.hpp>
#include <nscdd/study/study.hpp>

#include <functional>
#include <string>
#include <string_view>

namespace nscdd {

/// Reads a packing named in a case file; the path is as written there.
using PackingReader = std::function<Packing(const std::string& path)>;

/// Reads a contact problem named in a case file; the path is as written there.
using ProblemReader = std::function<GlobalFrictionProblem(const std::string& path)>;

/// Settles the case named in a case file ([packing] settled = "..."), the name as written there.
using SettledReader = std::function<SettledPacking(const std::string& name)>;

/// Finds the case named in a study file ("disks4", or a path) and reads it.
/// `large`: the table it is for is run only where large tables are asked for.
using CaseReader = std::function<Case(const std::string& name, bool large)>;

/// A case from the text of a case file. Strict: an unknown key, a wrong type, a missing section or a value
/// out of its bounds throws Error "file:line: key: expected ..., met ...". Without a reader for it, a settled
/// packing or a contact problem is refused.
Case parse_case(std::string_view text, const std::string& file, const PackingReader& read,
                const SettledReader& settle = {}, const ProblemReader& read_problem = {});

/// A case from a file, named by its stem; a packing file or contact problem is looked for beside it.
Case read_case(const std::string& path, const SettledReader& settle = {});

/// A study from the text of a study file, as strict.
Study parse_study(std::string_view text, const std::string& file, const CaseReader& read);

}  // namespace nscdd
