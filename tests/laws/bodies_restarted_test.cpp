// SPDX-License-Identifier: GPL-3.0-or-later
// Steps of clumps and of a plank that is pushed: written to a file and gone on with, exported as contact problems,
// solved with subdomains that become linear, and written as input of LMGC90.
#include "../support/granular.hpp"
#include "../support/run_program.hpp"
#include "../support/spheres.hpp"
#include "../support/spoilt.hpp"
#include "formats/contact_problem/step_fclib.hpp"
#include "formats/lmgc90/datbox.hpp"
#include "formats/lmgc90/datbox_writer.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "simulation/contact_solver_step.hpp"
#include "simulation/step_decomposition.hpp"

#include <doctest/doctest.h>

#include <set>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

BoundarySpec pair_of_disks(const std::string& name, Index first, std::array<double, 2> centre,
                           RigidVelocity velocity = {}) {
  return clump(name, first, first + 1, centre, 2, 0.8, velocity);
}

// A plank over the bed of pressed_bed: pushed down by a force that grows and swings, driven along x.
BoundarySpec pushed_plank() {
  const double y = 1.1 + 2 * std::sqrt(0.99);
  BoundarySpec top = plank("top", {-0.6, y}, {3.7, y}, 0.1);
  top.motion = moving({.x = 0.05}, {1.55, y});
  top.motion.initial = RigidVelocity{.y = -0.1};
  top.body = FreeBody{.directions = {false, true}, .mass = 3};
  top.body->load.time = {0, 0.05};
  top.body->load.velocity = {{.y = -5}, {.y = -40}};
  top.body->load.oscillations = {{{.y = -8}, 70, 0.3, 0.5, 20}};
  return top;
}

// Three rows of four disks with two clumps among them, under a plank that is pushed down.
Simulation pressed_bed(const Dynamics& chosen, std::array<Index, 2> grid = {2, 1}) {
  std::vector<Grain> grains;
  for (Index k = 0; k < 12; ++k) {
    const double row = static_cast<double>(k / 4);
    grains.push_back({.x = 1.02 * static_cast<double>(k % 4) + 0.1 * static_cast<double>(k / 4 % 2),
                      .y = 0.5 + std::sqrt(0.99) * row});
  }
  Dynamics dynamics = chosen;
  dynamics.time.step = 0.005;
  dynamics.boundaries = {floor_wall(), pair_of_disks("left", 1, {1.53, 0.5}),
                         pair_of_disks("right", 5, {1.63, 0.5 + std::sqrt(0.99)}, {.y = -0.2, .spin = 0.5}),
                         pushed_plank()};
  return simulation_of(grains, dynamics, grid);
}

Dynamics pressed(Choice<StepAlgorithm> algorithm) {
  Dynamics dynamics = tight();
  dynamics.interaction.friction = 0.3;
  dynamics.solver.algorithm = algorithm;
  dynamics.solver.warm_start = true;
  dynamics.solver.tolerance = 1e-9;
  if (has_part(algorithm, StepPart::exchanges)) dynamics.solver.gluing_tolerance = 1e-9;
  if (has_part(algorithm, StepPart::whole_copies)) dynamics.solver.interface_relaxation = 0.7;  // or it rings at -1
  return dynamics;
}

// The same in space: a tumbling clump and a board that is pushed down.
Simulation pressed_spheres(const Dynamics& chosen, Components<Index> grid = {2, 1, 1}) {
  std::vector<Ball> balls;
  for (Index k = 0; k < 8; ++k)
    balls.push_back({.centre = Vector3(1.02 * static_cast<double>(k % 2), 1.02 * static_cast<double>(k / 2 % 2),
                                       0.5 + static_cast<double>(k / 4))});
  Dynamics dynamics = chosen;
  dynamics.time.step = 0.005;
  BoundarySpec clump = driven_grains("clump", 4, 5);
  clump.dimension = 3;
  clump.motion.centre = {0.51, 0, 1.5};
  clump.motion.initial = RigidVelocity{.spin = 1, .z = -0.1, .spin_x = 0.5, .spin_y = -0.25};
  clump.body = FreeBody{.mass = 2, .inertia = {0.2, 0.7, 0.9}};
  clump.body->directions.fill(true);
  clump.body->axes = Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Vector3(1, 2, 3).normalized()));
  BoundarySpec board = plane("board", {0.5, 0.5, 2.1}, Vector3::UnitZ());
  board.shape = BoundaryShape::plank;
  board.motion.centre = board.point;
  board.length = board.width = 2;
  board.radius = 0.1;
  board.body = FreeBody{.directions = {false, false, true}, .mass = 3, .load = moving({.z = -30})};
  dynamics.boundaries = {plane("floor", Vector3::Zero(), Vector3::UnitZ()), clump, board};
  return simulation_of(balls, dynamics, grid);
}

