// SPDX-License-Identifier: GPL-3.0-or-later
// What residuals are measured against: no noise, and nothing that grows with the fault. Right values come from the
// momentum of the grains and from closed forms of sweeps; a change of units changes no bit.
#include "../support/granular.hpp"
#include "../support/sanitized.hpp"
#include "../support/spheres.hpp"
#include "../support/thorough.hpp"
#include "mechanics/contact_residual.hpp"
#include "simulation/contact_solver_step.hpp"
#include "study/moving/compared_rates.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Units in which a scene is told: kg, m, s.
struct Units {
  double mass = 1, length = 1, time = 1;
  double speed() const { return length / time; }
};
// Powers of two: 10^-9 and 10^12 kg, grains of a micrometre and of a kilometre.
const std::vector<Units> scales{{},
                                {std::ldexp(1, -30), 1, 1},
                                {std::ldexp(1, 40), 1, 1},
                                {1, std::ldexp(1, -20), 1},
                                {1, std::ldexp(1, 10), std::ldexp(1, 5)},
                                {std::ldexp(1, -30), std::ldexp(1, -20), std::ldexp(1, -10)}};

Dynamics dynamics_of(const std::string& algorithm, const Units& units = {}, const StepSolver& solver = {}) {
  Dynamics dynamics;
  dynamics.solver = solver;
  dynamics.time.gravity = {0, 0};
  dynamics.time.step = 0.005 * units.time;
  dynamics.interaction.friction = 0.3;
  dynamics.solver.algorithm = algorithm;
  return dynamics;
}

Grain in(const Units& units, Grain one) {
  return {one.x * units.length,  one.y * units.length,           one.radius * units.length,
          one.mass * units.mass, one.velocity_x * units.speed(), one.velocity_y * units.speed(),
          one.spin / units.time};
}

// A touching row that flies together, but for the last bits of two velocities.
std::vector<Grain> flying_row(const Units& units) {
  std::vector<Grain> row;
  for (int k = 0; k < 4; ++k) row.push_back({.x = k * 0.6, .y = k * 0.8, .velocity_x = 1.0 / 3, .velocity_y = 0.1});
  row[0].velocity_x = std::nextafter(1.0 / 3, 1);
  row[1].velocity_y = std::nextafter(0.1, 1);
  for (Grain& one : row) one = in(units, one);
  return row;
}

// Takes steps; returns the reports.
std::vector<StepReport> run(Simulation simulation, Index steps, GranularState* end = nullptr) {
  std::vector<StepReport> reports;
  in_dimension(simulation.system, [&](auto dimension) {
    for (Index k = 0; k < steps; ++k) {
      const auto step = solve_step<dimension()>(simulation);
      REQUIRE_FALSE(step.report.broke_down());
      reports.push_back(take_step(simulation, step));
    }
  });
  if (end != nullptr) *end = simulation.state;
  return reports;
}

// A disk between two walls, of which the right one closes.
Simulation closing_walls(const std::string& algorithm, const Units& units = {}, double gravity = 9.81,
                         double friction = 0.3, double room = 0) {
  Dynamics dynamics = dynamics_of(algorithm, units);
  dynamics.time.gravity = {0, -gravity * units.length / (units.time * units.time)};
  dynamics.interaction.friction = friction;
  const double l = units.length, right = 0.5 + room;
  dynamics.boundaries.push_back(wall("left", {-0.5 * l, 5 * l}, {-0.5 * l, -5 * l}));
  dynamics.boundaries.push_back(
      wall("right", {right * l, -5 * l}, {right * l, 5 * l}, moving({.x = -0.1 * units.speed()}, {right * l, 0})));
  return simulation_of({in(units, {.x = 0, .y = 0.5})}, dynamics);
}

// A boundary of one grain of the packing, and its velocity.
BoundarySpec driven(Index grain, const RigidVelocity& velocity) {
  return driven_grains("grain " + std::to_string(grain), grain, grain, moving(velocity));
}

// A row of three touching disks along x. The outer ones are driven at these speeds.
Simulation between_driven_disks(const std::string& algorithm, double left, double right, const Units& units = {}) {
  Dynamics dynamics = dynamics_of(algorithm, units);
  dynamics.boundaries = {driven(0, {.x = left * units.speed()}), driven(2, {.x = right * units.speed()})};
  return simulation_of({in(units, {}), in(units, {.x = 1}), in(units, {.x = 2})}, dynamics);
}

