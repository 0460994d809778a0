// SPDX-License-Identifier: GPL-3.0-or-later
// Algorithm 1 on the contact problem of a step: one subdomain is Gauss-Seidel to the last bit, any number of
// subdomains comes to the same velocities, whatever the variant, and no bit depends on threads.
#include "two_stage/granular_two_stage.hpp"

#include "../support/granular.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Bits of numbers, one behind the other.
struct Bits {
  std::vector<std::uint64_t> all = {};

  void add(const auto& numbers) {
    for (const double one : numbers) all.push_back(std::bit_cast<std::uint64_t>(one));
  }
  bool operator==(const Bits&) const = default;
};

// Of everything that a step finds.
Bits bits_of(const GranularStep<2>& step) {
  Bits bits{{step.contacts.size()}};
  for (const GrainContact<2>& c : step.contacts) bits.add(std::array{c.impulse.n, c.impulse.t});
  for (const GrainVelocity<2>& v : step.velocities) bits.add(std::array{v.x, v.y, v.rim});
  return bits;
}

// Of everything that moves.
Bits bits_of(const GranularState& s) {
  Bits bits;
  for (const auto* field : {&s.x, &s.y, &s.angle, &s.velocity_x, &s.velocity_y, &s.spin}) bits.add(*field);
  for (const RememberedImpulse& one : s.impulses) bits.add(one.impulse);
  for (const RememberedGluing& one : s.gluing) bits.add(one.impulse);
  return bits;
}

struct Variant {
  std::string name, algorithm = "generic", eta = "1";
  Index sweeps = 1;
  std::string method = "richardson", enrichment = "every_iteration", network = "all";
  double omega = 1;
};

void set(StepSolver& solver, const Variant& v) {
  solver.algorithm = v.algorithm;
  solver.eta = v.eta;
  solver.gauss_seidel_sweeps = v.sweeps;
  solver.interface_method = v.method;
  solver.enrichment = v.enrichment;
  solver.network = v.network;
  solver.interface_relaxation = v.omega;
}

Dynamics shaking(const std::string& law, const std::optional<Variant>& variant = {}) {
  Dynamics dynamics = tight();
  dynamics.interaction.law = law;
  dynamics.interaction.friction = 0.4;
  dynamics.solver.tolerance = 1e-11;
  if (variant) set(dynamics.solver, *variant);
  return dynamics;
}

// Flexibilities far below 1 / mass make Stage 2 too stiff and diverge, as the analysis of active contacts says.
std::vector<Variant> variants() {
  return {{.name = "generic"},
          {.name = "generic, 10 sweeps", .sweeps = 10},
          {.name = "generic, relaxed", .sweeps = 2, .omega = 0.6},
          {.name = "generic, conjugate gradient", .sweeps = 10, .method = "conjugate_gradient"},
          {.name = "enriched, eta 30", .algorithm = "enriched", .eta = "30"},
          {.name = "enriched, eta 40", .algorithm = "enriched", .eta = "40", .sweeps = 10},
          {.name = "enriched, eta 5, relaxed", .algorithm = "enriched", .eta = "5", .sweeps = 10, .omega = 0.4},
          {.name = "enriched, conjugate gradient",
           .algorithm = "enriched",
           .eta = "20",
           .sweeps = 10,
           .method = "conjugate_gradient"},
          {.name = "enriched once", .algorithm = "enriched", .eta = "3", .sweeps = 3, .enrichment = "first_iteration"},
          {.name = "schwarz", .algorithm = "schwarz"},
          {.name = "schwarz, relaxed", .algorithm = "schwarz", .sweeps = 10, .omega = 0.45}};
}

// One sweep as a textbook has it: contact by contact v = H^T V, the local solution, V += M^-1 H dr, dr relaxed.
void sweep_by_hand(const ContactLaw& law, double relaxation, std::vector<GrainContact<2>>& contacts,
                   std::vector<GrainVelocity<2>>& v) {
  for (GrainContact<2>& c : contacts) {
    GrainVelocity<2>&a = v[static_cast<std::size_t>(c.a)], &b = v[static_cast<std::size_t>(c.b)];
    const double dx = b.x - a.x, dy = b.y - a.y;
    const double v_n = c.normal[0] * dx + c.normal[1] * dy + c.bias.n;
    const double v_t = c.normal[0] * dy - c.normal[1] * dx - (a.rim + b.rim) + c.bias.t;
    const LocalVector<2> stop{c.impulse.n - c.inverse_w().inverse_n * v_n, c.impulse.t - c.inverse_w().inverse_t * v_t};
    LocalVector<2> r =
        std::visit([&](const auto& one) { return law_at(one, c.pull).impulse(stop, c.inverse_w(), c.friction); }, law);
    if (relaxation != 1)
      r = {c.impulse.n + relaxation * (r.n - c.impulse.n), c.impulse.t + relaxation * (r.t - c.impulse.t)};
    apply_impulse(c, {r.n - c.impulse.n, r.t - c.impulse.t}, v);
    c.impulse.n = r.n;
    c.impulse.t = r.t;
  }
}

