// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

// Average number of grains in a grain's cell above which another grid is cheaper: measured, and not sensitive.
constexpr double crowded = 32;

}  // namespace

void NumberedGrains::add(const std::array<double, 3>& centre, double of_radius, Index of_number) {
  x.push_back(centre[0]);
  y.push_back(centre[1]);
  if (in_space) z.push_back(centre[2]);
  radius.push_back(of_radius);
  number.push_back(of_number);
}

CellGrid::CellGrid(const Places& places, double side) {
  const std::span<const double> coordinates[3] = {places.x, places.y, places.z};
  std::array<double, 3> size{};
  for (std::size_t k = 0; k < 3; ++k)
    if (!coordinates[k].empty()) {
      const auto [low, high] = std::minmax_element(coordinates[k].begin(), coordinates[k].end());
      low_[k] = *low;
      size[k] = *high - *low;
    }
  // Rounding must never put two points of distance `side` two cells apart.
  side *= 1 + rounding;
  const double budget = 2.0 * static_cast<double>(places.x.size()) + 64;
  const auto cells = [&](std::size_t k) { return std::floor(size[k] / side) + 1; };
  while (cells(0) * cells(1) * cells(2) > budget) side *= 2;
  columns_ = static_cast<Index>(cells(0));
  rows_ = static_cast<Index>(cells(1));
  layers_ = static_cast<Index>(cells(2));
  side_ = side;

  std::vector<Index> cell_of(places.x.size());
  start_.assign(at(columns_ * rows_ * layers_ + 1), 0);
  for (std::size_t i = 0; i < cell_of.size(); ++i) {
    const auto [x, y, z] = places[i];
    const Index row = along(z - low_[2], layers_) * rows_ + along(y - low_[1], rows_);
    cell_of[i] = row * columns_ + along(x - low_[0], columns_);
    ++start_[at(cell_of[i] + 1)];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  points_.resize(cell_of.size());
  std::vector<Index> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < cell_of.size(); ++i) points_[at(next[at(cell_of[i])]++)] = static_cast<Index>(i);
}

GrainGrid::GrainGrid(Places places, std::span<const double> radius, double stretch, double range) {
  if (radius.empty()) return;
  NumberedGrains rest{.in_space = !places.z.empty()};
  while (true) {
    const double largest = *std::max_element(radius.begin(), radius.end());
    const double reach = stretch * largest + range / 2;
    const auto coarse_one = [&](double r) { return 2 * r >= largest; };
    CellGrid grid(places, 2 * reach);
    if (grid.crowd() <= crowded || std::all_of(radius.begin(), radius.end(), coarse_one)) {
      levels_.push_back({std::move(rest), reach, std::move(grid)});
      return;
    }
    NumberedGrains coarse{.in_space = rest.in_space}, fine = coarse;
    for (std::size_t k = 0; k < radius.size(); ++k) {
      const Index number = rest.number.empty() ? static_cast<Index>(k) : rest.number[k];
      (coarse_one(radius[k]) ? coarse : fine).add(places[k], radius[k], number);
    }
    CellGrid own(coarse.places(), 2 * reach);
    levels_.push_back({std::move(coarse), reach, std::move(own)});
    rest = std::move(fine);
    places = rest.places(), radius = rest.radius;
  }
}

NumberedGrains periodic_grains(const Places& places, std::span<const double> radius, const Period& period,
                               double reach) {
  NumberedGrains all{.in_space = !places.z.empty()};
  for (std::size_t i = 0; i < radius.size(); ++i) {
    const std::array<double, 3> place = places[i], step = period.into_cell(place);
    all.add({place[0] + step[0], place[1] + step[1], place[2]}, radius[i], static_cast<Index>(i));
  }
  for (std::size_t i = 0; i < radius.size(); ++i) {
    const std::array<double, 3> place = all.places()[i];
    const bool left = period.x > 0 && place[0] < reach;
    const bool front = period.y > 0 && place[1] < reach;
    const auto image = [&](double dx, double dy) {
      all.add({place[0] + dx, place[1] + dy, place[2]}, radius[i], static_cast<Index>(i));
    };
    if (left) image(period.x, 0);
    if (front) image(0, period.y);
    if (left && front) image(period.x, period.y);
    if (left && period.y > 0 && place[1] > period.y - reach) image(period.x, -period.y);
  }
  return all;
}

}  // namespace nscdd
