// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/grain_grid.hpp"

namespace nscdd {
namespace {

// Average number of grains in a grain's cell above which another grid is cheaper: measured, and not sensitive.
constexpr double crowded = 32;

}  // namespace

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
    const Index layer = places.z.empty() ? 0 : along(places.z[i] - low_[2], layers_);
    cell_of[i] =
        (layer * rows_ + along(places.y[i] - low_[1], rows_)) * columns_ + along(places.x[i] - low_[0], columns_);
    ++start_[at(cell_of[i] + 1)];
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  points_.resize(cell_of.size());
  std::vector<Index> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < cell_of.size(); ++i) points_[at(next[at(cell_of[i])]++)] = static_cast<Index>(i);
}

GrainGrid::GrainGrid(Places places, std::span<const double> radius, double stretch, double range) {
  if (radius.empty()) return;
  Grains rest;
  while (true) {
    const double largest = *std::max_element(radius.begin(), radius.end());
    const double reach = stretch * largest + range / 2;
    const auto coarse_one = [&](double r) { return 2 * r >= largest; };
    CellGrid grid(places, 2 * reach);
    if (grid.crowd() <= crowded || std::all_of(radius.begin(), radius.end(), coarse_one)) {
      levels_.push_back({std::move(rest), reach, std::move(grid)});
      return;
    }
    Grains coarse, fine;
    for (std::size_t k = 0; k < radius.size(); ++k) {
      Grains& part = coarse_one(radius[k]) ? coarse : fine;
      part.numbers.push_back(rest.numbers.empty() ? static_cast<Index>(k) : rest.numbers[k]);
      part.x.push_back(places.x[k]);
      part.y.push_back(places.y[k]);
      if (!places.z.empty()) part.z.push_back(places.z[k]);
      part.radius.push_back(radius[k]);
    }
    CellGrid own(coarse.places(), 2 * reach);
    levels_.push_back({std::move(coarse), reach, std::move(own)});
    rest = std::move(fine);
    places = rest.places(), radius = rest.radius;
  }
}

PeriodicPlaces::PeriodicPlaces(const Places& places, std::span<const double> radii, const Period& period,
                               double reach) {
  const auto add = [&](const std::array<double, 3>& place, double r, Index number) {
    x.push_back(place[0]);
    y.push_back(place[1]);
    if (!places.z.empty()) z.push_back(place[2]);
    radius.push_back(r);
    grain.push_back(number);
  };
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const std::array<double, 3> place{places.x[i], places.y[i], places.z.empty() ? 0 : places.z[i]};
    const auto step = period.into_cell(place);
    add({place[0] + step[0], place[1] + step[1], place[2]}, radii[i], static_cast<Index>(i));
  }
  const std::size_t grains = radii.size();
  const auto near_beginning = [&](double coordinate, double length) { return length > 0 && coordinate < reach; };
  const auto near_end = [&](double coordinate, double length) { return length > 0 && coordinate > length - reach; };
  for (std::size_t i = 0; i < grains; ++i) {
    const std::array<double, 3> place{x[i], y[i], z.empty() ? 0 : z[i]};
    const bool left = near_beginning(place[0], period.x);
    const auto image = [&](double dx, double dy) {
      add({place[0] + dx, place[1] + dy, place[2]}, radius[i], static_cast<Index>(i));
    };
    if (left) image(period.x, 0);
    if (near_beginning(place[1], period.y)) image(0, period.y);
    if (left && near_beginning(place[1], period.y)) image(period.x, period.y);
    if (left && near_end(place[1], period.y)) image(period.x, -period.y);
  }
}

}  // namespace nscdd
