// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/drop_and_roll.hpp"

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
  // The meeting point lies `along` the line of centres and `beside` it, on the side the disk comes from. It is measured
  // from the nearer centre: the rounding of a large circle would spoil a small one.
  const bool from_pivot = reach_p <= reach_o;
  const Disk& base = from_pivot ? pivot : other;
  const double near = from_pivot ? reach_p : reach_o, far = from_pivot ? reach_o : reach_p;
  const double along = (near * near + (d - far) * (d + far)) / (2 * d);
  const double beside = static_cast<double>(side) * std::sqrt(std::max(0.0, (near - along) * (near + along)));
  const double towards = from_pivot ? along : -along;  // in the direction from the pivot to the other
  return Point{base.x + (towards * dx - beside * dy) / d, base.y + (towards * dy + beside * dx) / d};
}

// Whether a disk meets grain i before `met`: if `lead` is positive. If it is 0, the disk meets both at one place. A
// fixed order then decides, so that the bed does not depend on the order of search: by rows of cells of the coarsest
// level, in a row from left to right, in a cell from the latest grain to the first.
bool Heap::first_met(double lead, Index i, const Meeting& met, Rows rows) const {
  if (lead != 0 || met.with != Meeting::With::grain) return lead > 0;
  const BedCells::Level& coarsest = cells_.levels().front();
  const auto cell = [&](Index grain) {
    const Disk& disk = disks_[at(grain)];
    const std::size_t row = coarsest.layer_of(disk.y);
    return std::pair(rows == Rows::upwards ? row : ~row, coarsest.column_of(disk.x));
  };
  const auto cell_i = cell(i), cell_met = cell(met.grain);
  return cell_i != cell_met ? cell_i < cell_met : i > met.grain;
}

void Heap::add(const Disk& disk) {
  cells_.add({disk.x, 0, disk.y}, disk.radius);
  disks_.push_back(disk);
}

Heap::Meeting Heap::fall(const Point& from, double radius) const {
  const double x = from[0];
  Meeting met{Meeting::With::floor, {x, radius}};
  for (const BedCells::Level& level : cells_.levels()) {
    const Eigen::Vector3d left(x - radius - level.largest, 0, 0), right(x + radius + level.largest, 0, 0);
    std::size_t rows = level.highest(left, right);
    if (std::isfinite(from[1])) rows = std::min(rows, level.layer_of(from[1]) + 1);
    for (std::size_t row = rows; row-- > 0;) {
      // A grain in this row or below stops the disk no higher than the one found.
      if (met.centre[1] >= static_cast<double>(row + 1) * level.side + radius + level.largest) break;
      cells_.visit(level, row, row + 1, left, right, [&](Index i) {
        const Disk& disk = disks_[at(i)];
        if (disk.y >= from[1]) return;
        const auto height = fall_onto(disk, x, radius);
        if (height && first_met(*height - met.centre[1], i, met, Rows::downwards))
          met = {Meeting::With::grain, {x, *height}, i};
      });
    }
  }
  // By rounding, a grain touched from the start may seem to be met a little higher.
  met.centre[1] = std::min(met.centre[1], from[1]);
  return met;
}

// End of rolling without an obstacle: at the wall, on the floor, or falling from the height of the pivot.
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
  const Meeting end = end_of_roll(pivot, radius, side);
  Meeting met = end;
  const double arc = radius + pivot.radius;  // on which the centre moves, down and away from the pivot
  const auto away = [&](double y) {          // horizontal distance from the pivot to the arc at height y
    const double above = std::clamp(y - pivot.y, 0.0, arc);
    return std::sqrt((arc - above) * (arc + above));
  };
  for (const BedCells::Level& level : cells_.levels()) {
    const double reach = radius + level.largest, wide = reach * (1 + size_margin);
    const double leftmost = std::min(from[0], end.centre[0]) - reach;
    const double rightmost = std::max(from[0], end.centre[0]) + reach;
    const bool many_columns = rightmost - leftmost > 8 * level.side;
    const std::size_t last_row = level.layer_of(end.centre[1] - reach);
    for (std::size_t row = std::min(level.layers, level.layer_of(from[1] + reach) + 1); row-- > last_row;) {
      // The centre is between these heights when it meets a grain of this row.
      const double low = static_cast<double>(row) * level.side - wide;
      const double high = static_cast<double>(row + 1) * level.side + wide;
      if (high < met.centre[1]) break;
      double left = leftmost, right = rightmost;
      if (many_columns) {
        const double near = away(high) - wide, far = away(std::max(low, met.centre[1] - wide)) + wide;
        left = std::max(left, side == Side::right ? pivot.x + near : pivot.x - far);
        right = std::min(right, side == Side::right ? pivot.x + far : pivot.x - near);
      }
      cells_.visit(level, row, row + 1, {left, 0, 0}, {right, 0, 0}, [&](Index i) {
        const Disk& disk = disks_[at(i)];
        // Only grains ahead are obstacles; the pivot itself and a pivot just left are not.
        if (later(pivot, from, {disk.x, disk.y}, side) <= 0) return;
        const auto centre = roll_against(pivot, disk, radius, side);
        if (centre && first_met(later(pivot, *centre, met.centre, side), i, met, Rows::upwards))
          met = {Meeting::With::grain, *centre, i};
      });
    }
  }
  return met;
}

Disk Heap::settle(double x, double radius) const {
  Point centre{x, infinity};
  while (true) {
    Meeting met = fall(centre, radius);
    centre = met.centre;
    if (met.with == Meeting::With::floor) return {centre[0], centre[1], radius};
    const Side side = centre[0] >= disks_[at(met.grain)].x ? Side::right : Side::left;
    while (met.with == Meeting::With::grain) {
      met = roll(disks_[at(met.grain)], centre, radius, side);
      centre = met.centre;
      const bool held =
          met.with == Meeting::With::grain && static_cast<double>(side) * (disks_[at(met.grain)].x - centre[0]) >= 0;
      if (held || met.with == Meeting::With::floor || met.with == Meeting::With::wall)
        return {centre[0], centre[1], radius};
    }
  }
}

}  // namespace nscdd