template <int D>
StepReport take_one(Simulation& simulation, TrajectoryStep& after) {
  GranularStep<D> step = solve_step<D>(simulation);
  REQUIRE(step.report.status == SolverStatus::converged);
  const std::vector<TrajectoryContact> contacts = trajectory_contacts(step);
  const StepReport report = take_step(simulation, std::move(step));
  after = TrajectoryStep{simulation.state, contacts};
  return report;
}

// Writes every step of a run, and goes on from each of them.
template <int D>
void check_restarts(const Simulation& begin, Index steps) {
  const TemporaryFolder folder;
  const std::string path = folder / "run.h5";
  Simulation simulation = begin;
  std::vector<TrajectoryStep> after(at(steps));
  TrajectoryWriter writer(path, {"a case", "a build", {}, simulation.system}, {simulation.state, {}},
                          headings(step_columns()));
  for (TrajectoryStep& one : after) {
    const StepReport report = take_one<D>(simulation, one);
    writer.append(one, {row(step_columns(), report)}, true);
  }
  writer.commit();
  CHECK(numbers_of(read_last_step(path).state) == numbers_of(simulation.state));
  for (Index k = 0; k + 1 < steps; ++k) {
    CAPTURE(k);
    Simulation rest = begin;
    rest.state = read_trajectory_step(path, k + 1).state;
    TrajectoryStep next;
    take_one<D>(rest, next);
    CHECK(numbers_of(rest.state) == numbers_of(after[at(k + 1)].state));
  }
}

DatboxTexts texts_of(const DatboxWriter& writer, const TrajectoryStep& step) {
  const std::vector<std::pair<std::string, std::string>> driven = writer.driven();
  return {writer.bodies(),
          writer.bulk(),
          writer.tact(),
          driven.front().second,
          writer.dof(step),
          {},
          [driven](const std::string& name) {
            for (const auto& [own, text] : driven)
              if (own == name) return text;
            return std::string();
          }};
}

// A run from what the writer wrote, with the same solver, step and gap law.
Simulation read_back(const DatboxTexts& texts, const Simulation& original) {
  const Datbox datbox = parse_datbox(texts, "box");
  Dynamics dynamics = datbox_dynamics(datbox);
  dynamics.solver = original.dynamics.solver;
  dynamics.time = original.dynamics.time;
  GranularScene made = scene(datbox_packing(datbox, DatboxGrains::all), dynamics);
  Index grain = 0;
  for (const DatboxBody& body : datbox.bodies)
    for (const DatboxContactor& one : body.contactors) {
      if (!one.wall.empty()) continue;
      const std::size_t i = at(grain++);
      if (!made.system.free(static_cast<Index>(i))) continue;
      made.state.velocity_x[i] = body.velocity[0];
      made.state.velocity_y[i] = body.velocity[1];
      made.state.spin[i] = body.velocity[2];
    }
  return {made.system, made.state, dynamics, original.partitioner};
}