// A step swept by hand, without any decomposition.
GranularStep<2> swept_by_hand(const GranularStep<2>& step, const Dynamics& dynamics, int sweeps) {
  const StepProblem<2>& problem = step.problem;
  const ContactLaw law = problem.law;
  GreedyColours taken(count(problem.free));
  const std::vector<Index> visit =
      contact_order(dynamics.solver.order, problem, natural_order(count(problem.contacts)), 1, taken);
  std::vector<GrainContact<2>> contacts;
  for (const Index c : visit) contacts.push_back(problem.contacts[at(c)]);
  GranularStep<2> by_hand = step;
  by_hand.velocities = problem.free;
  for (int k = 0; k < sweeps; ++k) sweep_by_hand(law, dynamics.solver.contact_relaxation, contacts, by_hand.velocities);
  for (std::size_t k = 0; k < visit.size(); ++k) by_hand.contacts[at(visit[k])] = contacts[k];
  return by_hand;
}

Close cut_and_closely(Simulation whole, std::array<Index, 2> grid, const Variant& variant) {
  whole.partitioner = GridPartitioner{grid};
  set(whole.dynamics.solver, variant);
  return closely(whole);
}

}  // namespace

TEST_CASE("one subdomain, generic, enriched or schwarz, is plain Gauss-Seidel and a loop over sweeps, bit for bit") {
  struct Local {
    double relaxation, tangential_restitution;
  };
  for (const Local local : {Local{1, 0}, {0.7, 0}, {1.5, 0.4}})
    for (const std::string order : {"natural", "reverse", "random", "coloured", "interleaved"})
      for (const std::string law : {"coulomb", "frictionless", "cohesive", "linear_viscous"}) {
        INFO("relaxation = ", local.relaxation, ", order = ", order, ", law = ", law);
        Dynamics dynamics = shaking(law);
        dynamics.interaction.cohesion = 20;
        dynamics.interaction.epsilon = 0.1;
        dynamics.interaction.tangential_restitution = local.tangential_restitution;
        dynamics.solver.contact_relaxation = local.relaxation;
        dynamics.solver.order = order;
        dynamics.solver.criterion = "none";
        dynamics.solver.maximum_iterations = 12;
        Simulation simulation = shaken_lattice(7, 6, dynamics, {1, 1});
        const GranularStep<2> plain = solve_step(simulation);
        const Bits expected = bits_of(plain);
        for (const std::string algorithm : {"generic", "enriched", "schwarz"}) {
          simulation.dynamics.solver.algorithm = algorithm;
          CHECK(bits_of(solve_step(simulation)) == expected);
        }
        simulation.dynamics.solver.gauss_seidel_sweeps = 4;  // 3 iterations of 4 are 12 sweeps
        simulation.dynamics.solver.maximum_iterations = 3;
        CHECK(bits_of(solve_step(simulation)) == expected);
        CHECK(bits_of(swept_by_hand(plain, dynamics, 12)) == expected);
      }
}

TEST_CASE("frictionless: any subdomains, variant, order and relaxation come to the velocities of the whole") {
  const Simulation whole = shaken_lattice(6, 6, shaking("frictionless"));
  const Close reference = closely(whole);
  REQUIRE(reference.map < 1e-10);
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}, {3, 3}})
    for (const Variant& variant : variants()) {
      INFO("grid ", grid[0], " x ", grid[1], ", name = ", variant.name);
      const Close step = cut_and_closely(whole, grid, variant);
      CHECK(step.interface_size > 0);
      CHECK(step.map < 1e-9);
      check_close(step, reference);
    }
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{1, 1}, {2, 2}})
    for (const std::string order : {"natural", "reverse", "random", "coloured", "interleaved"})
      for (const double relaxation : {0.7, 1.0, 1.5}) {
        INFO("grid[0] = ", grid[0], ", order = ", order, ", relaxation = ", relaxation);
        Simulation other = whole;
        other.partitioner = GridPartitioner{grid};
        other.dynamics.solver.algorithm = "generic";
        other.dynamics.solver.order = order;
        other.dynamics.solver.contact_relaxation = relaxation;
        check_close(closely(other), reference);
      }
  // Stage 2 links no rims, so that a flexibility of 1 / mass converges.
  for (const std::string network : {"all", "active"})
    for (const std::string eta : {"1", "3"}) {
      INFO("network = ", network, ", eta = ", eta);
      const Variant variant{.name = "", .algorithm = "enriched", .eta = eta, .sweeps = 10, .network = network};
      check_close(cut_and_closely(whole, {2, 1}, variant), reference);
    }
  Simulation parts = whole;
  parts.partitioner = MetisPartitioner{.metis = 5, .seed = 1};
  set(parts.dynamics.solver, {.name = "generic", .sweeps = 5});
  check_close(closely(parts), reference);
}

