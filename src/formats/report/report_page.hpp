// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "formats/report/run_report.hpp"
#include "study/linear/packing_report.hpp"

/// The pages of `nscdd report`: one HTML file each with its style, its program and its data, which asks for nothing
/// else. The page itself is in src/formats/report/page/; the data that it finds are described in docs/formats.md.
namespace nscdd {

/// Where the numbers of a page come from.
struct PageOrigin {
  std::string name;          ///< of the case
  std::string command_line;  ///< that wrote the page
  std::string case_text;     ///< the resolved case, as a case file
  std::string libraries;     ///< a line for each, with its version
};

std::string packing_page(const Model& model, const PackingReport& report, const PageOrigin& origin);
std::string run_page(const RunReport& report, const PageOrigin& origin);

}  // namespace nscdd
