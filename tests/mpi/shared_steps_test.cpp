// SPDX-License-Identifier: GPL-3.0-or-later
// What each process has of a step that several share.
#include "../support/granular.hpp"
#include "simulation/simulation.hpp"
#include <nscdd/mpi/processes.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

const Processes& all() {
  static const Processes processes = mpi::processes_of(MPI_COMM_WORLD);
  return processes;
}

Simulation shaken(const Processes& processes, const std::string& algorithm = "generic") {
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = algorithm;
  dynamics.solver.tolerance = algorithm == "generic" ? dynamics.solver.tolerance : 1e-10;
  dynamics.solver.interface_network = "none";  // the bits of one process
  dynamics.solver.redecompose = 3;
  Simulation simulation = shaken_lattice(9, 6, dynamics, {4, 2});
  simulation.processes = processes;
  return simulation;
}

// Steps of one process and of several, bit for bit.
void check_run(const std::string& algorithm) {
  CAPTURE(algorithm);
  Simulation alone = shaken({}, algorithm), shared = shaken(all(), algorithm);
  for (int step = 0; step < 5; ++step) {
    CAPTURE(step);
    const SolvedStep<2> whole = solve_step(alone), own = solve_step(shared);
    CHECK(all().sum(static_cast<double>(own.contacts.size())) == static_cast<double>(whole.contacts.size()));
    std::size_t k = 0;  // both lists ascend
    for (std::size_t c = 0; c < own.contacts.size(); ++c) {
      const StepContact& here = own.problem.geometry[c];
      while (k < whole.contacts.size() &&
             (whole.problem.geometry[k].a != here.a || whole.problem.geometry[k].b != here.b))
        ++k;
      REQUIRE(k < whole.contacts.size());
      CHECK(whole.contacts[k].impulse.n == own.contacts[c].impulse.n);
      CHECK(whole.contacts[k].impulse.t == own.contacts[c].impulse.t);
      CHECK(whole.partition.subdomain_of_contact[k] == own.partition.subdomain_of_contact[c]);
    }
    CHECK(own.all_grains == whole.all_grains);
    CHECK(own.problem.scale == whole.problem.scale);
    CHECK(own.report.contacts == whole.report.contacts);
    CHECK(own.report.overlap.mean == whole.report.overlap.mean);
    CHECK(own.report.last.sweeps == whole.report.last.sweeps);
    CHECK(own.report.factorisations == whole.report.factorisations);
    CHECK(own.report.residual.natural_map == whole.report.residual.natural_map);
    const StepReport expected = take_step(alone, whole), met = take_step(shared, own);
    CHECK(met.energy.dissipation == expected.energy.dissipation);
    CHECK(met.energy.kinetic == expected.energy.kinetic);
    CHECK(shared.state.x == alone.state.x);
    // Of every contact of its grains a process remembers the subdomain, and of its own contacts the impulse.
    for (const RememberedSubdomain& one : alone.state.subdomains) {
      const auto has = [&](Index grain) {
        return grain < alone.system.disks() && alone.system.free(grain) && body_of(own.problem, grain) >= 0;
      };
      const auto found = std::ranges::find_if(shared.state.subdomains, [&](const RememberedSubdomain& known) {
        return known.a == one.a && known.b == one.b && known.subdomain == one.subdomain;
      });
      if (has(one.a) || has(one.b)) CHECK(found != shared.state.subdomains.end());
    }
    CHECK(all().sum(static_cast<double>(shared.state.impulses.size())) ==
          static_cast<double>(alone.state.impulses.size()));
  }
}

}  // namespace

TEST_CASE("shared steps: every contact is in one process, which knows all contacts of its grains") {
  for (const std::string algorithm : {"generic", "two_stage_newton", "two_stage_admm"}) check_run(algorithm);
}

TEST_CASE("shared steps: processes that find other contacts all say so, and none waits") {
  if (all().alone()) return;
  for (const Index odd : {Index{0}, all().size - 1}) {
    Simulation one = shaken(all());
    if (all().rank == odd) one.dynamics.time.alert *= 40;
    CHECK_THROWS_WITH_AS(all().together([&] { return share_step<2>(one); }),
                         "processes: expected the same step in all of them, met others: their processors may differ",
                         Error);
  }
}
