// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/mechanics/reference_problem.hpp>

namespace nscdd {

/// METIS k-way partition of the contact graph. Its vertices are the contacts, its edges join contacts of one grain, so
/// a cut edge splits a grain. Columns of a contact stay together. Parts are of equal size with few cuts, without
/// geometry. METIS may leave parts empty if they are small; each of these takes half of the largest part.
struct MetisPartitioner {
  static constexpr std::string_view name = "metis";
  static constexpr std::string_view summary = "METIS k-way partition of the contact graph";
  static constexpr std::string_view key_form = "metis = n", option_form = "metis:N";
  static constexpr bool needs_geometry = false;
  Index metis = 2;
  Index seed = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("metis", self.metis, Field{.description = "number of subdomains", .minimum = 1, .maximum = 1e6});
    visit("seed", self.seed,
          Field{.description = "seed of METIS's random choices", .minimum = 0, .maximum = 2147483647});
  }
  static std::optional<std::string> value_of_option(std::string_view text) {
    if (!text.starts_with("metis:")) return std::nullopt;
    return std::string(text.substr(6));
  }
};

inline Index subdomains(const MetisPartitioner& partitioner) { return partitioner.metis; }

/// A subdomain is empty only if there are fewer contacts than subdomains. Throws Error if METIS fails or `metis` < 1.
Partition partition(const MetisPartitioner& partitioner, const ReferenceProblem& problem);

}  // namespace nscdd
