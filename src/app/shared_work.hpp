// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/verbs.hpp"
#include "linalg/threads.hpp"
#include "study/case/case.hpp"

namespace nscdd::app {

/// The threads and the memory that a run may use. No result depends on them; work whose size is known exactly is
/// refused where it needs more memory (require_memory).
struct Limits {
  Index threads = 0;                ///< 0: the default of the machine
  std::optional<double> gibibytes;  ///< as given; else 90 % of what is available

  void declare_threads(Command& command);
  void declare_memory(Command& command);
  void declare(Command& command);  ///< both options

  /// Limits this process, one of so many that share the memory of a computer. Throws Error if it holds more already.
  void limit_memory(Index processes = 1) const;
  /// Limits the threads for the life of the result.
  ThreadLimit limit_threads(const Machine& machine) const;
  ThreadLimit apply(const Machine& machine) const;  ///< limits both
};

/// Keeps freed memory in the process: a factor follows another of the same size, and memory given back in between comes
/// as fresh pages, which took a seventh of the time at 10^6 grains. Blocks up to 32 MiB, the largest size that is
/// allowed here, are kept.
void keep_freed_memory();

/// Returns freed memory to the system. Otherwise the memory of the whole packing would stay with the process.
void give_back_freed_memory();

/// The option --contacts: which contacts Stage 1 works with.
void declare_contacts(Command& command, Choice<ContactSet>& contacts);

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
