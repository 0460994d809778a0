// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/core/fields.hpp>
#include <nscdd/ddm/decomposition.hpp>
#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Regular grid of grid[0] x grid[1] cells over the bounding box of the grain centres. A contact goes to the
/// cell of its midpoint, subdomain = row x grid[0] + column; a midpoint on a line goes to the lower cell.
struct GridPartitioner {
  static constexpr std::string_view name = "grid";
  static constexpr std::string_view summary = "contact midpoints on a regular grid";
  static constexpr std::string_view key_form = "grid = [nx, ny]", option_form = "NXxNY such as 2x1";
  static constexpr bool needs_geometry = true;
  std::array<Index, 2> grid{1, 1};

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor&& visit) {
    visit("grid", self.grid, Field{.description = "cells along x and along y", .minimum = 1, .maximum = 100000});
  }
  static std::optional<std::string> value_of_option(std::string_view text) {
    const auto cross = text.find('x');
    if (cross == std::string_view::npos) return std::nullopt;
    return std::string(text.substr(0, cross)) + "," + std::string(text.substr(cross + 1));
  }
};

/// Cells of the grid. Throws Error for over 10^6.
Index subdomains(const GridPartitioner& partitioner);

/// A midpoint within 1e-9 of a cell size above a line counts as on it. Throws Error for over 10^6 cells.
Partition partition(const GridPartitioner& partitioner, const Packing& packing, const ContactNetwork& network);

}  // namespace nscdd
