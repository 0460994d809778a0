// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep_options.hpp"

#include <nscdd/core/fields.hpp>

namespace nscdd::app {

void SpectralCommandOptions::declare(CLI::App& command, const std::string& default_contacts) {
  contacts = default_contacts;
  command
      .add_option("--contacts", contacts,
                  "contacts of Stage 1: all, active (in compression in the linear rigid problem), or "
                  "unilateral (carrying in the frictionless unilateral problem)")
      ->check(CLI::IsMember({"all", "active", "unilateral"}))
      ->capture_default_str();
  command.add_option("--solver", solver, "auto, dense, or arpack")
      ->check(CLI::IsMember({"auto", "dense", "arpack"}))
      ->capture_default_str();
  command.add_option("--residual-tolerance", tolerance, "largest residual that counts as converged")
      ->capture_default_str();
}

ContactSet SpectralCommandOptions::contact_set() const {
  return nscdd::contact_set(contacts).value_or(ContactSet::all);  // the option admits no other name
}

SpectralOptions SpectralCommandOptions::spectral() const {
  check_bounds(tolerance, Field{.description = "", .minimum = 0, .minimum_excluded = true},
               "--residual-tolerance");
  SpectralOptions options;
  options.tolerance = tolerance;
  if (solver == "dense") options.solver = SpectralSolver::dense;
  if (solver == "arpack") options.solver = SpectralSolver::arpack;
  return options;
}

}  // namespace nscdd::app
