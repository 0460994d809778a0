// SPDX-License-Identifier: GPL-3.0-or-later
#include "sweep_options.hpp"

#include <nscdd/core/fields.hpp>

namespace nscdd::app {

void SpectralCommandOptions::declare(CLI::App& command, const std::string& default_contacts) {
  contacts = default_contacts;
  command.add_option("--contacts", contacts, "contacts of Stage 1: all, or active (those in compression)")
      ->check(CLI::IsMember({"all", "active"}))
      ->capture_default_str();
  command.add_option("--solver", solver, "auto, dense, or arpack")
      ->check(CLI::IsMember({"auto", "dense", "arpack"}))
      ->capture_default_str();
  command.add_option("--residual-tolerance", tolerance, "largest residual that counts as converged")
      ->capture_default_str();
}

ContactSet SpectralCommandOptions::contact_set() const {
  return contacts == "active" ? ContactSet::active : ContactSet::all;
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
