// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular_solution.hpp"

#include <cmath>

namespace nscdd::testing {

Close closely(const Simulation& simulation) {
  PreparedStep<2> step = prepare_solution(simulation);
  Close result;
  for (int k = 1; k <= 60'000 && (result.gluing > 1e-10 || result.map > 1e-10); ++k) {
    step.iteration.iterate();
    result.gluing = step.iteration.record().gluing;
    if (k % 20 == 0) result.map = step.iteration.residual().relative_natural_map();
  }
  auto [contacts, velocities] = step.iteration.gather(step.problem);
  result.contacts = std::move(contacts);
  result.velocities = std::move(velocities);
  result.interface_size = step.iteration.parts().interface_size();
  result.problem = std::move(step.problem);
  return result;
}

double relative_natural_map(const std::vector<GrainContact<2>>& contacts, const std::vector<GrainVelocity<2>>& v) {
  double map = 0, impulses = 0;
  for (const GrainContact<2>& c : contacts) {
    const LocalVector<2> w = relative_velocity(c, v), r{c.impulse.n, c.impulse.t};
    const LocalVector<2> one = natural_map(r, {w.n + c.bias.n, w.t + c.bias.t}, c.friction, c.inverse_w.inverse_n);
    map += one.n * one.n + one.t * one.t;
    impulses += r.n * r.n + r.t * r.t;
  }
  return std::sqrt(map / impulses);
}

}  // namespace nscdd::testing