// A rigid motion of all bodies moves a contact by its gap at the most: its points on both bodies are that far apart. A
// coarse space of such motions changes what is counted at the interface, and nothing else.
template <int D>
void check_rigid_motions(Simulation simulation) {
  const GranularStep<D> step = share_step<D>(simulation);
  Decomposition parts = linear_decomposition(simulation, step);
  add_places(parts, simulation);
  constexpr Index unknowns = unknowns_of_grain<D>, spins = unknowns - D;
  const auto turns = [&](Index body) {
    return body < simulation.system.grains() && !simulation.system.is_boundary(body);
  };
  Index checked = 0;
  for (const Subdomain& one : parts.subdomains) {
    Matrix motions = Matrix::Zero(one.inertia.size(), unknowns);
    for (Index i = 0; i < count(one.grains); ++i) {
      auto rows = motions.middleRows<unknowns>(unknowns * i);
      rows.template topLeftCorner<D, D>().setIdentity();
      for (Index a = 0, plane = D; a < D; ++a)
        for (Index b = a + 1; b < D; ++b, ++plane)
          rows.col(plane).template head<D>() =
              one.centres(a, i) * Vector::Unit(D, b) - one.centres(b, i) * Vector::Unit(D, a);
      rows.template bottomRightCorner<spins, spins>() = one.turning.middleRows<spins>(spins * i);
    }
    const Matrix moved = one.h.transpose() * motions;
    for (Index column = 0; column < moved.rows(); ++column)
      if (const StepContact& c = step.problem.geometry[at(one.contacts[at(column)] / D)]; turns(c.a) && turns(c.b)) {
        CHECK(moved.row(column).cwiseAbs().maxCoeff() <= 1.001 * std::abs(c.gap) + 1e-12);
        ++checked;
      }
  }
  CHECK(checked > 5 * D);
  simulation.dynamics.solver.interface_preconditioner = InterfacePreconditioner::dirichlet;
  const GranularStep<D> expected = solve_step<D>(simulation);
  simulation.dynamics.solver.coarse_space = CoarseSpace::rigid;
  const GranularStep<D> found = solve_step<D>(simulation);
  CHECK(found.report.status == SolverStatus::converged);
  CHECK(found.report.interface_iterations < expected.report.interface_iterations);
  CHECK(largest_difference(found.velocities, expected.velocities) < 1e-7);
}

}  // namespace

TEST_CASE("rigid motions of the bodies of a step move no contact, and make a coarse space") {
  check_rigid_motions<2>(pressed_bed(pressed("two_stage_admm"), {2, 2}));
  check_rigid_motions<2>(pressed_bed(pressed("two_stage_newton"), {2, 2}));
  check_rigid_motions<3>(pressed_spheres(pressed("two_stage_admm"), {2, 2, 1}));
}

TEST_CASE("bodies: a run goes on from every step of its trajectory, bit for bit") {
  for (const StepAlgorithm algorithm : {StepAlgorithm::nlgs, StepAlgorithm::generic, StepAlgorithm::schwarz,
                                        StepAlgorithm::automatic, StepAlgorithm::two_stage_newton}) {
    CAPTURE(to_string(algorithm));
    check_restarts<2>(pressed_bed(pressed(algorithm)), 6);
    check_restarts<3>(pressed_spheres(pressed(algorithm)), 4);
  }
}

TEST_CASE("static friction: a run that goes on knows which contacts slid") {
  Dynamics dynamics = pressed(StepAlgorithm::automatic);
  dynamics.interaction.friction = 0.1;
  dynamics.interaction.static_friction = 0.3;
  check_restarts<2>(pressed_bed(dynamics, {1, 1}), 6);
  dynamics.solver.warm_start = false;
  check_restarts<3>(pressed_spheres(dynamics, {1, 1, 1}), 4);
}

TEST_CASE("bodies: the plank presses the bed, and the clumps share its interface") {
  Simulation simulation = pressed_bed(pressed(StepAlgorithm::generic));
  TrajectoryStep after;
  for (Index k = 0; k < 12; ++k) take_one<2>(simulation, after);
  double carried = 0;
  for (const RememberedImpulse& one : simulation.state.impulses)
    if (one.b == simulation.system.grains() + 1) carried += one.impulse[0] / 0.005;
  CHECK(carried > 3 * g);
  const auto of_clump = [&](const RememberedGluing& one) { return one.grain >= simulation.system.grains(); };
  CHECK(std::ranges::any_of(simulation.state.gluing, of_clump));
}