// Two contacts that ask for impulses that cancel: after k sweeps from zero r = (2 k - 1, 2 k) N s, u = (-2, 0) m/s.
LocalFrictionProblem squeezed(double scale = 1) {
  return {Matrix{{1, 0, -1, 0}, {0, 1, 0, 1}, {-1, 0, 1, 0}, {0, 1, 0, 1}}.sparseView(), scale * Vector{{-1, 0, -1, 0}},
          Vector::Constant(2, 0.3)};
}

}  // namespace

TEST_CASE("scale of natural maps: the larger of |r| and |r^1|, neither noise nor without bound") {
  CHECK(natural_map_scale(0.1, 2, 1, 1) == 2);
  CHECK(natural_map_scale(0.1, 1, 2, 1) == 2);
  CHECK(natural_map_scale(0.1, 1e-17, 2, 3) == 2);
  CHECK(natural_map_scale(0.1, 5, 0, 0) == 5);                                 // nothing drives the step
  CHECK(natural_map_scale(1e-16, 1e-16, 1e-16, 1) == 1);                       // rounding of the momenta
  CHECK(natural_map_scale(2e-14, 1e-13, 1e-16, 1) == doctest::Approx(1e-13));  // above it
  CHECK(natural_map_scale(1e-16, 1, 1e-18, 1e-18) == 1);                       // rounding of the impulses
  CHECK(natural_map_scale(0.5, 1e12, 1, 1) == 1e5);                            // they grew with the fault
  CHECK(natural_map_scale(0.25, 1e24, 1, 1, true) == 1e10);                    // of squares
  CHECK(natural_map_scale(1e-32, 1e-32, 1e-32, 1, true) == 1);
  CHECK(natural_map_scale(0.5, 1e15, 1, 1) == 1e15);  // rounding, unless they are not believed
  CHECK(natural_map_scale(0.5, 1e15, 1, 1, false, 1e8) == 1e5);
  CHECK(std::isnan(not_a_number / natural_map_scale(not_a_number, 1, 1, 1)));
}

TEST_CASE("scale of a contact: its impulse alone, and the speeds of both bodies, rims included") {
  const std::vector<GrainVelocity<2>> v{{.x = 3, .inverse_mass = 1}, {.x = -4, .rim = 2, .inverse_mass = 0.5}};
  GrainContact<2> contact;
  contact.a = 0;
  contact.b = 1;
  contact.inverse_mass_a = v[0].inverse_mass;
  contact.inverse_mass_b = v[1].inverse_mass;
  contact.friction = 0.3;
  const double mass = 1 / 1.5, speed = 3 + (4 + 2);
  for (const bool exchanged : {false, true}) {
    if (exchanged) std::swap(contact.a, contact.b);
    if (exchanged) contact.normal = {-1, 0};
    const ImpulseScale scale = impulse_scale<2>(ContactLaw(Coulomb{}), contact, v, speeds_of<2>(v));
    CHECK(scale.speeds == doctest::Approx(speed * speed));
    CHECK(scale.momenta == doctest::Approx(speed * speed * mass * mass));
    CHECK(scale.energies == doctest::Approx(speed * speed * mass));
    // They close at 7 m/s and roll on each other at 2 m/s, where W_tt = 3 W_nn: friction holds.
    CHECK(scale.alone == doctest::Approx(mass * mass * (7 * 7 + 4.0 / 9)));
  }
}

