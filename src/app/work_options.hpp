// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/command.hpp"
#include "study/memory_estimate.hpp"
#include <nscdd/study/sweep.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace nscdd::app {

/// Which contacts Stage 1 works with, and how spectra are computed.
struct SpectralCommandOptions {
  std::string contacts, solver = "auto";
  SpectralOptions options;  ///< tolerance, certify and eigenvalues as given

  void declare(Command& command, const std::string& default_contacts);  ///< all but certify and eigenvalues
  ContactSet contact_set() const;
  SpectralOptions spectral() const;
};

void declare_threads(Command& command, Index& threads);

/// Memory that a run may take, and its refusal before the run begins.
struct MemoryLimit {
  std::optional<double> gibibytes;  ///< as given; else 90 % of what is available

  void declare(Command& command);

  /// Throws Error with both amounts where the need exceeds the limit: of a table, of a sweep of a model, and of
  /// other work on a case, where `what` takes the memory and `advice` may help beside a larger limit.
  void require(const MemoryNeed& need) const;
  void require(const Model& model, const SweepParameters& sweep) const;
  void require(double bytes, std::string_view name, std::string_view what, std::string_view advice) const;
};

}  // namespace nscdd::app
