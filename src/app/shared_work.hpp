// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "linalg/threads.hpp"
#include "study/case/case.hpp"

namespace nscdd::app {

/// The threads and the memory of a run. Results do not depend on them; require_memory refuses work that needs more.
struct Limits {
  Index threads = 0;                ///< 0: the default of the machine
  std::optional<double> gibibytes;  ///< by default 90 % of the available memory

  void declare_threads(Command& command);
  void declare_memory(Command& command);
  void declare(Command& command);  ///< both options

  /// Limits the memory of this rank, one of `processes` on this computer. Throws Error if it holds more already.
  void limit_memory(Index processes = 1) const;
  ThreadLimit limit_threads(const Machine& machine) const;  ///< for the life of the result
  ThreadLimit apply(const Machine& machine) const;          ///< limits both
};

/// Keeps freed memory in the process, in blocks up to 32 MiB (the maximum of the C library). Factors of equal size
/// follow each other, and fresh pages took a seventh of the time at 10^6 grains.
void keep_freed_memory();

/// Returns freed memory, such as that of the whole packing, to the system.
void give_back_freed_memory();

/// Declares --contacts, the contacts of Stage 1.
void declare_contacts(Command& command, Choice<ContactSet>& contacts);

/// Options of spectra on this machine. Throws Error if they contradict each other, or if it lacks the solver.
SpectralOptions spectra_on(const Machine& machine, SpectralOptions options);

/// Runs work that may fill the cache on rank 0 first, then on the others.
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

/// The part of a model that this rank holds. H of the undivided packing keeps its entries only if contacts must be
/// chosen. Throws Error on all ranks if one throws it, or if their models differ.
Model shared_model(const Case& one, const Machine& machine, ContactSet contacts);

/// Throws Error on all ranks unless their fingerprints of the case, `numbers`, are equal.
void require_same(const std::vector<double>& numbers, const std::string& name, const Processes& processes);

/// Requires a single rank for `what`, which needs the whole packing.
void require_one_process(const Machine& machine, std::string_view what);

}  // namespace nscdd::app
