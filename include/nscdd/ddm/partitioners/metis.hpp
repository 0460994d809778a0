// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/ddm/partition.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

namespace nscdd {

/// METIS k-way partition of the contact graph: its vertices are the contacts, two of them joined where they
/// share a grain, so that a cut edge is a grain to be split. The columns of a contact stay together. Equal
/// sizes, few cuts; no geometry is used.
struct MetisPartitioner {
  static constexpr std::string_view name = "metis";
  static constexpr std::string_view summary = "METIS k-way partition of the contact graph";
  Index metis = 2;
  Index seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("metis", self.metis, Field{.description = "number of subdomains", .minimum = 1, .maximum = 1e6});
    visit("seed", self.seed,
          Field{.description = "seed of METIS's random choices", .minimum = 0, .maximum = 2147483647});
  }
};

/// Subdomains may come out empty where there are few contacts. Throws Error where METIS fails.
Partition by_metis(const ReferenceProblem& problem, const MetisPartitioner& partitioner);

}  // namespace nscdd
