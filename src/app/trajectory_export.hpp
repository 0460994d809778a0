// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include <nscdd/core/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace nscdd::app {

/// Steps first, first + stride, ... up to last.
struct StepRange {
  Index first = 0, last = -1, stride = 1;  ///< last -1: without end
};

/// "A", "A:B" or "A:B:K"; throws Error for another text and for a range without steps.
StepRange parse_step_range(const std::string& text);

/// Ascending numbers as ranges: "0:100:10, 105".
std::string step_ranges_text(const std::vector<Index>& steps);

/// Pictures of the kept steps in the range, in a folder that is made if it does not exist.
struct VtkExport {
  std::string trajectory, folder;
  StepRange steps;
  bool force = false;
};

/// The contact problem of one step.
struct FclibExport {
  std::string trajectory, output;
  Index step = 1;
  std::optional<Index> subdomain;
  bool local = false, force = false;
};

/// Write, print what was written, and return the exit code.
int export_vtk(const VtkExport& what);
int export_fclib(const FclibExport& what, const Context& context);

}  // namespace nscdd::app
