// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <atomic>
#include <memory>
#include <span>

namespace nscdd {

/// What the other processes throw where one has failed, in the words of that one.
struct FailedElsewhere : Error {
  using Error::Error;
};

/// Entries of an array to which this process and another one add, ascending. Both list the same ones in the same order,
/// wherever in its array each process has them.
struct SharedEntries {
  Index process = 0;
  std::vector<Index> entries;
};

/// What one process has done since it began, counted where it is done.
struct WorkCount {
  double messages = 0;         ///< sent to one other process
  double message_bytes = 0;    ///< in these
  double sums = 0;             ///< exchanges in which all processes take part: sums, maxima and gathers
  double sum_bytes = 0;        ///< that this process put into these
  double contact_updates = 0;  ///< of single contacts, in the sweeps of a two-stage iteration
  double flops = 0;            ///< additions and multiplications of factorisations and of solves with them
  /// The same over all processes along the longest way: of what no process may begin before another one has finished.
  double path_flops = 0;

  /// Adds to one of the counts; threads may do so at the same time.
  static void add(double& to, double amount) { std::atomic_ref(to) += amount; }
};

/// The processes that share the work on one problem; by default this one is alone. All of them make the same calls in
/// the same order, with arrays of the same length, and all of them get the same bits.
struct Processes {
  Index rank = 0, size = 1;
  std::function<void(std::span<double>)> add_up = [](std::span<double>) {};   ///< entry by entry
  std::function<void(std::span<double>)> largest = [](std::span<double>) {};  ///< entry by entry
  /// The numbers of all of them, one process after the other.
  std::function<std::vector<double>(std::span<const double>)> gather = [](std::span<const double> own) {
    return std::vector<double>(own.begin(), own.end());
  };
  /// The same in the first process, and nothing in the others.
  std::function<std::vector<double>(std::span<const double>)> gather_at_first = [](std::span<const double> own) {
    return std::vector<double>(own.begin(), own.end());
  };
  /// What adds up the entries that neighbours share, of one array after the other. Nobody else takes part, and only
  /// these entries are then the same in both.
  std::function<std::function<void(std::span<double>)>(const std::vector<SharedEntries>&)> between_neighbours =
      [](const auto&) { return [](std::span<double>) {}; };

  std::shared_ptr<WorkCount> counts = std::make_shared<WorkCount>();  ///< of this process; its copies share it

  bool alone() const { return size == 1; }
  bool first() const { return rank == 0; }
  double sum(double own) const { return add_up({&own, 1}), own; }
  double maximum(double own) const { return largest({&own, 1}), own; }
  /// Whether any of them says so.
  bool any(bool own) const { return maximum(own ? 1 : 0) > 0; }

  /// Calls take(numbers) for the numbers of each process in turn, so that none ever holds those of all.
  template <class Take>
  void take_turns(std::span<const double> own, Take&& take) const {
    for (Index process = 0; process < size; ++process) {
      const std::vector<double> numbers = gather(process == rank ? own : std::span<const double>());
      take(std::span<const double>(numbers));
    }
  }

  /// The result of the work. If it throws Error in some of them, the first of these throws that, the others
  /// FailedElsewhere.
  template <class Work>
  auto together(Work&& work) const {
    std::optional<std::invoke_result_t<Work>> result;
    std::optional<Error> error;
    try {
      result.emplace(work());
    } catch (const FailedElsewhere&) {  // whoever has failed says so here as well
    } catch (const Error& met) {
      error = met;
    }
    const auto failing = static_cast<Index>(-maximum(static_cast<double>(error ? -rank : -size)));
    if (failing == size) return std::move(*result);
    const std::string_view said = failing == rank ? error->what() : "";
    const std::vector<double> letters = gather(std::vector<double>(said.begin(), said.end()));
    if (failing == rank) throw *error;
    std::string text;
    for (const double letter : letters) text += static_cast<char>(letter);
    throw FailedElsewhere(text);
  }
};

}  // namespace nscdd
