// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep_options.hpp"

#include <nscdd/core/error.hpp>
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
  command
      .add_option(
          "--solver", solver,
          "auto (dense for small interfaces, else shift-invert), dense, arpack (matrix-free Lanczos), or "
          "shift-invert")
      ->check(CLI::IsMember(spectral_solver_names()))
      ->capture_default_str();
  command.add_option("--residual-tolerance", tolerance, "largest residual that counts as converged")
      ->capture_default_str();
}

void SpectralCommandOptions::declare_ends(CLI::App& command) {
  command.add_flag("--certify", certify,
                   "prove by inertia counts that no eigenvalue was missed; adds columns with the intervals");
  command
      .add_option(
          "--eigenvalues", eigenvalues,
          "eigenvalues at each end of the spectrum; more than one adds columns: their values, and for "
          "each end the multiplicity of its first value alone (how many of those found agree with it "
          "within --residual-tolerance; with --certify how many lie in its interval)")
      ->capture_default_str();
}

void declare_threads(CLI::App& command, Index& threads) {
  command.add_option("--threads", threads, "threads at the most, 0 for all; results do not depend on it")
      ->check(CLI::Range(0, 4096))
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
  options.solver = spectral_solver(solver).value_or(SpectralSolver::automatic);  // no other name is admitted
  options.certify = certify;
  check_bounds(eigenvalues, Field{.description = "", .minimum = 1, .maximum = 100}, "--eigenvalues");
  options.eigenvalues = eigenvalues;
  if (options.solver == SpectralSolver::arpack && (certify || eigenvalues > 1))
    throw Error("--solver: expected auto, dense or shift-invert with --certify or --eigenvalues, met arpack");
  return options;
}

}  // namespace nscdd::app
