// SPDX-License-Identifier: GPL-3.0-or-later
// Where one disk that falls or rolls meets another.
#include "packing/drop_and_roll.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;

TEST_CASE("drop and roll: a disk falls onto another along a line") {
  CHECK(fall_onto({0, 1, 1}, 0, 1).value() == 3);
  CHECK(fall_onto({0, 1, 2}, 3, 3).value() == 5);  // 3-4-5
  CHECK(fall_onto({0, 1, 2}, -3, 3).value() == 5);
  CHECK_FALSE(fall_onto({0, 1, 1}, 2, 1));
  CHECK_FALSE(fall_onto({0, 1, 1}, -7, 1));
}

TEST_CASE("drop and roll: a disk rolls into the gap between two, from either side") {
  const Disk left{0, 1, 1}, right{3, 1, 1};
  const double height = 1 + std::sqrt(4 - 2.25);
  const Point from_left = roll_against(left, right, 1, Side::right).value();
  CHECK(from_left[0] == doctest::Approx(1.5));
  CHECK(from_left[1] == doctest::Approx(height));
  const Point from_right = roll_against(right, left, 1, Side::left).value();
  CHECK(from_right[0] == doctest::Approx(1.5));
  CHECK(from_right[1] == doctest::Approx(height));
  CHECK_FALSE(roll_against(left, {4.1, 1, 1}, 1, Side::right));
}

TEST_CASE("drop and roll: a small disk between a small one and a huge one touches both") {
  const Disk huge{0, 5000, 5000}, small{5000.4, 4999, 0.5};
  const Point c = roll_against(huge, small, 0.5, Side::right).value();
  CHECK(std::abs(std::hypot(c[0] - huge.x, c[1] - huge.y) - 5000.5) < 2e-12);
  CHECK(std::abs(std::hypot(c[0] - small.x, c[1] - small.y) - 1) < 2e-12);
  CHECK(c[1] > small.y);
}
