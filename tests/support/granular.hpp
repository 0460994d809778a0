// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Small granular scenes for tests. Gravity is (0, -g) unless a test says otherwise.
namespace nscdd::testing {

inline constexpr double g = 9.81;  ///< m/s^2

/// One disk of a scene: where it is, how fast it starts.
struct Grain {
  double x = 0, y = 0, radius = 0.5, mass = 1;
  double velocity_x = 0, velocity_y = 0, spin = 0;
};

/// Parameters under which a step is solved by sweeps (plain Gauss-Seidel) from zero impulses, to zeta <= 1e-4.
Dynamics swept(const std::vector<BoundarySpec>& boundaries = {});

/// The same to rounding: natural map below 1e-13, at most 200 000 sweeps.
Dynamics tight(const std::vector<BoundarySpec>& boundaries = {});

/// `tight` without gravity.
Dynamics without_gravity(const std::vector<BoundarySpec>& boundaries = {}, double step = 1e-3);

/// Algorithm 1 to 1e-7, whose subdomains take `model` after 5 iterations without a change of status.
StepSolver switching(SwitchedModel model);

/// The straight wall through `from` and `to`, grains on its left.
BoundarySpec wall(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, Motion motion = {});

/// Floor y = 0 at rest.
BoundarySpec floor_wall();

/// A row of driven disks that touch.
BoundarySpec row_of_disks(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, double radius,
                          Motion motion = {});

/// Grains of the packing that are driven; negative numbers count from the end.
BoundarySpec driven_grains(const std::string& name, Index first, Index last, Motion motion = {});

/// A body that is free along these directions, by default all of the plane.
FreeBody free_body(double mass, double inertia,
                   std::array<bool, 6> directions = {true, true, false, false, false, true});

/// Grains first ... last as one rigid body about a centre.
BoundarySpec clump(const std::string& name, Index first, Index last, std::array<double, 2> centre, double mass,
                   double inertia, RigidVelocity velocity = {});

/// All points within a radius of a segment, about its middle.
BoundarySpec plank(const std::string& name, std::array<double, 2> from, std::array<double, 2> to, double radius);

/// Uniform motion.
Motion moving(RigidVelocity velocity, std::array<double, 2> centre = {0, 0});

Simulation simulation_of(const std::vector<Grain>& grains, const Dynamics& dynamics, std::array<Index, 2> grid = {1, 1},
                         const Period& period = {});

/// All that a state remembers, to compare two bit for bit.
std::vector<double> numbers_of(const GranularState& state);

/// Solves and takes one step; requires that the solver converged.
StepReport advance(Simulation& simulation);
StepReport advance(Simulation& simulation, Index steps);  ///< of the last step

/// Runs all steps. Returns why the run was refused or ended early, or nothing.
std::string refusal_of(Simulation& simulation);

/// Impulse of a contact in the last step taken, zero where there was none. Wall w is number disks + w.
LocalVector<2> impulse_between(const GranularState& state, Index a, Index b);

/// Grains of radii 0.1 ... 0.198 m dropped into a box with a floor and two walls, density 2 500 kg/m^2.
Simulation box_of_grains(Index grains, const Dynamics& dynamics, std::array<Index, 2> grid = {1, 1}, Index seed = 1);

/// Hexagonal lattice of touching unit disks, unit masses, random velocities. Overlaps are pushed apart at any speed.
Simulation shaken_lattice(Index columns, Index rows, const Dynamics& dynamics, std::array<Index, 2> grid = {1, 1},
                          std::uint64_t seed = 1);

/// max |V_a - V_b| over the first grains, or all, and their components, m/s.
template <int D>
double largest_difference(const std::vector<GrainVelocity<D>>& a, const std::vector<GrainVelocity<D>>& b,
                          std::optional<Index> grains = {}) {
  double largest = 0;
  for (std::size_t i = 0; i < at(grains.value_or(count(a))); ++i) {
    const GrainUnknowns<D> one = unknowns(a[i]), other = unknowns(b[i]);
    for (std::size_t k = 0; k < one.size(); ++k) largest = std::max(largest, std::abs(one[k] - other[k]));
  }
  return largest;
}

/// Largest speed of a velocity, m/s.
double largest_speed(const std::vector<GrainVelocity<2>>& v, Index disks);

/// Of every contact of a subdomain.
template <int D>
std::vector<ContactStatus> statuses_of(const ContactLaw& law, const GranularSubdomain<D>& subdomain) {
  std::vector<ContactStatus> statuses;
  for (std::size_t k = 0; k < subdomain.contacts.size(); ++k)
    statuses.push_back(status_of(law, subdomain.contacts.contact(k, subdomain.velocities)));
  return statuses;
}

/// A step iterated until impulses obey the law and copies move together (both to 1e-10, 60 000 iterations at
/// the most). Iterations may rest for thousands of sweeps while impulses drift along a direction that the
/// network can carry, until a contact opens: no criterion on changes would do.
struct Close {
  StepProblem<2> problem;
  std::vector<GrainContact<2>> contacts;
  std::vector<GrainVelocity<2>> velocities;
  double gluing = 1, map = 1;  ///< IterationRecord::gluing and the relative natural map at the end
  Index interface_size = 0, grains = 0;
};
Close closely(const Simulation& simulation);

/// Checks that copies move together, to 1e-9, and as the grains of `whole` do, to `tolerance`, m/s.
void check_close(const Close& step, const Close& whole, double tolerance = 1e-8);

/// |natural map| / |r| of Coulomb's law, contact by contact.
double relative_natural_map(const std::vector<GrainContact<2>>& contacts, const std::vector<GrainVelocity<2>>& v);

}  // namespace nscdd::testing
