// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulation/step_share.hpp"

#include <variant>

namespace nscdd {

/// A step that is prepared and solved, but not yet taken. Each of several processes has its share of problem,
/// partition, contacts and velocities.
template <int D>
struct SolvedStep {
  StepProblem<D> problem;
  Partition partition;                       ///< of its contacts
  ShareOfStep share;                         ///< empty where this process has all of the step
  std::vector<GrainContact<D>> contacts;     ///< with their impulses
  std::vector<GrainVelocity<D>> velocities;  ///< of the bodies of the problem
  std::vector<GrainMotion> all_grains;       ///< velocities of all grains
  ContactWork work;                          ///< of all contacts
  std::vector<Index> shared_grains;          ///< those that several subdomains hold, ascending
  std::vector<RememberedGluing> gluing;
  std::vector<RememberedModel> models;
  Vector interface_impulses;
  bool energy_exploded = false;  ///< it ends with far more energy than loads, boundaries and pushes can bring
  StepReport report;
};

/// A solved step of a simulation whose dimension is known when it runs.
using AnySolvedStep = std::variant<SolvedStep<2>, SolvedStep<3>>;

/// Where a solver broke down, by names and places: the first contact whose impulse is not finite, otherwise the first
/// disk with such a velocity, otherwise the contact with the largest impulse. `before`: what the step was solved from.
template <int D>
std::string describe_breakdown(const Simulation& before, const SolvedStep<D>& step);

}  // namespace nscdd
