// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include <nscdd/study/sweep.hpp>

#include <string>

namespace nscdd::app {

/// Which contacts Stage 1 works with, and how spectra are computed: shared by sweep and optimum.
struct SpectralCommandOptions {
  std::string contacts;
  std::string solver = "auto";
  double tolerance = SpectralOptions{}.tolerance;
  bool certify = false;
  Index eigenvalues = 1;

  void declare(Command& command, const std::string& default_contacts);
  void declare_ends(Command& command);  ///< --certify and --eigenvalues
  ContactSet contact_set() const;
  SpectralOptions spectral() const;
};

/// Declares --threads.
void declare_threads(Command& command, Index& threads);

}  // namespace nscdd::app