TEST_CASE("LMGC90's criteria: rounding of the velocities is relative to what the bodies bring") {
  ContactResidual noise{.violation = 1e-32, .work = 1e-32, .scale_work = 1e-32, .scale_velocity = 1e-32};
  noise.squared_work = noise.largest_squared_work = 1e-64;
  noise.largest_violation = 1e-32;
  noise.loaded = 9;
  CHECK(noise.quad_dv() == doctest::Approx(1));
  CHECK(noise.quad_dvr() == doctest::Approx(3));
  CHECK(noise.mean_dv_over_r() == doctest::Approx(1));
  CHECK(noise.qm_16() == doctest::Approx(3));
  noise.scale = {.speeds = 4, .energies = 4};
  CHECK(noise.quad_dv() == doctest::Approx(0.5e-16));
  CHECK(noise.quad_dvr() == doctest::Approx(0.75e-32));
  CHECK(noise.mean_dv_over_r() == doctest::Approx(0.25e-32));
  CHECK(noise.qm_16() == doctest::Approx(0.5e-16));
  const ContactResidual clear{.violation = 1e-20,
                              .work = -1e-20,
                              .scale_work = 1e-20,
                              .scale_velocity = 1e-20,
                              .scale = {.speeds = 4, .energies = 4}};
  CHECK(clear.quad_dv() == doctest::Approx(1));
  CHECK(clear.mean_dv_over_r() == doctest::Approx(-1));
}

TEST_CASE("two grains that go on together after an impact: impulses are rounding, and so is every residual") {
  for (const std::string algorithm : {"auto", "continuation", "newton", "nlgs", "admm", "accelerated", "generic"})
    for (const double friction : {0.3, 0.0}) {
      std::vector<StepReport> first;
      for (const Units& units : watched(scales)) {
        INFO("algorithm = ", algorithm, ", units.mass = ", units.mass, ", units.length = ", units.length);
        Dynamics dynamics = dynamics_of(algorithm, units);
        dynamics.interaction.friction = friction;
        GranularState end;
        const std::vector<StepReport> reports =
            run(simulation_of({in(units, {.y = 0.5, .velocity_x = 1}), in(units, {.x = 1.001, .y = 0.5})}, dynamics), 6,
                &end);
        for (const double v : end.velocity_x) CHECK(v == doctest::Approx(0.5 * units.speed()).epsilon(1e-8));
        for (const StepReport& report : reports) {
          CHECK(report.status == SolverStatus::converged);
          CHECK(report.residual.relative_natural_map() <= 1e-8);
          CHECK(report.residual.quad_dv() <= 1e-6);
          CHECK(report.residual.qm_16() <= 1e-5);
          CHECK(std::abs(report.residual.mean_dv_over_r()) <= 1e-5);
          CHECK_FALSE(report.no_room);
          CHECK_FALSE(report.doubtful);
        }
        if (first.empty()) first = reports;
        for (std::size_t k = 0; k < reports.size(); ++k) {
          CHECK(reports[k].last.iteration == first[k].last.iteration);
          CHECK(reports[k].residual.relative_natural_map() == first[k].residual.relative_natural_map());
          CHECK(reports[k].driven_residual() == first[k].driven_residual());
          CHECK(reports[k].residual.quad_dv() == first[k].residual.quad_dv());
          CHECK(reports[k].residual.mean_dv_over_r() == first[k].residual.mean_dv_over_r());
        }
      }
    }
}

TEST_CASE("relatives: at rest without gravity, rolling, touching and separating, falling together, a pile at rest") {
  Dynamics weightless = dynamics_of("auto"), heavy = dynamics_of("auto"), rough = dynamics_of("auto");
  heavy.time.gravity = rough.time.gravity = {0, -g};
  heavy.boundaries.push_back(floor_wall());
  rough.boundaries.push_back(floor_wall());
  std::vector<Grain> falling, pile;
  for (int k = 0; k < 40; ++k) falling.push_back({.x = 3.0 * k, .y = 100, .velocity_x = 7.1 * k, .velocity_y = -300});
  falling.push_back({.x = 1, .y = 100, .velocity_y = -300});  // touches the first one, at its velocity
  for (int k = 0; k < 10; ++k) pile.push_back({.x = 0, .y = 0.5 + k});
  const std::pair<const char*, Simulation> scenes[] = {
      {"at rest", simulation_of({Grain{.y = 0.5}, Grain{.x = 1, .y = 0.5}}, weightless)},
      {"rolling", simulation_of({Grain{.y = 0.5, .velocity_x = 1, .spin = -2}}, rough)},
      {"separating", simulation_of({Grain{.velocity_x = -1e-3}, Grain{.x = 1, .velocity_x = 1e3}}, weightless)},
      {"drifting", simulation_of({Grain{.velocity_x = 1.0 / 3, .velocity_y = 0.1},
                                  Grain{.x = 0.6, .y = 0.8, .velocity_x = 1.0 / 3, .velocity_y = 0.1}},
                                 weightless)},
      {"falling", simulation_of(falling, dynamics_of("auto"))},
      {"pile", simulation_of(pile, heavy)}};
  for (const auto& one : scenes) {
    CAPTURE(one.first);
    for (const StepReport& report : run(one.second, 5)) {
      CHECK(report.status == SolverStatus::converged);
      CHECK(report.residual.relative_natural_map() <= 1e-8);
      CHECK(report.residual.quad_dv() <= 1e-5);
      CHECK_FALSE(report.no_room);
    }
  }
}

