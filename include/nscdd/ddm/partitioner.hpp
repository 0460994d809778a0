// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/ddm/partitioners/grid.hpp>
#include <nscdd/ddm/partitioners/metis.hpp>

#include <variant>

namespace nscdd {

/// Every partitioner: one file, one word here, and its branch in `partition`.
using Partitioner = std::variant<GridPartitioner, MetisPartitioner>;

/// Subdomains asked for.
inline Index subdomains(const Partitioner& partitioner) {
  const auto* grid = std::get_if<GridPartitioner>(&partitioner);
  return grid != nullptr ? subdomains(*grid) : std::get<MetisPartitioner>(partitioner).metis;
}

/// Distributes the contacts of a packing; each partitioner takes of it what it needs.
inline Partition partition(const Partitioner& partitioner, const Packing& packing,
                           const ContactNetwork& network, const ReferenceProblem& problem) {
  struct Visitor {
    const Packing& packing;
    const ContactNetwork& network;
    const ReferenceProblem& problem;
    Partition operator()(const GridPartitioner& grid) const { return by_grid(packing, network, grid); }
    Partition operator()(const MetisPartitioner& metis) const { return by_metis(problem, metis); }
  };
  return std::visit(Visitor{packing, network, problem}, partitioner);
}

}  // namespace nscdd