TEST_CASE("bodies: the contact problem of a step, and of each subdomain, is solved by what the run found") {
  const auto check_solution = [](const FclibFile& file, double tolerance) {
    const auto& problem = std::get<GlobalFrictionProblem>(file.problem);
    REQUIRE(file.solution.has_value());
    const FclibSolution& found = *file.solution;
    CHECK((body_velocities(problem, found.r) - found.v).norm() < tolerance);
    CHECK((problem.h.transpose() * found.v + problem.w - found.u).norm() < tolerance);
    return problem;
  };
  const auto check_all = [&](const Simulation& begin, auto dimension) {
    constexpr int D = dimension();
    Simulation simulation = begin;
    TrajectoryStep after;
    for (int k = 0; k < 2; ++k) take_one<D>(simulation, after);
    const Simulation before = simulation;
    const StepProblem<D> step = prepare_step<D>(start_of(before), false);
    GranularStep<D> solved = solve_step<D>(simulation);
    const std::vector<GrainVelocity<D>> velocities = solved.velocities;
    take_one<D>(simulation, after);
    const FclibFile file = fclib_of_step(before, &after);
    const auto problem = check_solution(file, 1e-8);
    for (std::size_t c = 0; c < solved.contacts.size(); ++c) {
      const LocalVector<D> u = relative_velocity(solved.contacts[c], velocities) + solved.contacts[c].bias;
      CHECK(std::sqrt(squared(component<D>(file.solution->u, static_cast<Index>(c)) - u)) < 1e-7);
      CHECK(problem.friction[static_cast<Index>(c)] == solved.contacts[c].friction);
    }
    // W of the exported problem is that of `solve` on the step.
    const LocalFrictionProblem local = std::get<LocalFrictionProblem>(local_form(file).problem);
    const LocalFrictionProblem own = contact_problem(step, before.system);
    CHECK((Matrix(local.w) - Matrix(own.w)).cwiseAbs().maxCoeff() < 1e-12 * Matrix(own.w).maxCoeff());
    CHECK((local.q - own.q).norm() < 1e-9 * (1 + own.q.norm()));
    CHECK(local.friction == own.friction);
    // Velocities of bodies, with spins in place of the speeds of rims.
    const Vector v = file.solution->v;
    Index row = 0;
    for (Index body = 0; body < before.system.bodies(); ++body) {
      if (before.system.inverse_mass(body) == 0) continue;
      const auto rims = before.system.rims(body);
      const GrainUnknowns<D> expected = unknowns(velocities[at(body)]);
      for (Index k = 0; k < unknowns_of_grain<D>; ++k) {
        const double arm = k < D ? 1 : rims[at(D == 2 ? k : k - D)];
        CHECK(std::abs(v[row++] * arm - expected[at(k)]) < 1e-7);
      }
    }
    CHECK(row == v.size());
    CHECK(problem.mass.rows() == row);
    for (Index e = 0; e < 2; ++e) {
      const FclibFile part = fclib_of_subdomain(before, after, e);
      check_solution(part, 1e-6);
      std::set<Index> bodies;  // of the subdomain, with the velocities that they have in the whole
      for (std::size_t c = 0; c < solved.contacts.size(); ++c)
        if (solved.partition.subdomain_of_contact[c] == e)
          for (const Index body : {Index{solved.contacts[c].a}, Index{solved.contacts[c].b}})
            if (velocities[at(body)].inverse_mass > 0) bodies.insert(body);
      std::vector<double> expected;
      for (const Index body : bodies) {
        const auto rims = before.system.rims(body);
        const GrainUnknowns<D> whole = unknowns(velocities[at(body)]);
        for (Index k = 0; k < unknowns_of_grain<D>; ++k)
          expected.push_back(whole[at(k)] / (k < D ? 1 : rims[at(D == 2 ? k : k - D)]));
      }
      REQUIRE(part.solution->v.size() == count(expected));
      CHECK((part.solution->v - Vector::Map(expected.data(), count(expected))).norm() < 1e-5);
    }
  };
  for (const StepAlgorithm algorithm : {StepAlgorithm::generic, StepAlgorithm::schwarz}) {
    CAPTURE(to_string(algorithm));
    Dynamics dynamics = pressed(algorithm);
    dynamics.interaction.static_friction = 0.35;
    check_all(pressed_bed(dynamics), std::integral_constant<int, 2>());
    check_all(pressed_spheres(dynamics), std::integral_constant<int, 3>());
  }
}

TEST_CASE("bodies: a run with subdomains that become linear comes to the velocities of one without") {
  // A crooked column with a clump in it that is pushed: every contact sticks, and there is one way to carry the loads.
  const auto column_with = [](SwitchedModel model) {
    Dynamics dynamics = pressed(StepAlgorithm::generic);
    dynamics.interaction.friction = 2;
    dynamics.solver = switching(model);
    const double up = std::sqrt(0.96);
    std::vector<Grain> grains;
    for (Index k = 0; k < 8; ++k)
      grains.push_back({.x = k % 2 == 0 ? 0.0 : 0.2, .y = 0.5 + up * static_cast<double>(k)});
    BoundarySpec clump = pair_of_disks("clump", 3, {0.1, 0.5 + 3.5 * up});
    clump.body->load = moving({.x = 0.5, .y = -3, .spin = 0.1});
    dynamics.boundaries = {floor_wall(), clump};
    return simulation_of(grains, dynamics, {1, 4});
  };
  Simulation plain = column_with(SwitchedModel::none), switched = column_with(SwitchedModel::linear);
  Index linear_iterations = 0;
  for (int k = 0; k < 6; ++k) {
    CAPTURE(k);
    const GranularStep<2> a = solve_step(plain), b = solve_step(switched);
    REQUIRE(a.report.status == SolverStatus::converged);
    REQUIRE(b.report.status == SolverStatus::converged);
    CHECK(largest_difference(a.velocities, b.velocities, plain.system.bodies()) < 1e-6);
    for (const RememberedModel& model : b.models) linear_iterations += model.switched_iterations;
    take_step(plain, a);
    take_step(switched, b);
  }
  CHECK(linear_iterations > 0);
}

