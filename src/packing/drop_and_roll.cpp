// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/drop_and_roll.hpp"

#include <algorithm>
#include <cmath>

namespace nscdd {
namespace {

// > 0 where q is met after p by a disk that rolls over the pivot to that side, less than half a turn apart.
double later(const Disk& pivot, const Point& p, const Point& q, Side side) {
  const double cross = (p[0] - pivot.x) * (q[1] - pivot.y) - (p[1] - pivot.y) * (q[0] - pivot.x);
  return -static_cast<double>(side) * cross;
}

}  // namespace

std::optional<double> fall_onto(const Disk& support, double x, double radius) {
  const double reach = radius + support.radius, d = std::abs(x - support.x);
  if (d >= reach) return std::nullopt;
  return support.y + std::sqrt((reach - d) * (reach + d));
}

std::optional<Point> roll_against(const Disk& pivot, const Disk& other, double radius, Side side) {
  const double reach_p = radius + pivot.radius, reach_o = radius + other.radius;
  const double dx = other.x - pivot.x, dy = other.y - pivot.y;
  const double d = std::hypot(dx, dy);
  if (d >= reach_p + reach_o) return std::nullopt;
  // The meeting point lies `along` the line of centres and `beside` it, on the side the disk comes from; seen
  // from the centre that it is nearer to, where a large circle does not round off the small one.
  const bool from_pivot = reach_p <= reach_o;
  const Disk& base = from_pivot ? pivot : other;
  const double near = from_pivot ? reach_p : reach_o, far = from_pivot ? reach_o : reach_p;
  const double along = (near * near + (d - far) * (d + far)) / (2 * d);
  const double beside = static_cast<double>(side) * std::sqrt(std::max(0.0, (near - along) * (near + along)));
  const double towards = from_pivot ? along : -along;  // in the direction from the pivot to the other
  return Point{base.x + (towards * dx - beside * dy) / d, base.y + (towards * dy + beside * dx) / d};
}

Heap::Heap(double width, double largest_radius, Index grains)
    : width_(width), largest_(largest_radius), side_(2 * largest_radius) {
  // A box far wider than its grains can fill is cut into fewer, wider columns.
  side_ = std::max(side_, width / (2.0 * static_cast<double>(grains) + 64));
  columns_ = static_cast<std::size_t>(width / side_) + 1;
  filled_.assign(columns_, 0);
  disks_.reserve(at(grains));
  next_.reserve(at(grains));
}

std::size_t Heap::column_of(double x) const {
  return std::min(columns_ - 1, static_cast<std::size_t>(std::max(0.0, x) / side_));
}

std::size_t Heap::row_of(double y) const { return static_cast<std::size_t>(std::max(0.0, y) / side_); }

template <class Visit>
void Heap::visit_cell(std::size_t column, std::size_t row, Visit&& visit) const {
  for (std::int32_t i = first_[row * columns_ + column]; i >= 0; i = next_[static_cast<std::size_t>(i)])
    visit(i, disks_[static_cast<std::size_t>(i)]);
}

void Heap::add(const Disk& disk) {
  const std::size_t column = column_of(disk.x), row = row_of(disk.y);
  rows_ = std::max(rows_, row + 1);
  if (first_.size() < rows_ * columns_) first_.resize(rows_ * columns_, -1);
  filled_[column] = std::max(filled_[column], row + 1);
  next_.push_back(first_[row * columns_ + column]);
  first_[row * columns_ + column] = static_cast<std::int32_t>(disks_.size());
  disks_.push_back(disk);
}

Heap::Meeting Heap::fall(const Point& from, double radius) const {
  const double x = from[0];
  Meeting met{Meeting::With::floor, {x, radius}};
  const std::size_t first = column_of(x - radius - largest_), last = column_of(x + radius + largest_);
  std::size_t rows = 0;
  for (std::size_t column = first; column <= last; ++column) rows = std::max(rows, filled_[column]);
  if (std::isfinite(from[1])) rows = std::min(rows, row_of(from[1]) + 1);
  for (std::size_t row = rows; row-- > 0;) {
    // What lies in this row or below stops a disk no higher than this.
    if (met.centre[1] >= static_cast<double>(row + 1) * side_ + radius + largest_) break;
    for (std::size_t column = first; column <= last; ++column)
      visit_cell(column, row, [&](std::int32_t i, const Disk& disk) {
        if (disk.y >= from[1]) return;
        const auto height = fall_onto(disk, x, radius);
        if (height && *height > met.centre[1]) met = {Meeting::With::grain, {x, *height}, i};
      });
  }
  // A grain touched from the start may seem, by rounding, to have been met a little higher.
  met.centre[1] = std::min(met.centre[1], from[1]);
  return met;
}

// Where rolling ends if no grain is in the way: at the wall, on the floor, or in free fall from the height of
// the pivot's centre.
Heap::Meeting Heap::end_of_roll(const Disk& pivot, double radius, Side side) const {
  const double reach = radius + pivot.radius, sign = static_cast<double>(side);
  Meeting met{Meeting::With::nothing, {pivot.x + sign * reach, pivot.y}};
  if (const double below = radius - pivot.y; below >= 0)
    met = {Meeting::With::floor, {pivot.x + sign * std::sqrt((reach - below) * (reach + below)), radius}};
  const double wall = side == Side::right ? width_ - radius : radius;
  if (const double away = std::abs(wall - pivot.x); sign * (met.centre[0] - wall) >= 0)
    met = {Meeting::With::wall, {wall, pivot.y + std::sqrt(std::max(0.0, (reach - away) * (reach + away)))}};
  return met;
}

Heap::Meeting Heap::roll(const Disk& pivot, const Point& from, double radius, Side side) const {
  Meeting met = end_of_roll(pivot, radius, side);
  const double reach = radius + largest_;
  const std::size_t first_column = column_of(std::min(from[0], met.centre[0]) - reach);
  const std::size_t last_column = column_of(std::max(from[0], met.centre[0]) + reach);
  const std::size_t last_row = std::min(rows_, row_of(from[1] + reach) + 1);
  for (std::size_t row = row_of(met.centre[1] - reach); row < last_row; ++row)
    for (std::size_t column = first_column; column <= last_column; ++column)
      visit_cell(column, row, [&](std::int32_t i, const Disk& disk) {
        // Only what lies ahead is in the way; the pivot itself and a pivot just left are not.
        if (later(pivot, from, {disk.x, disk.y}, side) <= 0) return;
        const auto centre = roll_against(pivot, disk, radius, side);
        if (centre && later(pivot, *centre, met.centre, side) > 0) met = {Meeting::With::grain, *centre, i};
      });
  return met;
}

Disk Heap::settle(double x, double radius) const {
  Point centre{x, infinity};
  while (true) {
    Meeting met = fall(centre, radius);
    centre = met.centre;
    if (met.with == Meeting::With::floor) return {centre[0], centre[1], radius};
    const Side side = centre[0] >= disks_[static_cast<std::size_t>(met.grain)].x ? Side::right : Side::left;
    while (met.with == Meeting::With::grain) {
      met = roll(disks_[static_cast<std::size_t>(met.grain)], centre, radius, side);
      centre = met.centre;
      const bool held =
          met.with == Meeting::With::grain &&
          static_cast<double>(side) * (disks_[static_cast<std::size_t>(met.grain)].x - centre[0]) >= 0;
      if (held || met.with == Meeting::With::floor || met.with == Meeting::With::wall)
        return {centre[0], centre[1], radius};
    }
  }
}

}  // namespace nscdd
