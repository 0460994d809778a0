// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "packing/precision.hpp"
#include <nscdd/ddm/partitioners/grid.hpp>

#include <fmt/ranges.h>

namespace nscdd {
namespace {

constexpr Index most_cells = 1'000'000;

// The cells along one coordinate, and the range of the centres.
struct CellRow {
  double low, high;
  Index cells;
  double allowance;  // of rounding, in cells
};

CellRow row_over(const Packing& packing, const std::vector<double>& centres, Index asked) {
  const auto [low, high] = std::minmax_element(centres.begin(), centres.end());
  const Index cells = std::max<Index>(asked, 1);  // a grid of one cell may leave z out
  constexpr double of_arithmetic = 1e-9;
  if (cells == 1 || *high <= *low) return {*low, *high, cells, of_arithmetic};
  // twice: of a midpoint and of the ends
  const double of_numbers = 2 * certain_offset(packing, centres) / (*high - *low) * static_cast<double>(cells);
  return {*low, *high, cells, std::clamp(of_numbers, of_arithmetic, 0.5)};
}

// Cell 0 ... cells-1 of a coordinate. The allowance keeps a midpoint on a line in the lower cell despite rounding.
Index cell(double coordinate, const CellRow& along) {
  if (along.high <= along.low) return 0;
  const double position = (coordinate - along.low) / (along.high - along.low) * static_cast<double>(along.cells);
  return std::clamp(static_cast<Index>(std::ceil(position - along.allowance)) - 1, Index{0}, along.cells - 1);
}

}  // namespace

Index subdomains(const GridPartitioner& partitioner) {
  Index cells = 1;
  for (const Index along : partitioner.grid) {  // at most 10^6 before each product: no overflow
    if (along < 1 || along > most_cells || cells * along > most_cells)
      fail("partition.grid: expected between 1 and {} cells, met {}", most_cells, fmt::join(partitioner.grid, " x "));
    cells *= along;
  }
  return cells;
}

std::function<Index(const std::array<double, 3>&)> subdomain_of_midpoint(const GridPartitioner& partitioner,
                                                                         const Packing& packing) {
  if (packing.size() == 0) return [](const auto&) { return Index{0}; };
  const Components<Index>& grid = partitioner.grid;
  if (subdomains(partitioner) > 1) require_components(grid, packing.dimension(), "partition.grid");
  std::vector<CellRow> rows;
  for (const std::vector<double>* centres : {&packing.x, &packing.y, &packing.z})
    if (!centres->empty()) rows.push_back(row_over(packing, *centres, grid[rows.size()]));
  return [rows](const std::array<double, 3>& midpoint) {
    Index subdomain = 0;
    for (std::size_t k = rows.size(); k-- > 0;) subdomain = subdomain * rows[k].cells + cell(midpoint[k], rows[k]);
    return subdomain;
  };
}

Partition partition(const GridPartitioner& partitioner, const Packing& packing, const ContactNetwork& network) {
  Partition result{.subdomains = subdomains(partitioner), .subdomain_of_contact = {}};
  const auto cell_of = subdomain_of_midpoint(partitioner, packing);
  // In a periodic cell midpoints are moved into the one that begins at the lowest centre, whichever grain comes first.
  const double low_x = network.contacts.empty() ? 0 : std::ranges::min(packing.x),
               low_y = network.contacts.empty() ? 0 : std::ranges::min(packing.y);
  for (const Contact& contact : network.contacts) {
    auto [x, y, z] = contact.midpoint;
    const auto steps = network.period.into_cell({x - low_x, y - low_y, 0});
    result.subdomain_of_contact.push_back(cell_of({x + steps[0], y + steps[1], z}));
  }
  return result;
}

}  // namespace nscdd