TEST_CASE("a heavy grain far away does not hide what light ones do") {
  // 10^12 kg at 1 m/s touch another as heavy; two of a milligram meet head on, from zero impulses by sweeps to zeta.
  for (const std::string criterion : {"zeta", "natural_map"}) {
    const Dynamics dynamics = dynamics_of("nlgs", {}, {.criterion = criterion});
    GranularState end;
    run(simulation_of({Grain{.radius = 0.5, .mass = 1e12, .velocity_x = 1},
                       Grain{.x = 10, .mass = 1e-6, .velocity_x = 1}, Grain{.x = 11.001, .mass = 1e-6}},
                      dynamics),
        3, &end);
    CHECK(end.velocity_x[1] == doctest::Approx(0.5).epsilon(1e-12));
    CHECK(end.velocity_x[2] == doctest::Approx(0.5).epsilon(1e-12));
  }
}

TEST_CASE("criterion and table have one scale") {
  for (const std::string law : {"coulomb", "frictionless", "cohesive"}) {
    CAPTURE(law);
    Dynamics dynamics = dynamics_of(
        "nlgs", {}, {.maximum_iterations = 7, .criterion = "none", .order = "natural", .warm_start = false});
    dynamics.interaction.law = law;
    dynamics.interaction.cohesion = law == "cohesive" ? 50 : 0;
    const GranularStep<2> step = solve_step(shaken_lattice(6, 5, dynamics));
    const LocalFrictionProblem problem = contact_problem(step.problem, shaken_lattice(6, 5, dynamics).system);
    Vector shifted(2 * problem.contacts());
    for (Index c = 0; c < problem.contacts(); ++c) {
      const GrainContact<2>& contact = step.contacts[at(c)];
      shifted[2 * c] = contact.impulse.n + contact.pull;
      shifted[2 * c + 1] = contact.impulse.t;
    }
    const FrictionState state = friction_state(problem, shifted);
    const ContactResidual& residual = step.report.residual;
    CHECK(std::sqrt(residual.impulses) == doctest::Approx(shifted.norm()).epsilon(1e-13));
    CHECK(residual.relative_natural_map() > 1e-4);
    if (law != "cohesive") CHECK(residual.relative_natural_map() == doctest::Approx(state.residual).epsilon(1e-10));
    double alone = 0;  // literally: each contact by itself, from V_free
    for (const GrainContact<2>& c : step.problem.contacts) {
      const LocalVector<2> v = relative_velocity(c, GrainVelocities<2>(step.problem.free)) + c.bias;
      const double n = std::max(0.0, c.pull - c.inverse_w().inverse_n * v.n), edge = c.friction * n;
      const double t = law == "frictionless" ? 0 : std::clamp(-c.inverse_w().inverse_t * v.t, -edge, edge);
      alone += n * n + t * t;
    }
    CHECK(residual.scale.alone == doctest::Approx(alone).epsilon(1e-13));
    CHECK(residual.scale.momenta >= 0);
  }
}