TEST_CASE(
    "bodies: a DATBOX of clumps and planks, pushed or free, has the bodies and the state of a run after some steps") {
  Dynamics dynamics = pressed(StepAlgorithm::automatic);
  dynamics.interaction.boundary_friction = 0.2;
  dynamics.interaction.static_friction = 0.45;
  dynamics.time.maximum_push_speed = 0;
  Simulation simulation = pressed_bed(dynamics, {1, 1});
  BoundarySpec& top = simulation.dynamics.boundaries.back();
  top.body->load.oscillations.clear();  // LMGC90 has a table or an oscillation
  BoundarySpec loose = plank("loose", {-2, 0.2}, {-1.2, 0.4}, 0.1);
  loose.motion.initial = RigidVelocity{.x = 2, .spin = 0.5};
  loose.body = free_body(0.7, 0.11);
  loose.body->load = moving({.x = 1, .y = 8, .spin = 0.25});
  simulation.dynamics.boundaries.push_back(loose);
  const Packing packing{simulation.state.x, simulation.state.y, std::vector<double>(12, 0.5),
                        std::vector<double>(12, 1.0)};
  const GranularScene made = scene(packing, simulation.dynamics);
  simulation.system = made.system;
  simulation.state = made.state;
  const DatboxWriter writer(simulation);
  REQUIRE(writer.without_datbox().empty());
  TrajectoryStep after{simulation.state, {}};
  for (Index k = 0; k < 30; ++k) take_one<2>(simulation, after);
  const Simulation original = simulation;
  Simulation back = read_back(texts_of(writer, after), original);
  REQUIRE(back.system.free_bodies.size() == 4);
  // By their order: free grains, then boundaries.
  const std::vector<Index> of_boundary{1, 2, 3, 4};
  for (std::size_t k = 0; k < 4; ++k) {
    CAPTURE(k);
    const Index own = back.system.free_bodies[k], other = of_boundary[k];
    const FreeBody &body = *back.system.boundaries[at(own)].body,
                   &expected = *original.system.boundaries[at(other)].body;
    CHECK(body.directions == expected.directions);
    CHECK(body.mass == doctest::Approx(expected.mass).epsilon(1e-6));
    if (expected.free(BodyDirection::spin))
      CHECK(body.inertia[2] == doctest::Approx(expected.inertia[2]).epsilon(1e-6));
    for (const double t : {0.0, 0.02, 1.0}) {
      CHECK(body.load.at(t).y == doctest::Approx(expected.load.at(after.state.time + t).y).epsilon(1e-6));
      CHECK(body.load.at(t).spin == doctest::Approx(expected.load.at(after.state.time + t).spin).epsilon(1e-6));
    }
    const RigidVelocity v = back.state.body_velocities[at(own)], w = original.state.body_velocities[at(other)];
    const Pose &p = back.state.poses[at(own)], &q = original.state.poses[at(other)];
    for (const auto& [met, of_run] : {std::pair(v.x, w.x), std::pair(v.y, w.y), std::pair(v.spin, w.spin),
                                      std::pair(p.x, q.x), std::pair(p.y, q.y)})
      CHECK(met == doctest::Approx(of_run).scale(1).epsilon(1e-6));
  }
  CHECK(back.dynamics.interaction.static_friction == 0.45);
  // The bodies that touch, and their friction, are those of the run.
  const auto friction_of = [](const Simulation& one, Index a, Index b) {
    if (const PairRule& rule = one.system.pairs.of(a, b); rule.friction) return *rule.friction;
    return one.system.is_boundary(a) || one.system.is_boundary(b) ? one.dynamics.interaction.friction_of(true, true)
                                                                  : one.dynamics.interaction.friction;
  };
  std::vector<Index> in_back(at(original.system.grains() + count(original.system.walls)));
  Index number = 0;
  for (const bool free : {true, false})  // free grains come first
    for (Index i = 0; i < original.system.grains(); ++i)
      if (original.system.free(i) == free) in_back[at(i)] = number++;
  for (Index w = 0; w < count(original.system.walls); ++w) in_back[at(original.system.grains() + w)] = number++;
  for (Index a = 0; a < original.system.grains(); ++a)
    for (Index b = a + 1; b < count(in_back); ++b) {
      const Index low = std::min(in_back[at(a)], in_back[at(b)]), high = std::max(in_back[at(a)], in_back[at(b)]);
      const bool touch = original.system.may_touch(a, b), touch_back = back.system.may_touch(low, high);
      CHECK(touch_back == touch);
      if (touch && touch_back) CHECK(friction_of(back, low, high) == friction_of(original, a, b));
    }
  // A step goes on as that of the run.
  const StepReport expected = advance(simulation), met = advance(back);
  CHECK(met.contacts == expected.contacts);
  for (std::size_t k = 0; k < 4; ++k) {
    const RigidVelocity v = back.state.body_velocities[at(back.system.free_bodies[k])],
                        w = simulation.state.body_velocities[at(of_boundary[k])];
    CHECK(std::hypot(v.x - w.x, v.y - w.y, v.spin - w.spin) < 1e-3);
  }
}

