// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/study/sweep.hpp>

#include <CLI/CLI.hpp>

#include <string>

namespace nscdd::app {

/// Which contacts Stage 1 works with, and how spectra are computed: shared by sweep and optimum.
struct SpectralCommandOptions {
  std::string contacts;
  std::string solver = "auto";
  double tolerance = SpectralOptions{}.tolerance;

  void declare(CLI::App& command, const std::string& default_contacts);
  ContactSet contact_set() const;
  SpectralOptions spectral() const;
};

}  // namespace nscdd::app
