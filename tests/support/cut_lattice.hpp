// SPDX-License-Identifier: GPL-3.0-or-later
// Linear systems of the contacts of a small step, whole and cut into subdomains.
#pragma once

#include "../support/granular.hpp"
#include "linalg/random.hpp"
#include "simulation/step_decomposition.hpp"
#include "two_stage/cut_contacts.hpp"

namespace nscdd::testing {

inline double random_of(RandomStream& stream) { return 2 * stream.uniform() - 1; }

inline Vector random_vector(RandomStream& stream, Index size) {
  Vector result(size);
  for (double& value : result) value = random_of(stream);
  return result;
}

// A third of the contacts open, a third sticks, a third slides.
inline std::vector<ContactRelation<2>> relations(Index contacts, double alpha, bool slides) {
  std::vector<ContactRelation<2>> result(at(contacts));
  for (Index c = 0; c < contacts; ++c) {
    if (c % 3 == 0) continue;
    ContactRelation<2>& one = result[at(c)];
    one.p(0, 0) = alpha;
    one.q(0, 0) = 1;
    if (c % 3 == 1 || !slides) {
      one.p(1, 1) = alpha;
      one.q(1, 1) = 1;
    } else {
      one.p(1, 0) = c % 2 == 0 ? 0.4 : -0.4;
    }
  }
  return result;
}

struct Cut {
  Decomposition parts;
  SparseMatrix w;  // H^T M^-1 H of the undivided step
  ReferenceProblem problem = {};
  Partition partition = {};  // of its columns
};
inline Cut cut_lattice(std::array<Index, 2> grid) {
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = "two_stage_newton";
  const Simulation simulation = shaken_lattice(6, 5, dynamics, grid);
  const StepProblem<2> problem = whole_step<2>(simulation);
  const ReferenceProblem whole = reference_problem(problem, simulation.system.grains());
  const SparseMatrix scaled = scaled_connectivity(whole.inertia, whole.h);
  const Partition partition = partition_of_columns(partition_step(simulation, problem.geometry), 2);
  return {decompose(whole, partition), scaled.transpose() * scaled, whole, partition};
}

}  // namespace nscdd::testing
