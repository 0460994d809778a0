// SPDX-License-Identifier: GPL-3.0-or-later
#include "packing/statistics.hpp"

#include "linalg/scalar.hpp"
#include "packing/bed_cells.hpp"

#include <numbers>

namespace nscdd {
namespace {

using std::numbers::pi;

// From the lowest to the highest point of grains along one direction.
struct Extent {
  double low, high;
  double length() const { return high - low; }
  Extent middle_half() const { return {low + 0.25 * length(), high - 0.25 * length()}; }
};

Extent extent_of(const std::vector<double>& centres, const std::vector<double>& radii) {
  const auto numbers = [](const std::vector<double>& values) { return Vector::Map(values.data(), count(values)); };
  const auto c = numbers(centres), r = numbers(radii);
  return {(c - r).minCoeff(), (c + r).maxCoeff()};
}

// Area of the unit disk in x <= a, for -1 <= a <= 1.
double cap_area(double a) { return 0.5 * pi + a * std::sqrt((1 - a) * (1 + a)) + std::asin(a); }

// Area of a disk in a rectangle, by inclusion and exclusion of its four corners.
double area_in(const Extent& width, const Extent& height, double x, double y, double radius) {
  const double left = (width.low - x) / radius, right = (width.high - x) / radius;
  const double low = (height.low - y) / radius, high = (height.high - y) / radius;
  const double share = left <= -1 && low <= -1 && right >= 1 && high >= 1
                           ? pi
                           : disk_corner_area(right, high) - disk_corner_area(left, high) -
                                 disk_corner_area(right, low) + disk_corner_area(left, low);
  return share * radius * radius;
}

double cubed(double r) { return r * r * r; }

SolidFraction solid_fraction_in_space(const Packing& packing, const std::array<Extent, 3>& box) {
  const std::array middle{box[0].middle_half(), box[1].middle_half(), box[2].middle_half()};
  double all = 0, in_middle = 0, whole = 1;
  for (Index i = 0; i < packing.size(); ++i) {
    const double radius = packing.radius[at(i)];
    const std::array<double, 3> centre = packing.centre(i);
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = (middle[k].low - centre[k]) / radius;
      high[k] = (middle[k].high - centre[k]) / radius;
    }
    all += cubed(radius);
    in_middle += cubed(radius) * sphere_box_volume(low, high);
  }
  for (const Extent& extent : box) whole *= extent.length();
  return {4 * pi / 3 * all / whole, in_middle / (whole / 8)};
}

}  // namespace

double sphere_box_volume(const std::array<double, 3>& low, const std::array<double, 3>& high) {
  const double highest_low = std::ranges::max(low), lowest_high = std::ranges::min(high);
  if (highest_low >= 1 || lowest_high <= -1) return 0;
  if (highest_low <= -1 && lowest_high >= 1) return 4 * pi / 3;
  // z = sin t: the disk at z has the radius cos t.
  const auto slice = [&](double t) {
    return std::cos(t) * area_in({low[0], high[0]}, {low[1], high[1]}, 0, 0, std::cos(t));
  };
  // The area has kinks where the disk begins to reach over a side or a corner: the integral is taken between them.
  const double from = std::asin(std::max(low[2], -1.0)), to = std::asin(std::min(high[2], 1.0));
  std::vector<double> ends{from, to};
  const auto add_kinks = [&](double reach) {
    if (reach >= 1) return;
    for (const double t : {-std::acos(reach), std::acos(reach)})
      if (t > from && t < to) ends.push_back(t);
  };
  for (const double x : {low[0], high[0]}) {
    add_kinks(std::abs(x));
    for (const double y : {low[1], high[1]}) add_kinks(std::hypot(x, y));
  }
  for (const double y : {low[1], high[1]}) add_kinks(std::abs(y));
  std::sort(ends.begin(), ends.end());
  double volume = 0;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i)
    if (ends[i] < ends[i + 1]) volume += integral(slice, ends[i], ends[i + 1], 5e-12);
  return volume;
}

double disk_corner_area(double a, double b) {
  if (a <= -1 || b <= -1) return 0;
  a = std::min(a, 1.0);
  b = std::min(b, 1.0);
  if (a * a + b * b < 1)  // the corner lies in the disk
    return a * b + 0.5 * (cap_area(a) + cap_area(b)) - 0.25 * pi;
  if (a < 0 && b < 0) return 0;
  if (a < 0) return cap_area(a);
  if (b < 0) return cap_area(b);
  return cap_area(a) + cap_area(b) - pi;  // the disk without two caps
}

SolidFraction solid_fraction(const Packing& given, const Period& period) {
  Packing packing = given;
  for (Index i = 0; i < packing.size(); ++i) {
    const std::array<double, 3> step = period.into_cell(packing.centre(i));
    packing.x[at(i)] += step[0];
    packing.y[at(i)] += step[1];
  }
  const Extent x = period.x > 0 ? Extent{0, period.x} : extent_of(packing.x, packing.radius),
               y = period.y > 0 ? Extent{0, period.y} : extent_of(packing.y, packing.radius);
  if (packing.dimension() == 3) return solid_fraction_in_space(packing, {x, y, extent_of(packing.z, packing.radius)});
  const Extent half_x = x.middle_half(), half_y = y.middle_half();
  double in_middle = 0;
  for (std::size_t i = 0; i < packing.x.size(); ++i)
    in_middle += area_in(half_x, half_y, packing.x[i], packing.y[i], packing.radius[i]);
  return {total_measure(packing.radius, false) / (x.length() * y.length()),
          in_middle / (half_x.length() * half_y.length())};
}

std::vector<char> rattlers(const ContactNetwork& network) {
  std::vector<Index> left = contact_counts(network);
  std::vector<std::vector<Index>> neighbours(left.size());
  for (const Contact& contact : network.contacts) {
    neighbours[at(contact.a)].push_back(contact.b);
    neighbours[at(contact.b)].push_back(contact.a);
  }
  std::vector<char> loose(left.size(), 0);
  std::vector<Index> found;
  const auto drop_where_loose = [&](Index i) {
    if (loose[at(i)] != 0 || left[at(i)] >= network.dimension) return;
    loose[at(i)] = 1;
    found.push_back(i);
  };
  for (Index i = 0; i < network.grains; ++i) drop_where_loose(i);
  while (!found.empty()) {
    const Index i = found.back();
    found.pop_back();
    for (const Index other : neighbours[at(i)]) {
      --left[at(other)];
      drop_where_loose(other);
    }
  }
  return loose;
}

std::vector<SizeClass> size_histogram(const Packing& packing, Index classes) {
  const auto [smallest, largest] = std::minmax_element(packing.radius.begin(), packing.radius.end());
  const double low = *smallest, span = *largest - low;
  if (span <= 1e-12 * *largest) classes = 1;
  std::vector<SizeClass> all(at(classes));
  const auto edge = [&](Index k) { return low + span * static_cast<double>(k) / static_cast<double>(classes); };
  for (Index k = 0; k < classes; ++k) all[at(k)] = {edge(k), k + 1 == classes ? *largest : edge(k + 1)};
  for (const double radius : packing.radius) {
    const double place = span > 0 ? (radius - low) / span * static_cast<double>(classes) : 0;
    SizeClass& one = all[at(std::min(classes - 1, static_cast<Index>(place)))];
    ++one.grains;
    one.measure += packing.dimension() == 2 ? pi * radius * radius : 4 * pi / 3 * cubed(radius);
  }
  return all;
}

}  // namespace nscdd
