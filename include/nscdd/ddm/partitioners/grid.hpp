// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Regular grid of grid[0] x grid[1] cells, in space x grid[2], over the box of the grain centres. The midpoint of a
/// contact decides its cell (i, j, k), the lower one of two; subdomain = i + grid[0] (j + grid[1] k).
struct GridPartitioner {
  static constexpr std::string_view name = "grid";
  static constexpr std::string_view summary = "contact midpoints on a regular grid";
  static constexpr std::string_view key_form = "grid = [nx, ny] (in space [nx, ny, nz])";
  static constexpr std::string_view option_form = "NXxNY such as 2x1 (in space NXxNYxNZ such as 2x1x1)";
  static constexpr bool needs_geometry = true;
  Components<Index> grid{1, 1};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("grid", self.grid,
          Field{.description = "cells along x and along y, in space along z too", .minimum = 1, .maximum = 100000});
  }
  static std::optional<std::string> value_of_option(std::string_view text) {
    if (text.find('x') == std::string_view::npos) return std::nullopt;
    std::string numbers(text);
    std::ranges::replace(numbers, 'x', ',');
    return numbers;
  }
};

/// Cells of the grid. Throws Error for over 10^6.
Index subdomains(const GridPartitioner& partitioner);

/// A midpoint within 1e-9 of a cell size above a line counts as on it. Throws Error for over 10^6 cells, and unless the
/// grid has a number of cells for each direction of the packing; a grid of a single cell fits any.
Partition partition(const GridPartitioner& partitioner, const Packing& packing, const ContactNetwork& network);

/// The subdomain of a contact from its midpoint, m, for a rank without all contacts. Throws Error as `partition` does.
std::function<Index(const std::array<double, 3>&)> subdomain_of_midpoint(const GridPartitioner& partitioner,
                                                                         const Packing& packing);

}  // namespace nscdd
