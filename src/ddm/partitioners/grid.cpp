// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include <nscdd/ddm/partitioners/grid.hpp>

namespace nscdd {
namespace {

// Cell 0 ... cells-1 of a coordinate; lines belong to the cell below them. Rounding must not send a midpoint
// that lies on a line to the upper cell, hence the small allowance.
Index cell(double coordinate, double low, double high, Index cells) {
  if (high <= low) return 0;
  const double position = (coordinate - low) / (high - low) * static_cast<double>(cells);
  return std::clamp(static_cast<Index>(std::ceil(position - 1e-9)) - 1, Index{0}, cells - 1);
}

}  // namespace

Index subdomains(const GridPartitioner& partitioner) {
  const auto [nx, ny] = partitioner.grid;
  if (nx < 1 || ny < 1 || nx * ny > 1'000'000)
    fail("partition.grid: expected between 1 and 1000000 cells, met {} x {}", nx, ny);
  return nx * ny;
}

Partition partition(const GridPartitioner& partitioner, const Packing& packing, const ContactNetwork& network) {
  const auto [nx, ny] = partitioner.grid;
  Partition result{.subdomains = subdomains(partitioner), .subdomain_of_contact = {}};
  if (packing.size() == 0) return result;
  const auto [x_low, x_high] = std::minmax_element(packing.x.begin(), packing.x.end());
  const auto [y_low, y_high] = std::minmax_element(packing.y.begin(), packing.y.end());
  for (const Contact& contact : network.contacts) {
    const Index column = cell(contact.midpoint[0], *x_low, *x_high, nx);
    const Index row = cell(contact.midpoint[1], *y_low, *y_high, ny);
    result.subdomain_of_contact.push_back(row * nx + column);
  }
  return result;
}

}  // namespace nscdd
