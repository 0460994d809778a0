// SPDX-License-Identifier: GPL-3.0-or-later
// Clumps of a text of YADE: masses, falls, impacts beside the centre and rolling, in closed form.
#include "simulation/clumps.hpp"

#include "../support/run_program.hpp"
#include "../support/spheres.hpp"
#include "../support/spoilt.hpp"
#include "formats/case/case_file.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <doctest/doctest.h>

#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

const std::string clump_head = "#format x_y_z_r_clumpId\n# as yade.export.textClumps writes it\n";
// A dumbbell along (4, 0, 3)/5 above z = 0, half a metre from its middle to the centres, and a sphere far away.
const std::string dumbbell = clump_head + "-0.4\t0\t0.25\t0.25\t7\n9\t9\t9\t0.5\t-1\n0.4\t0\t0.85\t0.25\t7\n";
constexpr double bell_density = 1000, bell_radius = 0.25, bell_half = 0.5;
constexpr double bell_ball = bell_density * 4 / 3 * std::numbers::pi * bell_radius * bell_radius * bell_radius;
constexpr double bell_along = 2 * 0.4 * bell_ball * bell_radius * bell_radius,
                 bell_across = bell_along + 2 * bell_ball * bell_half * bell_half;

// The case of a text of clumps, above a floor z = 0.
Case case_of_clumps(const std::string& text, const std::string& dynamics, const std::string& more = "") {
  const TemporaryFolder folder;
  write_file(folder / "clumps.txt", text);
  write_file(folder / "case.toml",
             "[packing]\nfile = \"clumps.txt\"\n[masses]\ndensity = 1000\n[partition]\n"
             "grid = [1, 1]\n[solver]\ntolerance = 1e-13\n[dynamics]\n" +
                 dynamics +
                 "\n[[boundary]]\nname = \"floor\"\nshape = \"wall\"\npoint = [0, 0, 0]\n"
                 "normal = [0, 0, 1]\n" +
                 more);
  return resolve(read_case((folder / "case.toml").string()));
}

const RigidVelocity& of_bell(const Simulation& simulation) { return simulation.state.body_velocities[1]; }

}  // namespace

TEST_CASE("clumps of YADE: mass, centre, moments and axes of a dumbbell whose grains are not neighbours") {
  const Simulation simulation = simulation_of(case_of_clumps(dumbbell, "steps = 1"));
  REQUIRE(simulation.system.free_bodies == std::vector<Index>{1});
  CHECK(simulation.system.driven_by == std::vector<Index>{1, -1, 1});
  const Boundary& body = simulation.system.boundaries[1];
  CHECK(body.name == "clump 7");
  CHECK(body.body->wholly_free(3));
  CHECK(body.body->mass == doctest::Approx(2 * bell_ball).epsilon(1e-14));
  const std::array<double, 3> centre{0, 0, 0.55};
  for (std::size_t k = 0; k < 3; ++k) CHECK(body.motion.centre[k] == doctest::Approx(centre[k]).epsilon(1e-14));
  CHECK(body.body->inertia[0] == doctest::Approx(bell_along).epsilon(1e-13));
  for (std::size_t k = 1; k < 3; ++k) CHECK(body.body->inertia[k] == doctest::Approx(bell_across).epsilon(1e-13));
  const Vector3 axis = body.body->axes.toRotationMatrix().col(0);
  CHECK(std::abs(axis.dot(Vector3(0.8, 0, 0.6))) == doctest::Approx(1).epsilon(1e-14));
}

TEST_CASE("clumps of YADE: every grain counts whole, also where it overlaps; in the plane and across a cell") {
  const auto body = [](const std::string& text, const Period& period) {
    return clumps_of(with_masses(parse_packing(text, "p"), {MassModel::density, 1}), period).at(0);
  };
  // Disks of radii 1 and 2 whose centres are 1 apart: masses pi and 4 pi, centre at 0.8.
  for (const double shift : {0.0, 7.0}) {
    const std::string text = clump_head + "0 0 5 1 3\n" + std::to_string(1 - shift) + " 0 5 2 3\n";
    const BoundarySpec one = body(text, {.x = shift});
    CHECK(one.dimension == 2);
    CHECK(one.body->mass == doctest::Approx(5 * std::numbers::pi).epsilon(1e-14));
    CHECK(one.motion.centre[0] == doctest::Approx(0.8).epsilon(1e-14));
    const double inertia = std::numbers::pi * (0.5 + 0.64) + 4 * std::numbers::pi * (2 + 0.04);
    CHECK(one.body->inertia[2] == doctest::Approx(inertia).epsilon(1e-14));
    CHECK(one.body->directions == std::array<bool, 6>{true, true, false, false, false, true});
    CHECK(std::pair(one.first, one.last) == std::pair<Index, Index>(0, 1));
  }
}