TEST_CASE("what ends a run is the residual that was asked for; a doubt is said beside it") {
  for (const double tolerance : {0.3, 3e-2, 3e-3, 3e-4}) {
    CAPTURE(tolerance);
    const FrictionSolution found =
        solve_friction(squeezed(), {.algorithm = FrictionAlgorithm::nlgs, .tolerance = tolerance, .check_every = 1});
    const auto residual = [](Index k) {
      return 2 / std::hypot(2.0 * static_cast<double>(k) - 1, 2.0 * static_cast<double>(k));
    };
    Index first = 1;
    while (residual(first) > tolerance) ++first;
    CHECK(found.status == FrictionStatus::converged);
    CHECK(found.sweeps == first);
    CHECK(found.state.residual == doctest::Approx(residual(first)).epsilon(1e-12));
    CHECK(found.state.driven_residual == doctest::Approx(std::sqrt(2)).epsilon(1e-12));
    CHECK_FALSE(found.credible);
  }
  // A problem with a solution is believed.
  LocalFrictionProblem resting = squeezed();
  resting.w = Matrix{{2, 0, -1, 0}, {0, 1, 0, 0}, {-1, 0, 2, 0}, {0, 0, 0, 1}}.sparseView();
  const FrictionSolution found = solve_friction(resting, {.tolerance = 1e-10});
  CHECK(found.status == FrictionStatus::converged);
  CHECK(found.credible);
  CHECK(found.impulses[0] == doctest::Approx(1));
  CHECK(found.state.driven_residual <= 1e-9);
}

