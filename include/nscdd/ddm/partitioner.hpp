// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/partitioners/grid.hpp>
#include <nscdd/ddm/partitioners/metis.hpp>

#include <variant>

namespace nscdd {

/// Every partitioner: one file and one word here. A partitioner is a struct of described fields with
///   name, summary   the key of that name in [partition] chooses it
///   key_form        how [partition] has that key
///   option_form     how --subdomains has it; `value_of_option` reads the value of the key from there
///   needs_geometry  whether it needs centres and midpoints, or only the graph of contacts
/// and functions `subdomains`, `partition` and, where it needs geometry, `subdomain_of_midpoint`.
using Partitioner = std::variant<GridPartitioner, MetisPartitioner>;

/// Calls f with each partitioner, with its default fields.
template <class Function>
void for_each_partitioner(Function&& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) { (f(std::variant_alternative_t<I, Partitioner>{}), ...); }
  (std::make_index_sequence<std::variant_size_v<Partitioner>>());
}

/// The partitioner of --subdomains, such as "2x1" or "metis:6". Throws Error naming `what` for other texts.
Partitioner parse_partitioner(std::string_view text, std::string_view what);

inline Index subdomains(const Partitioner& partitioner) {
  return std::visit([](const auto& one) { return subdomains(one); }, partitioner);
}

/// Distributes contacts. `geometry()`: a pair of Packing and ContactNetwork; `graph()`: a ReferenceProblem. Calls one.
template <class Geometry, class Graph>
Partition distribute(const Partitioner& partitioner, Geometry&& geometry, Graph&& graph) {
  return std::visit(
      [&](const auto& one) {
        if constexpr (std::decay_t<decltype(one)>::needs_geometry) {
          const auto& [packing, network] = geometry();
          return partition(one, packing, network);
        } else {
          return partition(one, graph());
        }
      },
      partitioner);
}

}  // namespace nscdd
