// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/settled_cases.hpp"
#include "app/verbs.hpp"

namespace nscdd::app {

/// A parameter on the command line and the option that gives it.
struct GivenParameter {
  std::string key, option;
};
using GivenParameters = std::vector<GivenParameter>;

/// Throws Error if another option gave the parameter.
void add_given(GivenParameters& given, const std::string& key, const std::string& option);

/// Sets parameters of a case from texts KEY=VALUE, and adds them to `given`.
void apply_settings(CaseSpec& spec, const std::vector<std::string>& settings, GivenParameters& given);

/// Replaces the [partition] of a case by that of --subdomains, unless that is empty, and adds it to `given`.
void set_partition(CaseSpec& spec, const std::string& subdomains, GivenParameters& given);

/// CASE and its options, the same for all verbs that take a case.
struct CaseOptions {
  std::string name;
  std::string subdomains;
  std::vector<std::string> prescribed;
  std::optional<double> density, tolerance, overlap_tolerance;
  std::vector<std::string> settings;

  void declare(Command& command);
  void declare_options(Command& command);  ///< all but CASE

  /// The case with all options applied, see resolve_case.
  Case resolve(const std::vector<std::string>& outputs) const;
};

/// Versions, command line and resolved cases of a result file: equal for equal runs.
Provenance provenance(const Context& context, const std::vector<Case>& cases);

}  // namespace nscdd::app