TEST_CASE("impulses that grow do not make the residual small: by default no solver takes them for a solution") {
  for (const FrictionAlgorithm algorithm :
       {FrictionAlgorithm::automatic, FrictionAlgorithm::continuation, FrictionAlgorithm::newton,
        FrictionAlgorithm::nlgs, FrictionAlgorithm::admm, FrictionAlgorithm::accelerated})
    for (const double scale : {1.0, std::ldexp(1, -60), std::ldexp(1, 60)}) {
      INFO("algorithm = ", to_string(algorithm), ", scale = ", scale);
      const LocalFrictionProblem problem = squeezed(scale);
      const FrictionSolverOptions options{.algorithm = algorithm, .maximum_sweeps = 20'000};
      const FrictionSolution found = solve_friction(problem, options);
      CHECK(found.status != FrictionStatus::converged);
      CHECK(found.state.driven_residual >= 0.1);
      // Nor from what grew in a run before: a guess gives no leave to grow further.
      const FrictionSolution again = solve_friction(problem, options, Vector{{1e7 * scale, 0, 1e7 * scale, 0}});
      CHECK(again.status != FrictionStatus::converged);
      CHECK(again.impulses.norm() <= 2e8 * scale);
    }
}

TEST_CASE("self-stress of a network at rest is a solution, however small what drives it") {
  for (const double driving : {0.0, 1e-17, 1e-12}) {
    CAPTURE(driving);
    LocalFrictionProblem problem = squeezed();
    problem.q << driving, 0, -driving, 0;
    const FrictionSolution found = solve_friction(problem, {}, Vector{{3, 0, 3, 0}});
    CHECK(found.status == FrictionStatus::converged);
    CHECK(found.state.residual <= 1e-8);
    CHECK(std::isfinite(found.state.driven_residual));
    if (driving < 1e-15) CHECK(found.credible);
  }
}

TEST_CASE("closing walls: no residual is small, and every step says that there may be no room" *
          doctest::skip(sanitized)) {  // minutes
  const std::vector<std::string> algorithms{"auto",    "newton",          "nlgs", "admm", "accelerated",
                                            "generic", "two_stage_newton"};
  for (const std::string& algorithm : watched(algorithms)) {
    std::vector<StepReport> first;
    for (const Units& units : watched(scales))
      for (const double friction : {0.3, 0.0}) {
        INFO("algorithm = ", algorithm, ", friction = ", friction);
        const std::vector<StepReport> reports =
            run(closing_walls(algorithm, units, 9.81, friction), thorough() ? 12 : 4);
        for (const StepReport& report : reports) {
          CHECK(report.status != SolverStatus::converged);
          CHECK(report.residual.relative_natural_map() > 1e-8);
          CHECK(report.driven_residual() > 0.1);
          CHECK(report.no_room);
        }
        if (first.empty()) first = reports;
        if (friction == 0.3)
          for (std::size_t k = 0; k < reports.size(); ++k)
            CHECK(reports[k].residual.relative_natural_map() == first[k].residual.relative_natural_map());
      }
  }
}

TEST_CASE("closing walls: without gravity, three of them, driven disks, spheres between planes, and walls that stop" *
          doctest::skip(sanitized)) {  // minutes
  const auto check_no_room = [](const char* scene, const Simulation& simulation) {
    CAPTURE(scene);
    for (const StepReport& report : run(simulation, 8)) {
      CHECK(report.no_room);
      CHECK(report.status != SolverStatus::converged);
    }
  };
  check_no_room("weightless", closing_walls("auto", {}, 0));
  Dynamics corner = dynamics_of("auto");
  corner.time.gravity = {0, -g};
  corner.boundaries = {floor_wall(), wall("left", {-0.5, 5}, {-0.5, -5}),
                       wall("slope", {0.5, -1}, {0.5, 5}, moving({.x = -0.2}, {0.5, 0}))};
  check_no_room("three walls", simulation_of({Grain{.y = 0.5}}, corner));
  Dynamics space = dynamics_of("auto");
  space.time.gravity = {0, 0, -g};
  space.boundaries = {plane("floor", {0, 0, 0}, {0, 0, 1}),
                      plane("lid", {0, 0, 1}, {0, 0, -1}, moving_in_space({0, 0, -0.1}, {0, 0, 0}, {0, 0, 1}))};
  check_no_room("planes", simulation_of({Ball{.centre = {0, 0, 0.5}}}, space));
  Dynamics column = dynamics_of("auto");
  column.boundaries = {wall("left", {-0.5, 5}, {-0.5, -5}),
                       wall("right", {3.5, -5}, {3.5, 5}, moving({.x = -0.1}, {3.5, 0}))};
  check_no_room("row of disks", simulation_of({Grain{}, Grain{.x = 1}, Grain{.x = 2}, Grain{.x = 3}}, column));
  // The walls stop after two steps. Without gravity what is overlapped then stays, and nothing closes any more.
  Simulation stops = closing_walls("auto", {}, 0);
  stops.system.boundaries[1].motion.time = {0, 0.01};
  stops.system.boundaries[1].motion.velocity = {{.x = -0.1}, {}};
  const std::vector<StepReport> reports = run(stops, 6);
  CHECK(reports[0].no_room);
  for (std::size_t k = 3; k < reports.size(); ++k) {
    CHECK_FALSE(reports[k].no_room);
    CHECK_FALSE(reports[k].doubtful);
  }
}

TEST_CASE("driven disks that close on a free one leave no room, like walls" * doctest::skip(sanitized)) {  // minutes
  for (const std::string& algorithm :
       watched(std::vector<std::string>{"auto", "newton", "nlgs", "admm", "accelerated", "generic"}))
    for (const Units& units : watched(scales))
      for (const auto& speeds : {std::pair(0.0, -0.1), std::pair(0.1, -0.1), std::pair(0.3, 0.1)}) {
        INFO("algorithm = ", algorithm, ", speeds.first = ", speeds.first);
        for (const StepReport& report :
             run(between_driven_disks(algorithm, speeds.first, speeds.second, units), thorough() ? 4 : 2)) {
          CHECK(report.no_room);
          CHECK(report.status != SolverStatus::converged);
          CHECK(report.driven_residual() > 0.1);
        }
      }
  Dynamics dynamics = dynamics_of("auto");
  const auto check_no_room = [](const char* scene, const Simulation& simulation) {
    CAPTURE(scene);
    for (const StepReport& report : run(simulation, 4)) CHECK(report.no_room);
  };
  dynamics.boundaries = {wall("left", {-0.5, 5}, {-0.5, -5}), driven(2, {.x = -0.1})};
  check_no_room("a wall and a disk", simulation_of({Grain{}, Grain{.x = 1}, Grain{.x = 2}}, dynamics));
  dynamics.boundaries = {driven(0, {}), driven(3, {.x = -0.1})};
  check_no_room("two free disks", simulation_of({Grain{}, Grain{.x = 1}, Grain{.x = 2}, Grain{.x = 3}}, dynamics));
  dynamics.boundaries = {driven(0, {.z = 0.1}), driven(2, {.z = -0.1})};
  const auto ball = [](double z) { return Ball{.centre = {0, 0, z}}; };
  check_no_room("spheres", simulation_of({ball(0), ball(1), ball(2)}, dynamics));
}

TEST_CASE("driven disks that go apart, along, or after each other leave room, and the free one takes their speed") {
  struct Pair {
    double left, right, free;  // m/s; that of the free disk: what the disk has that pushes it, or none
  };
  for (const std::string algorithm : {"auto", "newton", "nlgs", "admm", "accelerated", "generic"})
    for (const Units& units : watched(scales))
      for (const Pair& one : {Pair{-0.1, 0.1, 0}, {0.1, 0.1, 0.1}, {-0.1, -0.1, -0.1}, {0.1, 0.3, 0.1}, {0, 0, 0}}) {
        INFO("algorithm = ", algorithm, ", one.left = ", one.left, ", one.right = ", one.right);
        Simulation scene = between_driven_disks(algorithm, one.left, one.right, units);
        scene.dynamics.time.penetration_correction = 0;  // what moves half a step would push
        GranularState end;
        for (const StepReport& report : run(scene, 4, &end)) {
          CHECK_FALSE(report.no_room);
          CHECK_FALSE(report.doubtful);
          CHECK(report.status == SolverStatus::converged);
        }
        CHECK(std::abs(end.velocity_x[1] / units.speed() - one.free) <= 1e-6);
      }
}

TEST_CASE("room enough: walls that close in on grains that can get out of the way raise no alarm" *
          doctest::skip(sanitized)) {  // a minute
  for (const std::string algorithm : {"auto", "nlgs", "generic"}) {
    CAPTURE(algorithm);
    for (const StepReport& report : run(closing_walls(algorithm, {}, 0, 0.3, 0.05), 8)) CHECK_FALSE(report.no_room);
    Dynamics dynamics = dynamics_of(algorithm);
    dynamics.time.gravity = {0, -g};
    dynamics.solver.maximum_iterations = 30;  // far from converged
    for (const StepReport& report : run(box_of_grains(60, dynamics), 40)) CHECK_FALSE(report.no_room);
  }
}

TEST_CASE("copies of a grain that fly together, or rest under self-stress, are glued, whatever the criterion") {
  for (const std::string criterion : {"zeta", "interface_change", "gluing", "natural_map", "quad_dv", "quad_dvr",
                                      "mean_dv_over_r", "qm_16", "normal_change"}) {
    CAPTURE(criterion);
    Dynamics dynamics = dynamics_of("generic", {}, {.criterion = criterion, .tolerance = 1e-4});
    std::vector<Grain> row;
    for (int k = 0; k < 4; ++k) row.push_back({.x = k * 0.6, .y = k * 0.8, .velocity_x = 1.0 / 3, .velocity_y = 0.1});
    for (const StepReport& report : run(simulation_of(row, dynamics, {2, 1}), 4)) {
      CHECK(report.status == SolverStatus::converged);
      CHECK(report.residual.relative_natural_map() <= 1e-8);
    }
    dynamics.boundaries = {wall("left", {-0.5, 5}, {-0.5, -5}), wall("right", {3.5, -5}, {3.5, 5})};
    Simulation rest = simulation_of({Grain{}, Grain{.x = 1}, Grain{.x = 2}, Grain{.x = 3}}, dynamics, {2, 1});
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 4), std::pair(1, 2), std::pair(2, 3), std::pair(3, 5)})
      rest.state.impulses.push_back({a, b, {1.0 / 3, 0, 0}});
    for (const StepReport& report : run(rest, 4)) {
      CHECK(report.status == SolverStatus::converged);
      CHECK(report.last.gluing <= 0.01);
      CHECK_FALSE(report.no_room);
    }
  }
}

