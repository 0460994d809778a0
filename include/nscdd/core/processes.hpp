// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/types.hpp>

#include <atomic>
#include <cstring>
#include <ranges>

namespace nscdd {

/// The error of another rank, with its message.
struct FailedElsewhere : Error {
  using Error::Error;
};

/// Positions of the entries shared with another rank, ascending. Both ranks list the same entries in the same order.
struct SharedEntries {
  Index process = 0;
  std::vector<Index> entries;
};

/// Work of one rank since its start.
struct WorkCount {
  double messages = 0;         ///< sent to one other process
  double message_bytes = 0;    ///< in these messages
  double sums = 0;             ///< global exchanges: sums, maxima and gathers
  double sum_bytes = 0;        ///< contributed by this rank
  double contact_updates = 0;  ///< of single contacts, in the sweeps of a two-stage iteration
  double flops = 0;            ///< additions and multiplications of factorisations and of solves with them
  double path_flops = 0;       ///< of those, on the critical path over all ranks

  /// Adds to one of the counts; safe from several threads.
  static void add(double& to, double amount) { std::atomic_ref(to) += amount; }
};

/// The ranks that share the work on one problem. All make the same calls in the same order and get the same bits. A
/// message library provides the functions; the defaults are those of a single rank.
struct Processes {
  using Room = std::function<std::byte*(std::size_t bytes)>;  ///< returns room for all items of a gather

  Index rank = 0, size = 1;
  std::function<void(std::span<double>)> add_up = [](std::span<double>) {};   ///< entry by entry
  std::function<void(std::span<double>)> largest = [](std::span<double>) {};  ///< entry by entry
  /// The items of all ranks, `item` bytes each, in the order of ranks; on all ranks, or on rank 0 only.
  std::function<void(std::span<const std::byte> own, std::size_t item, bool everywhere, const Room& room)>
      gather_bytes = [](std::span<const std::byte> own, std::size_t, bool, const Room& room) {
        if (!own.empty()) std::memcpy(room(own.size()), own.data(), own.size());
      };
  /// Returns a function that sums the entries shared with neighbours, in their arrays; only neighbours synchronise.
  std::function<std::function<void(std::span<double>)>(const std::vector<SharedEntries>&)> between_neighbours =
      [](const auto&) { return [](std::span<double>) {}; };

  std::shared_ptr<WorkCount> counts = std::make_shared<WorkCount>();  ///< of this rank; copies share it

  bool alone() const { return size == 1; }
  bool first() const { return rank == 0; }
  /// Sum and maximum over ranks; integers up to 2^53.
  template <class Number>
  Number sum(Number own) const {
    return combined(add_up, own);
  }
  template <class Number>
  Number maximum(Number own) const {
    return combined(largest, own);
  }
  bool any(bool own) const { return maximum(own ? 1 : 0) > 0; }
  /// Sum over parts, one column each (0 for those of other ranks), in their order: no bit depends on the ranks. The
  /// last `maxima` rows have the largest of the parts instead, at least 0.
  Vector sum_of_parts(Matrix parts, Index maxima = 0) const {
    add_up({parts.data(), at(parts.size())});
    const Index sums = parts.rows() - maxima;
    Vector result = Vector::Zero(parts.rows());
    for (Index e = 0; e < parts.cols(); ++e) {
      result.head(sums) += parts.col(e).head(sums);
      result.tail(maxima) = result.tail(maxima).cwiseMax(parts.col(e).tail(maxima));
    }
    return result;
  }

  /// The items of all ranks, in the order of ranks; nothing on ranks but 0 unless `everywhere`. Items hold no pointers.
  template <std::ranges::contiguous_range Items>
  auto gather(const Items& own, bool everywhere = true) const {
    using Item = std::ranges::range_value_t<Items>;
    static_assert(std::is_trivially_copyable_v<Item>);
    std::vector<Item> all;
    gather_bytes(std::as_bytes(std::span(own)), sizeof(Item), everywhere, [&all](std::size_t bytes) {
      all.resize(bytes / sizeof(Item));
      return reinterpret_cast<std::byte*>(all.data());
    });
    return all;
  }
  /// One item of each rank.
  template <class Item>
  std::vector<Item> gather_each(const Item& own) const {
    return gather(std::span(&own, 1));
  }
  /// Calls take(items) for the items of each rank in turn, so that no rank holds those of all at once.
  template <std::ranges::contiguous_range Items, class Take>
  void exchange(const Items& own, Take&& take) const {
    const std::span given(own);
    if (alone()) return take(given);
    for (Index process = 0; process < size; ++process) {
      const auto items = gather(given.first(process == rank ? given.size() : 0));
      take(std::span(items));
    }
  }

  /// Gives a matrix of each item to all ranks. It is empty on all ranks but one.
  template <class Items, class MatrixOf = std::identity>
  void share(Items& items, const MatrixOf& matrix_of = {}) const {
    if (alone()) return;
    std::vector<double> own;  // number of an item, rows and columns of its matrix, the entries
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Matrix& one = std::invoke(matrix_of, items[i]);
      if (one.size() == 0) continue;
      for (const Index number : {static_cast<Index>(i), one.rows(), one.cols()})
        own.push_back(static_cast<double>(number));
      own.insert(own.end(), one.data(), one.data() + one.size());
    }
    const std::vector<double> all = gather(own);
    for (const double* next = all.data(); next != all.data() + all.size();) {
      const auto i = static_cast<std::size_t>(next[0]);
      Matrix& one = std::invoke(matrix_of, items[i]);
      one = Eigen::Map<const Matrix>(next + 3, static_cast<Index>(next[1]), static_cast<Index>(next[2]));
      next += 3 + one.size();
    }
  }

  /// The result of the work. If some ranks throw Error, the first of them throws its own, all others FailedElsewhere.
  template <class Work>
  auto together(Work&& work) const {
    std::optional<std::invoke_result_t<Work>> result;
    std::optional<Error> error;
    try {
      result.emplace(work());
    } catch (const FailedElsewhere&) {  // the rank that failed reports its error here, too
    } catch (const Error& met) {
      error = met;
    }
    const Index failing = -maximum(error ? -rank : -size);
    if (failing == size) return std::move(*result);
    const std::vector<char> text = gather(std::string_view(failing == rank ? error->what() : ""));
    if (failing == rank) throw *error;
    throw FailedElsewhere(std::string(text.begin(), text.end()));
  }

 private:
  template <class Number>
  static Number combined(const std::function<void(std::span<double>)>& combine, Number own) {
    auto number = static_cast<double>(own);
    combine({&number, 1});
    return static_cast<Number>(number);
  }
};

}  // namespace nscdd
