// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/case_options.hpp"
#include "app/memory_limit.hpp"

namespace nscdd::app {

/// What `nscdd export CASE --operators FOLDER` is asked for.
struct OperatorsOptions {
  CaseOptions one;  ///< its name is the first argument of the verb, whatever is exported
  std::string folder, epsilon, eta = "inf";
  ContactSet contacts = ContactSet::all;
  double relaxation = 1;
  bool sparse_only = false;
  Index threads = 0;
  MemoryLimit memory;
};

/// Declares --operators, which it returns, and what goes with it, but for the first argument.
Option& declare_operators(Command& command, OperatorsOptions& options);

int export_operators(const OperatorsOptions& options, bool force, const Context& context);

}  // namespace nscdd::app