TEST_CASE("interface impulses that are rounding of the momenta are no change") {
  // F is 10^-17 N s, and so is its first change.
  for (const std::string algorithm : {"generic", "enriched"})
    for (const Units& units : watched(scales)) {
      CAPTURE(algorithm);
      const Dynamics dynamics = dynamics_of(algorithm, units, {.criterion = "interface_change", .tolerance = 1e-4});
      const GranularStep<2> step = solve_step(simulation_of(flying_row(units), dynamics, {2, 1}));
      CHECK(step.interface_impulses.norm() > 0);
      CHECK(step.interface_impulses.norm() <= 1e-16 * units.mass * units.speed());
      CHECK(step.report.status == SolverStatus::converged);
      CHECK(step.report.last.iteration == 1);
      CHECK(step.report.last.interface_change <= 1e-4);
      CHECK(step.report.last.interface_second_change <= 1e-4);
    }
}

TEST_CASE("a linear subdomain of grains that fly together is no further from the law than rounding of their momenta") {
  // F and the distance of the model are both 10^-17 N s.
  for (const double flexibility : {1e-8, 1e-4})
    for (const Units& units : watched(scales)) {
      Dynamics dynamics = dynamics_of("generic", units, {.maximum_iterations = 8, .criterion = "none"});
      dynamics.solver.model = SwitchedModel::linear;
      dynamics.solver.switch_after = 3;
      dynamics.solver.switch_flexibility = Flexibility(flexibility, true);
      Simulation simulation = simulation_of(flying_row(units), dynamics, {2, 1});
      double apart = 0;
      for (int k = 0; k < 3; ++k) {
        const GranularStep<2> step = solve_step(simulation);
        for (const RememberedModel& model : step.models) {
          apart = std::max(apart, model.velocity_distance);
          CHECK(model.impulse_distance <= 1e-3);
        }
        take_step(simulation, step);
      }
      CHECK(apart > 0);
    }
}