TEST_CASE("clumps of YADE: a dumbbell falls on a parabola with its grains") {
  Simulation simulation = simulation_of(
      case_of_clumps(clump_head + "-0.4 0 8.25 0.25 7\n9 9 9 0.5 -1\n0.4 0 8.85 0.25 7\n", "step = 0.01\nsteps = 20"));
  advance_in_space(simulation, 20);
  const double fall = g * 0.2 * 0.2 / 2;
  CHECK(simulation.state.poses[1].z == doctest::Approx(8.55 - fall).epsilon(1e-13));
  CHECK(simulation.state.z[0] == doctest::Approx(8.25 - fall).epsilon(1e-13));
  CHECK(simulation.state.z[2] == doctest::Approx(8.85 - fall).epsilon(1e-13));
  CHECK(simulation.state.x[2] == doctest::Approx(0.4).epsilon(1e-13));
}

TEST_CASE("clumps of YADE: a dumbbell hits the floor beside its centre: the impulse of a rigid body") {
  constexpr double e = 0.6, v = -3, w = 0.5, arm = 0.4, mass = 2 * bell_ball;
  Simulation simulation = simulation_of(case_of_clumps(dumbbell,
                                                       "step = 1e-8\nsteps = 1\ngravity = [0, 0, 0]\n[interaction]\n"
                                                       "friction = 0\nrestitution = 0.6"));
  simulation.state.body_velocities[1] = {.z = v, .spin_y = w};
  advance_in_space(simulation);
  // The contact is at (-0.4, 0, -0.55) from the centre: v_n = v + 0.4 w, and n turns about y by 0.4 n.
  const double impulse = -(1 + e) * (v + arm * w) / (1 / mass + arm * arm / bell_across);
  CHECK(of_bell(simulation).z == doctest::Approx(v + impulse / mass).epsilon(1e-6));
  CHECK(of_bell(simulation).spin_y == doctest::Approx(w + arm * impulse / bell_across).epsilon(1e-6));
  CHECK(std::abs(of_bell(simulation).x) < 1e-6);
  CHECK(std::abs(of_bell(simulation).spin) < 1e-6);
}

TEST_CASE("clumps of YADE: a dumbbell rolls on both of its spheres as one of them would: 5/7 g sin(alpha)") {
  Simulation simulation =
      simulation_of(case_of_clumps(clump_head + "0 -0.5 0.25 0.25 1\n0 0.5 0.25 0.25 1\n9 9 99 0.5 -1\n",
                                   "step = 1e-3\nsteps = 50\ngravity = [3, 0, -9]\n[interaction]\nfriction = 1"));
  advance_in_space(simulation, 50);
  const double speed = 5.0 / 7 * 3 * 0.05;
  CHECK(of_bell(simulation).x == doctest::Approx(speed).epsilon(1e-9));
  CHECK(of_bell(simulation).spin_y == doctest::Approx(speed / bell_radius).epsilon(1e-9));
}

TEST_CASE("clumps of YADE: a boundary of the case may have all grains of a clump, not some, nor its name") {
  const std::string drive = "[[boundary]]\nname = \"held\"\nshape = \"grains\"\ngrains = [2, 0]\n";
  const Case held = case_of_clumps(dumbbell, "steps = 1", drive);
  CHECK(held.spec.dynamics->boundaries.size() == 2);
  const std::vector<Index> held_by{1, -1, 1};
  CHECK(simulation_of(held).system.driven_by == held_by);
  // A case is written with its bodies and means the same.
  const Case one = case_of_clumps(dumbbell, "steps = 1");
  Case again{parse_case(to_toml(one.spec), "c.toml"), one.packing};
  CHECK(to_toml(again.spec) == to_toml(one.spec));
  add_clumps(again);
  CHECK(to_toml(again.spec) == to_toml(one.spec));
  check_error([&] { case_of_clumps(dumbbell, "steps = 1", replaced(drive, "[2, 0]", "[0, 1]")); },
              {"case.toml", "clump 7", "all of its 2 grains", "met 1 in 1"});
  const std::string two =
      replaced(drive, "[2, 0]", "[0]") + replaced(replaced(drive, "held", "other"), "[2, 0]", "[2]");
  check_error([&] { case_of_clumps(dumbbell, "steps = 1", two); }, {"clump 7", "all of its 2 grains", "met 2 in 2"});
  const std::string one_body = replaced(two, "name = \"other\"", "part_of = \"held\"");
  CHECK(simulation_of(case_of_clumps(dumbbell, "steps = 1", one_body)).system.driven_by == held_by);
  check_error([&] { case_of_clumps(dumbbell, "steps = 1", replaced(replaced(drive, "held", "clump 7"), "2, 0", "1")); },
              {"case.toml", "'clump 7'", "another name"});
}

TEST_CASE("clumps of YADE: two that overlap by more than half a radius are refused by name") {
  const Case one = case_of_clumps(clump_head + "0 0 5 0.5 1\n1 0 5 0.5 1\n0 0 5.7 0.5 2\n1 0 6 0.5 2\n", "steps = 1");
  check_error([&] { simulation_of(one); },
              {"case.toml", "sphere 0 of boundary 'clump 1'", "sphere 2 of boundary 'clump 2'", "expected an overlap"});
}
