// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/settled_cases.hpp"
#include "app/verbs.hpp"

namespace nscdd::app {

/// Sets parameters of a case from texts KEY=VALUE.
void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings);

/// Cuts the case as --subdomains says, in place of its [partition].
void set_partition(CaseSpec& spec, const std::string& subdomains);

/// CASE and the options that go with it, the same for every verb that takes a case.
struct CaseOptions {
  std::string name;
  std::string subdomains;
  std::vector<std::string> prescribed;
  std::optional<double> density, tolerance, overlap_tolerance;
  std::vector<std::string> settings;

  void declare(Command& command, bool contact_problems = true);
  void declare_options(Command& command);  ///< all but CASE

  /// The case with every option applied (one subdomain unless --subdomains says otherwise), see resolve_case.
  Case resolve(const std::vector<std::string>& outputs) const;
};

/// Names and versions of the libraries, one a line.
std::string libraries();

/// Versions, command line and the resolved cases, for a result file. Nothing in it changes from run to run.
Provenance provenance(const Context& context, const std::vector<Case>& cases);

}  // namespace nscdd::app
