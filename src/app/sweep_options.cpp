// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/sweep_options.hpp"

#include <nscdd/core/error.hpp>
#include <nscdd/core/fields.hpp>

namespace nscdd::app {

void SpectralCommandOptions::declare(Command& command, const std::string& default_contacts) {
  contacts = default_contacts;
  command
      .add_option("--contacts", contacts,
                  "contacts of Stage 1: all, active, or unilateral; active: in compression in the linear "
                  "rigid problem; unilateral: carrying in the frictionless unilateral problem")
      ->one_of(all_names<ContactSet>())
      ->shows_default();
  command
      .add_option("--solver", solver,
                  "auto, dense, arpack, or shift-invert; auto: dense for small interfaces, else "
                  "shift-invert; arpack: matrix-free Lanczos")
      ->one_of(all_names<SpectralSolver>())
      ->shows_default();
  command.add_option("--residual-tolerance", tolerance, "largest residual that counts as converged")->shows_default();
}

void SpectralCommandOptions::declare_ends(Command& command) {
  command.add_flag("--certify", certify,
                   "prove by inertia counts that no eigenvalue was missed; adds columns with the intervals");
  command
      .add_option("--eigenvalues", eigenvalues,
                  "eigenvalues at each end; more than one adds columns: their values, and for "
                  "each end the multiplicity of its first value alone (how many of those found agree with it "
                  "within --residual-tolerance; with --certify how many lie in its interval)")
      ->shows_default();
}

void declare_threads(Command& command, Index& threads) {
  command.add_option("--threads", threads, "threads at the most, 0 for all; results do not depend on it")
      ->between(0, 4096)
      ->shows_default();
}

ContactSet SpectralCommandOptions::contact_set() const {
  return named<ContactSet>(contacts).value_or(ContactSet::all);  // the option admits no other name
}

SpectralOptions SpectralCommandOptions::spectral() const {
  check_bounds(tolerance, Field{.description = "", .minimum = 0, .minimum_excluded = true}, "--residual-tolerance");
  SpectralOptions options;
  options.tolerance = tolerance;
  options.solver = named<SpectralSolver>(solver).value_or(SpectralSolver::automatic);  // no other name is admitted
  options.certify = certify;
  check_bounds(eigenvalues, Field{.description = "", .minimum = 1, .maximum = 100}, "--eigenvalues");
  options.eigenvalues = eigenvalues;
  if (options.solver == SpectralSolver::arpack && (certify || eigenvalues > 1))
    throw Error("--solver: expected auto, dense or shift-invert with --certify or --eigenvalues, met arpack");
  return options;
}

}  // namespace nscdd::app
