// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "spatial_problems.hpp"
#include "study/case/case.hpp"
#include <nscdd/ddm/decomposition.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace nscdd::testing {

/// A strip of n disks as in [ADI12] Figures 2-4: two subdomains, the last grain arriving at -1 m/s.
Case strip(Index grains);

/// A piece of hexagonal lattice with vacancies and random masses, cut by a grid: contacts are exact, some
/// grains are shared by three or four subdomains, some parts are hyperstatic, some grains may touch nothing.
Case random_lattice(std::uint64_t seed, Index columns, Index rows, Components<Index> grid);

/// The problems in the plane that every law is tested on: the paper's three, hyperstatic lattices with cross points,
/// METIS parts, a cut with empty subdomains.
std::vector<Case> plane_problems();

/// These, and the `spatial_problems`: the laws know no dimension.
std::vector<Case> every_problem();

/// Those whose subdomains share a grain.
std::vector<Case> with_interface(std::vector<Case> all);

/// Runs `law` on the model of every problem that has an interface; half of them are in space.
void on_every_interface(const std::function<void(const Model&)>& law);

/// The packing of a case with its grains renumbered at random; the last grain stays the last.
Case renumbered(const Case& one, std::uint64_t seed);

/// The model of `one` with all coordinates rotated and shifted but the partition of `one` kept. In space the axis is
/// (1, 2, 2) / 3, and z is shifted by -shift_x.
Model moved(const Case& one, double angle, double shift_x, double shift_y);

/// The loads M_E V_E^- of grains that arrive with velocity V^- (d n entries), for every subdomain.
std::vector<Vector> impact_loads(const Decomposition& parts, const Vector& arriving_velocity);

/// Number of grains shared by more than two subdomains.
Index cross_points(const Decomposition& parts);

}  // namespace nscdd::testing
