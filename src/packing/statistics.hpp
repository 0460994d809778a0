// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nscdd/packing/packing.hpp>

namespace nscdd {

/// Area of grains over area, in space volume over volume, overlaps counted twice.
struct SolidFraction {
  /// In the smallest axis-parallel rectangle (box) around all grains; where they repeat themselves, in the cell.
  double box = 0;
  /// In the rectangle half as wide and half as high (in space half as deep too) about the same centre: that of the
  /// bulk, without the gaps along walls, floor and a rough top. Disks on its border are cut exactly, spheres to 10^-10.
  double middle = 0;
};
SolidFraction solid_fraction(const Packing& packing, const Period& period = {});

/// Volume of the unit sphere in the box low <= (x, y, z) <= high, to 10^-10, by integrals of exact areas over z.
double sphere_box_volume(const std::array<double, 3>& low, const std::array<double, 3>& high);

double disk_corner_area(double a, double b);  ///< area of the unit disk in x <= a, y <= b

/// Rattlers as flags: grains that no load can reach through contacts, those outside the 2-core of the contact graph (in
/// space the 3-core). A grain with fewer than two contacts (three in space) cannot be in equilibrium by contact forces
/// only; removing it takes a contact from its neighbour, and so on. A grain that leans on a wall, which is no grain,
/// may count as a rattler; in space a grain that two opposite ones squeeze does.
std::vector<char> rattlers(const ContactNetwork& network);

/// Grains of radius in [from, to), the last class with its upper end.
struct SizeClass {
  double from = 0, to = 0;  ///< m
  Index grains = 0;
  double measure = 0;  ///< area of those grains, m^2, or volume, m^3
};

/// Classes of equal width between the smallest and the largest radius; one class where these are equal to rounding.
std::vector<SizeClass> size_histogram(const Packing& packing, Index classes = 10);

}  // namespace nscdd
