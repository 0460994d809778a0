// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/case/case.hpp"

#include <cstdint>
#include <vector>

namespace nscdd::testing {

/// Two regular tetrahedra of spheres of diameter 1 m that share the face in z = 0, cut there: the four disks of [ADI12]
/// in space. 9 contacts, 9 interface unknowns, isostatic.
Case two_tetrahedra();

/// Six spheres of diameter 1 m on the axes, cut across x: 12 contacts, isostatic.
Case octahedron();

/// Spheres of random radii and masses, each put on three that touch each other: 3 n - 6 contacts, exact to rounding,
/// isostatic. Cut by a grid, some are shared by three subdomains or more.
Case sphere_cluster(std::uint64_t seed, Index grains, const Partitioner& partition);

/// A block of the face-centred cubic lattice of spheres of diameter 1 m with vacancies and random masses: those of its
/// sites_x x sites_y x sites_z half edges (i, j, k) whose sum is even. Hyperstatic, with cross points.
Case random_fcc(std::uint64_t seed, Index sites_x, Index sites_y, Index sites_z, const Partitioner& partition);

/// A close-packed lattice with a tenth to three tenths of its sites vacant, whose spheres were moved by up to 5/1000 of
/// a diameter and keep the contacts of the lattice: hyperstatic without order. Contacts that were dependent are so no
/// more, by singular values between 1e-7 and 1e-2.
Case disordered_fcc(std::uint64_t seed, double vacancies, const Partitioner& partition);

/// The disks of a case as spheres in the plane z = 0, with the masses that the disks have, loaded and cut alike.
Case flat(const Case& plane);

/// Those of `every_problem` that are in space.
std::vector<Case> spatial_problems();

}  // namespace nscdd::testing