TEST_CASE("friction: whatever the variant, glued copies obey Coulomb's law as closely as the whole does") {
  constexpr double law_tolerance = 1e-8;
  const Simulation whole = shaken_lattice(6, 6, shaking("coulomb"));
  const Close reference = closely(whole);
  CHECK(relative_natural_map(reference.contacts, velocities_of(reference.problem, reference.contacts)) < law_tolerance);
  for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}, {3, 3}})
    for (const Variant& variant : variants()) {
      INFO("grid ", grid[0], " x ", grid[1], ", name = ", variant.name);
      const Close step = cut_and_closely(whole, grid, variant);
      CHECK(step.gluing < 1e-9);
      // At the velocities that V_free + M^-1 H r gives, nothing of the copies.
      const std::vector<GrainVelocity<2>> v = velocities_of(step.problem, step.contacts);
      CHECK(relative_natural_map(step.contacts, v) < law_tolerance);
      CHECK(largest_difference(step.velocities, v, whole.system.grains()) < 1e-10);
    }
}

TEST_CASE("a criterion that is looked at in every k-th iteration ends the same iterations at the next such one") {
  for (const std::string criterion : {"natural_map", "zeta"}) {
    CAPTURE(criterion);
    const auto solved = [&](Index interval, Index most, Index every) {
      Dynamics dynamics = shaking("coulomb", variants().front());
      dynamics.solver.criterion = criterion;
      dynamics.solver.tolerance = 1e-4;
      dynamics.solver.criterion_interval = interval;
      dynamics.solver.maximum_iterations = most;
      std::vector<IterationRow> rows;
      const IterationSink sink{.row = [&](const IterationRow& row) { rows.push_back(row); }, .every = every};
      const GranularStep<2> step = solve_step(shaken_lattice(6, 6, dynamics, {3, 2}), sink);
      return std::pair(step, rows);
    };
    const auto [plain, every] = solved(1, 20'000, 1);
    const Index needed = plain.report.last.iteration;
    REQUIRE(plain.report.status == SolverStatus::converged);
    REQUIRE(needed > 20);
    for (const Index interval : {Index{2}, Index{7}, needed - 1, needed + 3}) {
      CAPTURE(interval);
      const auto [step, rows] = solved(interval, 20'000, 3);
      CHECK(step.report.status == SolverStatus::converged);
      CHECK(step.report.last.iteration == (needed + interval - 1) / interval * interval);
      for (const IterationRow& row : rows)  // a row looks at no other iterations
        if (row.record.iteration <= needed) {
          CHECK(row.record.zeta == every[at(row.record.iteration - 1)].record.zeta);
          CHECK(row.residual.natural_map == every[at(row.record.iteration - 1)].residual.natural_map);
        }
    }
    // The last iteration allowed is looked at, whatever the interval.
    CHECK(solved(1'000'000, needed, 0).first.report.status == SolverStatus::converged);
    CHECK(solved(1'000'000, needed - 1, 0).first.report.status == SolverStatus::maximum_reached);
  }
}

TEST_CASE("mean velocities of copies are V_free + M^-1 H r at every iteration, converged or not") {
  for (const Variant& variant : variants())
    for (const Index iterations : {Index{1}, Index{2}, Index{7}}) {
      INFO("name = ", variant.name, ", iterations = ", iterations);
      Dynamics dynamics = shaking("coulomb", variant);
      dynamics.solver.criterion = "none";
      dynamics.solver.maximum_iterations = iterations;
      const Simulation simulation = shaken_lattice(6, 6, dynamics, {3, 2});
      const GranularStep<2> step = solve_step(simulation);
      const Index n = simulation.system.grains();
      CHECK(largest_difference(step.velocities, velocities_of(step.problem, step.contacts), n) <
            1e-13 * (1 + largest_speed(step.velocities, n)));
    }
}

TEST_CASE("the generic Stage 2 brings the copies of every grain together at once, and keeps their momentum") {
  const Dynamics dynamics = shaking("coulomb", Variant{.name = "generic"});
  const PreparedStep<2> step = prepare_solution(shaken_lattice(6, 6, dynamics, {3, 3}));
  GranularDecomposition<2> parts = step.iteration.parts();
  RandomStream random(5);
  for (GranularSubdomain<2>& subdomain : parts.subdomains)
    for (GrainVelocity<2>& v : subdomain.velocities)
      for (double* component : {&v.x, &v.y, &v.rim}) *component = 2 * random.uniform() - 1;
  const auto momentum = [&] {
    Eigen::Vector3d sum{0, 0, 0};
    for (const GranularSubdomain<2>& subdomain : parts.subdomains)
      for (const GrainVelocity<2>& v : subdomain.velocities)
        sum += Eigen::Vector3d(v.x, v.y, v.rim) / v.inverse_mass;  // of equal disks
    return sum;
  };
  const Vector jumps = parts.interface_jumps();
  const Eigen::Vector3d before = momentum();
  REQUIRE(jumps.norm() > 1);
  parts.apply_interface_impulses(parts.generic_interface_solve(jumps));
  CHECK(parts.interface_jumps().norm() < 1e-13 * jumps.norm());
  CHECK((momentum() - before).norm() < 1e-12);
}

TEST_CASE("a step that starts from the impulses and the gluing of another is where that was, cross points too") {
  const Dynamics dynamics = shaking("coulomb", Variant{.name = "generic"});
  const Simulation simulation = shaken_lattice(6, 6, dynamics, {3, 3});
  PreparedStep<2> step = prepare_solution(simulation);
  Index cross_points = 0;
  for (Index grain = 0; grain < simulation.system.grains(); ++grain)
    cross_points += step.iteration.parts().interface.multiplicity(grain) > 2;
  REQUIRE(cross_points > 0);
  for (int k = 0; k < 7; ++k) step.iteration.iterate();
  GranularTwoStage<2>& met = step.iteration;
  StepProblem<2> problem = step.share.problem;
  problem.contacts = met.gather(step.share.problem).contacts;
  GranularTwoStage<2> started(decompose(problem, step.share.partition, dynamics.solver.order, 1), problem.law,
                              dynamics.solver, {});
  started.start(met.gluing());
  CHECK((started.interface_impulses() - met.interface_impulses()).norm() < 1e-12 * met.interface_impulses().norm());
  for (std::size_t e = 0; e < met.parts().subdomains.size(); ++e) {
    const auto& copies = met.parts().subdomains[e].velocities;
    CHECK(largest_difference(started.parts().subdomains[e].velocities, copies, count(copies)) < 1e-12);
  }
}

TEST_CASE("conjugate gradients glue a linear step of n interface unknowns in n iterations") {
  Dynamics dynamics = shaking("linear_viscous", Variant{.name = "", .sweeps = 300, .method = "conjugate_gradient"});
  dynamics.interaction.epsilon = 1;
  dynamics.time.step = 1e-5;  // disks touch
  PreparedStep<2> step = prepare_solution(shaken_lattice(4, 4, dynamics, {2, 1}));
  const Index n = step.iteration.parts().interface_size();
  REQUIRE(n >= 9);
  double first = 0, last = 0;
  for (Index k = 1; k <= n + 1; ++k) {
    step.iteration.iterate();
    last = step.iteration.record().gluing;
    if (k == 1) first = last;
  }
  CHECK(last < 1e-11 * first);
}

TEST_CASE("semi-implicit: the interface is solved once, then left alone") {
  const Variant variant{.name = "", .algorithm = "enriched", .eta = "0.1", .sweeps = 3, .enrichment = "semi_implicit"};
  Dynamics dynamics = shaking("frictionless", variant);
  dynamics.solver.criterion = "none";
  dynamics.solver.maximum_iterations = 1;
  Simulation simulation = shaken_lattice(6, 6, dynamics, {2, 2});
  const GranularStep<2> first = solve_step(simulation);
  simulation.dynamics.solver.maximum_iterations = 40;
  Index rows = 0;
  const GranularStep<2> last = solve_step(simulation, {[&](const IterationRow& row) {
                                            ++rows;
                                            if (row.record.iteration > 1) CHECK(row.record.interface_change == 0);
                                          }});
  CHECK(rows == 40);
  CHECK(first.interface_impulses.norm() > 0);
  CHECK(first.interface_impulses == last.interface_impulses);
}

TEST_CASE("determinism: 300 grains, 15 steps, the same final state to the last bit for 1 to 4 threads") {
  for (const std::string algorithm : {"generic", "enriched"}) {
    CAPTURE(algorithm);
    Bits first;
    for (Index threads = 1; threads <= 4; ++threads) {
      const ThreadLimit limit(threads);
      Dynamics dynamics = swept();
      dynamics.solver.algorithm = algorithm;
      dynamics.solver.maximum_iterations = 30;
      dynamics.solver.warm_start = true;
      Simulation simulation = box_of_grains(300, dynamics, {3, 2});
      with_threads([&] {
        for (int k = 0; k < 15; ++k) take_step(simulation, solve_step(simulation));
      });
      const Bits found = bits_of(simulation.state);
      if (threads == 1) first = found;
      CHECK(found == first);
    }
  }
}

TEST_CASE("warm start: a column and a pile that friction holds, at rest, cost a fraction of their first step") {
  const auto check_cost = [](const std::string& algorithm, double friction, const std::vector<Grain>& grains,
                             std::array<Index, 2> grid) {
    INFO("algorithm = ", algorithm, ", friction = ", friction);
    Dynamics dynamics = tight({floor_wall()});
    dynamics.interaction.friction = friction;
    dynamics.solver.algorithm = algorithm;
    dynamics.solver.criterion = "zeta";
    dynamics.solver.tolerance = 1e-12;
    dynamics.solver.warm_start = true;
    Simulation simulation = simulation_of(grains, dynamics, grid);
    const Index cold = advance(simulation).last.iteration;
    CHECK(cold > 20);
    advance(simulation, 3);
    CHECK(advance(simulation).last.iteration <= cold / 5);
  };
  // Blocks at rest: the impulses of one step are those of the next.
  std::vector<Grain> column;
  for (int k = 0; k < 5; ++k) column.push_back({.x = 0, .y = 0.5 + k});
  for (const std::string algorithm : {"nlgs", "generic"}) check_cost(algorithm, 0.3, column, {1, 3});
  check_cost("nlgs", 0.5, {{.x = -0.5, .y = 0.5}, {.x = 0.5, .y = 0.5}, {.x = 0, .y = 0.5 + std::sqrt(0.75)}}, {1, 1});
}

TEST_CASE("contact solvers on the whole packing meet the law, cohesion and restitution too, as sweeps do") {
  for (const std::string law : {"coulomb", "frictionless", "cohesive"})
    for (const double restitution : {0.0, 0.4}) {
      INFO("law = ", law, ", restitution = ", restitution);
      Dynamics dynamics = shaking(law);
      dynamics.interaction.cohesion = 20;
      dynamics.interaction.restitution = dynamics.interaction.tangential_restitution = restitution;
      dynamics.solver.criterion = "natural_map";
      dynamics.solver.maximum_iterations = 100'000;
      Simulation simulation = shaken_lattice(7, 6, dynamics, {1, 1});
      for (int step = 0; step < 3; ++step) {
        const GranularStep<2> swept = solve_step(simulation);
        const bool comparable = swept.report.residual.relative_natural_map() < 1e-9;
        CHECK((comparable || restitution > 0));  // there sweeps may stall at 10^-6
        for (const std::string algorithm : {"auto", "continuation", "admm"}) {
          if (algorithm == "admm" && restitution > 0) continue;  // it may end at 10^-6, as sweeps do
          CAPTURE(algorithm);
          Simulation other = simulation;
          other.dynamics.solver.algorithm = algorithm;
          other.dynamics.solver.tolerance = 1e-10;
          Index rows = 0;
          const GranularStep<2> found = solve_step(other, {[&](const IterationRow& row) { rows += row.step > 0; }});
          CHECK(found.report.status == SolverStatus::converged);
          CHECK(rows == found.report.last.iteration);
          CHECK(contact_residual(found.problem.law, found.contacts, found.velocities).relative_natural_map() < 1e-9);
          if (!comparable) continue;
          // Impulses need not be unique, nor which contacts have any; where grains go is, next to always.
          for (std::size_t i = 0; i < swept.velocities.size(); ++i) {
            CHECK(found.velocities[i].x == doctest::Approx(swept.velocities[i].x).epsilon(1e-5).scale(1));
            CHECK(found.velocities[i].y == doctest::Approx(swept.velocities[i].y).epsilon(1e-5).scale(1));
          }
        }
        take_step(simulation, swept);
      }
    }
}
