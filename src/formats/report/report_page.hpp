// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/report/problem_report.hpp"
#include "formats/report/run_report.hpp"
#include "study/linear/packing_report.hpp"

/// The pages of `nscdd report`: self-contained HTML files. docs/formats.md describes their data.
namespace nscdd {

struct PageOrigin {
  std::string name;          ///< of the case
  std::string command_line;  ///< of `nscdd report`
  std::string case_text;     ///< the resolved case, as a case file
  std::string libraries;     ///< a line for each, with its version
};

/// `problem`: of a contact problem, null for a packing.
std::string packing_page(const Model& model, const PackingReport& report, const ProblemReport* problem,
                         const PageOrigin& origin);
std::string run_page(const RunReport& report, const PageOrigin& origin);

}  // namespace nscdd
