// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "study/case/case.hpp"

namespace nscdd::app {

/// The option --threads, and the largest number of threads: as asked for, else the default of the machine.
void declare_threads(Command& command, Index& threads);
inline Index threads_of(Index asked, const Machine& machine) { return asked > 0 ? asked : machine.threads; }

/// The option --contacts: which contacts Stage 1 works with.
void declare_contacts(Command& command, ContactSet& contacts);

/// How spectra are computed on this machine. Throws Error for options that contradict each other, and for a solver that
/// the machine does not have.
SpectralOptions spectra_on(const Machine& machine, SpectralOptions options);

/// Work that may leave something in the cache: the first process does it before the others.
template <class Work>
auto in_turn(const Processes& processes, Work&& work) {
  std::optional<std::invoke_result_t<Work>> result;
  for (const bool turn_of_first : {true, false})
    processes.together([&] {
      if (processes.first() == turn_of_first) result.emplace(work());
      return true;
    });
  return std::move(*result);
}

/// The model of a case as this process has it; H of the undivided packing keeps its entries only where contacts must be
/// chosen. Throws Error in all processes if one throws it, or if they do not have the same.
Model shared_model(const Case& one, const Machine& machine, ContactSet contacts);

/// Throws Error in all processes unless they have the same numbers, a fingerprint of the case.
void require_same(const std::vector<double>& numbers, const std::string& name, const Processes& processes);

/// Throws Error for what needs the whole packing where several processes share it.
void require_one_process(const Machine& machine, std::string_view what);

}  // namespace nscdd::app
