// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/step_problem.hpp"
#include "simulation/boundary.hpp"
#include "simulation/contact_pairs.hpp"
#include "two_stage/step_solver.hpp"
#include <nscdd/ddm/partitioner.hpp>
#include <nscdd/linalg/inertia_factor.hpp>

namespace nscdd {

/// The sections of a case that make it move: [interaction], [dynamics], [solver], [[boundary]], [[colour]], [[pair]].
struct Dynamics {
  Interaction interaction;
  TimeStepping time;
  StepSolver solver;
  std::vector<BoundarySpec> boundaries;
  std::vector<ColourSpec> colours = {};
  std::vector<PairSpec> pairs = {};
};

/// Throws Error, with the key, for a tolerance of 0 with a contact solver, for bddc, of symmetric systems, with
/// two_stage_newton, whose systems are not, and for gluing where nothing is cut.
void check(const StepSolver& solver);

/// The sections of a case file, with a blank line before each. A parameter without effect is written with its default.
std::string to_toml(const Dynamics& dynamics);

/// Whether a parameter such as "solver.eta" has an effect with the values of the others.
bool has_effect(const Dynamics& dynamics, std::string_view path);

/// Throws Error naming `where`, and the other value it goes with, if the parameter has no effect.
void require_effect(const Dynamics& dynamics, std::string_view path, std::string_view where,
                    bool algorithm_stated = true);

/// Whether subdomains, if there are several, are switched between models.
bool switches_models(const Dynamics& dynamics);

/// The system of a packing with masses and the boundaries of a case: grains, then disks of boundaries in their order.
/// Throws Error naming the boundary as `check`, if its range of grains is impossible or one of them is driven twice,
/// and if it has another dimension than the packing, and as check(Period).
struct GranularScene {
  GranularSystem system;
  GranularState state;  ///< at time 0
};
GranularScene scene(const Packing& packing, const Dynamics& dynamics, const Period& period = {});

/// Numbers the bodies with free directions, and sets their reach and the pairs of colours of a case. `first`: a state
/// in which poses and places of grains belong together. `grains`: of the packing.
void complete(GranularSystem& system, const GranularState& first, const Dynamics& dynamics, Index grains);

/// A granular system and how it moves. Only `state` changes in a run.
struct Simulation {
  GranularSystem system;
  GranularState state;
  Dynamics dynamics;
  Partitioner partitioner = GridPartitioner{};
  Processes processes = {};  ///< the ranks that share the subdomains of a step, each with the whole system and state
  InertiaMethod inertia = multifrontal();  ///< factorisation of Stage 2
  Bddc bddc = {};                          ///< set by nscdd-mpi, see CutOptions
};

inline StepStart start_of(const Simulation& simulation) {
  return {simulation.system, simulation.state, simulation.dynamics.interaction, simulation.dynamics.time};
}

/// Whether a run switches models. A single subdomain is plain Gauss-Seidel.
inline bool switches_models(const Simulation& simulation) {
  return switches_models(simulation.dynamics) && subdomains(simulation.partitioner) > 1;
}

}  // namespace nscdd
