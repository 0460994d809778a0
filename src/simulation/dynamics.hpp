// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/step_problem.hpp"
#include "two_stage/step_solver.hpp"
#include <nscdd/ddm/partitioner.hpp>
#include <nscdd/linalg/inertia_factor.hpp>

namespace nscdd {

enum class BoundaryShape {
  wall,      ///< in the plane the straight line through `from` and `to`, grains on its left; in space a plane
  disks,     ///< a row of disks in the plane from `from` to `to`, both ends included
  grains,    ///< grains first ... last of the packing, driven as one rigid body
  cylinder,  ///< in space, about the axis through `from` and `to`, unbounded along it
};
constexpr auto names_of(BoundaryShape) {
  return std::to_array<std::string_view>({"wall", "disks", "grains", "cylinder"});
}

/// The side of a cylinder that has the grains.
enum class CylinderSide { inside, outside };
constexpr auto names_of(CylinderSide) { return std::to_array<std::string_view>({"inside", "outside"}); }

/// A boundary as a case file describes it ([[boundary]]).
struct BoundarySpec {
  std::string name;
  Choice<BoundaryShape> shape = BoundaryShape::wall;
  Index dimension = 0;                               ///< of its vectors: 2, 3, or 0 if it has none
  std::array<double, 3> from{0, 0, 0}, to{1, 0, 0};  ///< m, disks and cylinder, and a wall in the plane
  std::array<double, 3> point{0, 0, 0};              ///< m, of a wall in space
  std::array<double, 3> normal{0, 0, 1};             ///< of a wall in space, towards its grains, of any length
  double radius = 0;                                 ///< m, disks and cylinder
  Choice<CylinderSide> side = CylinderSide::inside;  ///< of a cylinder
  double spacing = 0;          ///< m, largest distance of neighbouring centres, disks; 0: they touch (two radii)
  Index first = 0, last = -1;  ///< grains; negative from the end
  Motion motion;
  Choice<Orientation> orientation = Orientation::turning;  ///< disks and grains

  /// Largest distance of neighbouring centres, m.
  double distance() const { return spacing > 0 ? spacing : 2 * radius; }
};

/// The sections of a case that make it move: [interaction], [dynamics], [solver], [[boundary]].
struct Dynamics {
  Interaction interaction;
  TimeStepping time;
  StepSolver solver;
  std::vector<BoundarySpec> boundaries;
};

/// The sections of a case file, with a blank line before each. A parameter without effect is written with its default.
std::string to_toml(const Dynamics& dynamics);

/// Whether a parameter such as "solver.eta" has an effect with the values of the others.
bool has_effect(const Dynamics& dynamics, std::string_view path);

/// Throws Error naming `where`, and the other value it goes with, if the parameter has no effect.
void require_effect(const Dynamics& dynamics, std::string_view path, std::string_view where,
                    bool algorithm_stated = true);

/// Whether subdomains, if there are several, are switched between models.
bool switches_models(const Dynamics& dynamics);

/// Throws Error naming the boundary if a wall, an axis or a row of disks has no extent or a row has too many disks.
void check(const BoundarySpec& spec);

/// The system of a packing with masses and the boundaries of a case: grains, then disks of boundaries in their order.
/// Throws Error naming the boundary as `check`, if its range of grains is impossible or one of them is driven twice,
/// and if it has another dimension than the packing.
struct GranularScene {
  GranularSystem system;
  GranularState state;  ///< at time 0
};
GranularScene scene(const Packing& packing, const Dynamics& dynamics);

/// A granular system and how it moves. Only `state` changes in a run.
struct Simulation {
  GranularSystem system;
  GranularState state;
  Dynamics dynamics;
  Partitioner partitioner = GridPartitioner{};
  Processes processes = {};    ///< the ranks that share the subdomains of a step, each with the whole system and state
  InertiaMethod inertia = {};  ///< factorisation of Stage 2, see stage_two_inertia
};

inline StepStart start_of(const Simulation& simulation) {
  return {simulation.system, simulation.state, simulation.dynamics.interaction, simulation.dynamics.time};
}

/// Whether a run switches models. A single subdomain is plain Gauss-Seidel.
inline bool switches_models(const Simulation& simulation) {
  return switches_models(simulation.dynamics) && subdomains(simulation.partitioner) > 1;
}

}  // namespace nscdd