TEST_CASE("jumps of copies at rest are relative to what rounding leaves of their impulses") {
  // An oblique row between two walls under self-stress, without loads: after the first step V is 10^-17 m/s, and so are
  // the jumps of its copies, while F over the mass of a copy is 0.2 m/s.
  for (const std::string algorithm : {"generic", "enriched"})
    for (const std::string criterion : {"interface_change", "natural_map", "gluing"}) {
      INFO("algorithm = ", algorithm, ", criterion = ", criterion);
      Dynamics dynamics = dynamics_of(algorithm, {}, {.criterion = criterion, .tolerance = 1e-4});
      dynamics.boundaries = {wall("left", {-1.1, 0.2}, {0.5, -1}), wall("right", {2.9, 2.2}, {1.3, 3.4})};
      std::vector<Grain> row;
      for (int k = 0; k < 4; ++k) row.push_back({.x = k * 0.6, .y = k * 0.8});
      row[1].mass = 0.7;
      row[2].mass = 1.7;
      Simulation rest = simulation_of(row, dynamics, {2, 1});
      for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 4), std::pair(1, 2), std::pair(2, 3), std::pair(3, 5)})
        rest.state.impulses.push_back({a, b, {1.0 / 3, 0, 0}});
      const std::vector<StepReport> reports = run(rest, 4);
      for (std::size_t k = 1; k < reports.size(); ++k) {
        CHECK(reports[k].status == SolverStatus::converged);
        CHECK(reports[k].last.iteration <= 5);
        CHECK(reports[k].last.gluing <= 0.01);
      }
    }
}

TEST_CASE("other quotients whose denominator may vanish") {
  const auto rates = [](double observed, double predicted) {
    return ComparedRate{.predicted = predicted, .observed = observed, .observed_error = 0};
  };
  CHECK(rates(1, 1).relative_gap() == 0);
  CHECK(rates(0.9, 1).relative_gap() == infinity);
  CHECK(rates(0.9, 0.8).relative_gap() == doctest::Approx(0.5));
  CHECK(rates(1, 1).agree());
  CHECK(std::isnan(rates(not_a_number, 0.5).relative_gap()));
  GranularSystem driven;
  driven.radius = driven.mass = {1};
  driven.driven_by = {0};
  CHECK(mean_speed(driven, 0) == 0);
  // Nothing moves, nothing carries: there is no rate to observe, and nothing drifts.
  const RateAtSolution none =
      rate_at_solution(simulation_of({Grain{}, Grain{.x = 1}, Grain{.x = 2}}, dynamics_of("generic"), {2, 1}));
  CHECK(none.drift == 0);
  CHECK(std::isnan(none.observed));
  CHECK_FALSE(none.converged);
  CHECK_FALSE(std::isinf(none.margin));
  // Two bodies that fly together at 1 000 m/s: q is what rounding leaves, `speeds` what cancels in it.
  const LocalFrictionProblem local =
      reduce({Matrix(Matrix::Identity(6, 6)).sparseView(),
              Matrix{{-1, 0}, {0, -1}, {0, -1}, {1, 0}, {0, 1}, {0, -1}}.sparseView(), Vector{{1000, 0, 0, 1000, 0, 0}},
              Vector::Zero(2), Vector::Constant(1, 0.3)});
  CHECK(local.q.norm() == 0);
  CHECK(local.speeds[0] == doctest::Approx(2000));
}