TEST_CASE("bodies: a DATBOX of clumps and nothing else has their masses") {
  Dynamics dynamics = pressed(StepAlgorithm::nlgs);
  dynamics.boundaries = {pair_of_disks("one", 0, {0.5, 0}, {.x = 1}), pair_of_disks("two", 2, {4.5, 0})};
  Simulation simulation = simulation_of(
      std::vector<Grain>{{.x = 0, .y = 0}, {.x = 1, .y = 0}, {.x = 4, .y = 0}, {.x = 5, .y = 0}}, dynamics);
  const DatboxWriter writer(simulation);
  REQUIRE(writer.without_datbox().empty());
  const Simulation back = read_back(texts_of(writer, {simulation.state, {}}), simulation);
  REQUIRE(back.system.free_bodies.size() == 2);
  CHECK(back.system.boundaries[0].body->mass == doctest::Approx(2).epsilon(1e-6));
  CHECK(back.system.boundaries[0].body->inertia[2] == doctest::Approx(0.8).epsilon(1e-6));
  CHECK(back.system.may_touch(1, 2));
}

TEST_CASE("bodies of several shapes: a DATBOX has driven ones as bodies of one shape, and refuses free ones by name") {
  const std::vector<Grain> grains{{.x = 2.4, .y = 0.5, .velocity_x = 1}, {.x = 3.45, .y = 0.6}};
  Dynamics dynamics = pressed(StepAlgorithm::nlgs);
  BoundarySpec side = wall(floor_wall().name, {4, 0}, {4, 3});
  side.part = true;
  dynamics.boundaries = {floor_wall(), side};
  Simulation whole = simulation_of(grains, dynamics);
  const DatboxWriter writer(whole);
  REQUIRE(writer.without_datbox().empty());
  Simulation back = read_back(texts_of(writer, {whole.state, {}}), whole);
  CHECK(back.system.boundaries.size() == 2);
  advance(whole, 20);
  advance(back, 20);
  CHECK(whole.state.impulses.size() == back.state.impulses.size());
  for (std::size_t i = 0; i < 2; ++i) CHECK(back.state.x[i] == doctest::Approx(whole.state.x[i]).epsilon(1e-6));
  dynamics.boundaries[0].body = FreeBody{.directions = {true}, .mass = 1};
  check_error([&] { DatboxWriter{simulation_of(grains, dynamics)}; }, {"LMGC90", "'floor'", "of one wall", "several"});
}

TEST_CASE("bodies: no DATBOX is written of a case with rules for pairs of colours") {
  Simulation simulation = pressed_bed(pressed(StepAlgorithm::nlgs));
  simulation.dynamics.boundaries.back().body->load.oscillations.clear();
  simulation.dynamics.pairs = {{{"", ""}, {.touch = false}}};
  CHECK(DatboxWriter(simulation).without_datbox().find("pair") != std::string::npos);
}
