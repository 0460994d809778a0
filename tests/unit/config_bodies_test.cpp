// SPDX-License-Identifier: GPL-3.0-or-later
// [[boundary]] with free directions, planks, [[colour]] and [[pair]] of a case file: read, written, refused.
#include "../support/moving_case.hpp"
#include "../support/spoilt.hpp"
#include "formats/case/case_file.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

CaseSpec parse_bodies(const std::string& text) { return parse_case(text, "c.toml"); }

// A clump at the origin, a plank that is pushed down, and pairs of colours.
const std::string bodies_in_plane =
    case_text("hexagonal\ncolumns = 3\nrows = 3", "1, 1", "[masses]\ndensity = 2\n[dynamics]\nsteps = 3\n") +
    "[interaction]\nsignorini = \"velocity\"\n"
    "[[boundary]]\nname = \"clump\"\nshape = \"grains\"\nfirst = 0\nlast = 1\ncolour = \"red\"\n"
    "free = [\"x\", \"spin\", \"y\"]\nmass = 3\ninertia = 0.25\ncentre = [0, 0]\n"
    "force = [1, -2]\ntorque = 0.5\n"
    "[[boundary.load_oscillation]]\nforce = [4, 5]\nomega = 6\nphase = 0.5\nramp = 0\ngrowth = 2\n"
    "[[boundary]]\nname = \"top\"\nshape = \"plank\"\nfrom = [-1, 9]\nto = [7, 9]\nradius = 0.5\n"
    "centre = [3, 9]\nfree = [\"y\"]\nmass = 8\nvelocity = [0.5, 0]\ncolour = \"steel\"\n"
    "load = [[0, 0, 0, 0], [0.5, 0, -20, 0]]\n"
    "[[colour]]\nname = \"red\"\nfirst = 2\nlast = 3\n"
    "[[colour]]\nname = \"blue\"\nfirst = 4\nlast = -1\n"
    "[[pair]]\ncolours = [\"red\", \"steel\"]\nfriction = 0.125\nrestitution = 0.75\ntangential_restitution = 0.5\n"
    "[[pair]]\ncolours = [\"blue\", \"red\"]\ntouch = false\n";

const std::string bodies_in_space =
    case_text("fcc", "1, 1, 1", "[masses]\ndensity = 2\n[dynamics]\nsteps = 3\n") +
    "[[boundary]]\nname = \"clump\"\nshape = \"grains\"\nfirst = 0\nlast = 1\n"
    "free = [\"x\", \"y\", \"z\", \"spin_x\", \"spin_y\", \"spin\"]\nmass = 3\ninertia = [1, 2, 4]\n"
    "axes = [0.6, 0, 0.8, 0]\ncentre = [0, 0, 0]\nforce = [1, 2, 3]\ntorque = [4, 5, 6]\n"
    "torque_turns = true\n[[boundary.load_oscillation]]\ntorque = [0, 0, 7]\nomega = 8\n"
    "[[boundary]]\nname = \"board\"\nshape = \"plank\"\npoint = [1, 2, -9]\nnormal = [0, 0, 2]\naxis = [0, 1, 0]\n"
    "length = 4\nwidth = 3\nradius = 0.25\nvelocity = [0, 0, 1]\n"
    "[[boundary]]\nname = \"lid\"\nshape = \"wall\"\npoint = [0, 0, 90]\nnormal = [0, 0, -1]\n"
    "free = [\"z\"]\nmass = 5\ncentre = [0, 0, 90]\nload = [[0, 0, 0, 0, 0, 0, 0], [1, 0, 0, -6, 0, 0, 0]]\n";

}  // namespace

TEST_CASE("bodies of a case: free directions, mass, inertia, loads and planks, written and read back") {
  const CaseSpec one = parse_bodies(bodies_in_plane), back = parse_bodies(to_toml(one));
  CHECK(to_toml(back) == to_toml(one));
  const std::vector<BoundarySpec>& found = back.dynamics->boundaries;
  REQUIRE(found.size() == 2);
  CHECK((found[0].dimension == 2 && found[0].colour == "red"));
  CHECK(found[0].motion.velocity.empty());
  REQUIRE(found[0].body.has_value());
  const FreeBody& clump = *found[0].body;
  CHECK(clump.directions == std::array<bool, 6>{true, true, false, false, false, true});
  CHECK(clump.mass == 3);
  CHECK(clump.inertia == std::array<double, 3>{0, 0, 0.25});
  for (const double t : {0.25, 3.0}) {
    const double part = std::cos(6 * t + 0.5) * std::min(1.0, 2 * t);
    CHECK(clump.load.at(t).x == doctest::Approx(1 + 4 * part).epsilon(1e-14));
    CHECK(clump.load.at(t).y == doctest::Approx(-2 + 5 * part).epsilon(1e-14));
    CHECK(clump.load.at(t).spin == 0.5);
  }
  const BoundarySpec& top = found[1];
  CHECK(top.shape == BoundaryShape::plank);
  CHECK(top.from == std::array<double, 3>{-1, 9, 0});
  CHECK(top.to == std::array<double, 3>{7, 9, 0});
  CHECK(top.radius == 0.5);
  CHECK(top.motion.at(1).x == 0.5);
  CHECK(top.body->directions == std::array<bool, 6>{false, true});
  CHECK(top.body->load.at(0.25).y == -10);
  CHECK(top.body->load.at(2).y == -20);
  // The system of the case has its bodies.
  const Simulation simulation = simulation_of(resolve(back));
  REQUIRE(simulation.system.free_bodies == std::vector<Index>{0, 1});
  CHECK(simulation.system.walls.at(0).plank());
  CHECK(simulation.system.walls.at(0).half_length == 4);
  CHECK(simulation.system.walls.at(0).point == std::array<double, 3>{3, 9, 0});
}

TEST_CASE("bodies of a case: more shapes of a body, written and read back, and of a source or of nothing") {
  const std::string part =
      "[[boundary]]\npart_of = \"top\"\nshape = \"disks\"\nfrom = [0, 10]\nto = [1, 10]\nradius = 0.5\n";
  const std::string round =
      "[[boundary]]\npart_of = \"top\"\nshape = \"cylinder\"\nfrom = [20, 9]\nradius = 1\nside = \"outside\"\n";
  const CaseSpec one = parse_bodies(bodies_in_plane + part + round), back = parse_bodies(to_toml(one));
  CHECK(to_toml(back) == to_toml(one));
  const GranularSystem system = simulation_of(resolve(back)).system;
  CHECK(system.boundaries.size() == 2);
  CHECK(std::pair(system.driven_by.at(9), system.driven_by.at(10)) == std::pair<Index, Index>(1, 1));
  CHECK(system.pairs.of(2, 10).friction == 0.125);  // steel, as the plank
  CHECK_FALSE(system.may_touch(9, system.grains()));
  const Spoilt spoilt{bodies_in_plane + part, parse_bodies};
  spoilt("part_of = \"top\"", "part_of = \"lid\"", {"boundary[2].part_of:", "before this one", "met \"lid\""});
  spoilt("part_of = \"top\"", "part_of = \"\"", {"boundary[2].part_of:", "not empty"});
  spoilt("part_of = \"top\"", "name = \"top\"", {"boundary[2].name:", "each name once"});
  spoilt("part_of = \"top\"\n", "part_of = \"top\"\nvelocity = [1, 0]\n", {"unknown key 'boundary[2].velocity'"});
  spoilt("part_of = \"top\"\n", "part_of = \"top\"\ncolour = \"red\"\n", {"unknown key 'boundary[2].colour'"});
}

TEST_CASE("bodies of a case: colours and rules of pairs, written and read back") {
  const CaseSpec back = parse_bodies(to_toml(parse_bodies(bodies_in_plane)));
  const Dynamics& dynamics = *back.dynamics;
  REQUIRE(dynamics.colours.size() == 2);
  CHECK(dynamics.colours[1].name == "blue");
  CHECK(std::pair(dynamics.colours[1].first, dynamics.colours[1].last) == std::pair<Index, Index>(4, -1));
  REQUIRE(dynamics.pairs.size() == 2);
  CHECK(dynamics.pairs[0].rule.touch);
  CHECK((dynamics.pairs[0].rule.friction == 0.125 && dynamics.pairs[0].rule.restitution == 0.75));
  CHECK(dynamics.pairs[0].rule.tangential_restitution == 0.5);
  CHECK_FALSE(dynamics.pairs[1].rule.touch);
  CHECK_FALSE(dynamics.pairs[1].rule.friction.has_value());
  const GranularSystem system = simulation_of(resolve(back)).system;
  const Index plank = system.grains();
  CHECK(system.pairs.of(2, plank).friction == 0.125);
  CHECK(system.pairs.of(1, plank).friction == 0.125);             // of the clump, which has the colour of its boundary
  CHECK(&system.pairs.of(4, plank) == &ContactPairs().of(0, 0));  // no rule
  CHECK(system.may_touch(4, 5));
  CHECK_FALSE(system.may_touch(2, 5));
  CHECK_FALSE(system.may_touch(0, 5));
  CHECK_FALSE(system.may_touch(0, 1));  // of one body
}

TEST_CASE("bodies of a case in space: principal axes, planks and loads, written and read back") {
  const CaseSpec one = parse_bodies(bodies_in_space), back = parse_bodies(to_toml(one));
  CHECK(to_toml(back) == to_toml(one));
  const std::vector<BoundarySpec>& found = back.dynamics->boundaries;
  REQUIRE(found.size() == 3);
  for (const BoundarySpec& each : found) CHECK(each.dimension == 3);
  const FreeBody& clump = *found[0].body;
  CHECK(clump.directions == std::array<bool, 6>{true, true, true, true, true, true});
  CHECK(clump.inertia == std::array<double, 3>{1, 2, 4});
  CHECK((clump.axes.coeffs() - Eigen::Vector4d(0, 0.8, 0, 0.6)).norm() < 1e-15);
  const RigidVelocity load = clump.load.at(0);
  CHECK(std::array{load.x, load.y, load.z, load.spin_x, load.spin_y, load.spin} ==
        std::array{1.0, 2.0, 3.0, 4.0, 5.0, 13.0});
  const BoundarySpec& board = found[1];
  CHECK(board.shape == BoundaryShape::plank);
  CHECK(board.point == std::array<double, 3>{1, 2, -9});
  CHECK(board.axis == std::array<double, 3>{0, 1, 0});
  CHECK(std::array{board.length, board.width, board.radius} == std::array{4.0, 3.0, 0.25});
  CHECK_FALSE(board.body.has_value());
  CHECK(found[2].body->load.at(0.5).z == -3);
  const Simulation simulation = simulation_of(resolve(one));
  CHECK(simulation.system.free_bodies == std::vector<Index>{0, 2});
  CHECK(simulation.system.walls.at(0).half_width == 1.5);
  CHECK(simulation.system.walls.at(0).normal == std::array<double, 3>{0, 0, 1});
}

TEST_CASE("bodies of a case: grains that are not neighbours are listed, from the end as well") {
  const CaseSpec one = parse_bodies(replaced(bodies_in_plane, "first = 0\nlast = 1\n", "grains = [-1, 0, 4]\n"));
  CHECK(to_toml(parse_bodies(to_toml(one))) == to_toml(one));
  const GranularSystem system = simulation_of(resolve(one)).system;
  CHECK(system.driven_by == std::vector<Index>{0, -1, -1, -1, 0, -1, -1, -1, 0});
  CHECK_FALSE(system.may_touch(0, 8));
}

TEST_CASE("bodies of a case: every error names file, line and key") {
  const Spoilt spoilt{bodies_in_plane, parse_bodies};
  spoilt("free = [\"x\", \"spin\", \"y\"]", "free = []", {"boundary[0].free:", "x, y, z, spin_x", "empty array"});
  spoilt("free = [\"x\", \"spin\", \"y\"]", "free = [\"x\", 3]", {"boundary[0].free:", "an array", "met"});
  spoilt("free = [\"x\", \"spin\", \"y\"]", "free = [\"x\", \"x\"]", {"each direction once", "met \"x\" again"});
  spoilt("free = [\"x\", \"spin\", \"y\"]", "free = [\"x\", \"w\"]", {"c.toml:", "free", "spin_x", "met \"w\""});
  spoilt("mass = 3\n", "", {"boundary[0].mass:", "met none"});
  spoilt("mass = 3\n", "mass = 0\n", {"boundary[0].mass:", "> 0"});
  spoilt("centre = [0, 0]\n", "", {"boundary[0].centre:", "met none"});
  spoilt("inertia = 0.25", "inertia = [1, 2, 3]", {"boundary[0].inertia:", "numbers for the plane"});
  spoilt("inertia = 0.25", "inertia = -0.25", {"c.toml:", "boundary[0].inertia:", ">= 0", "-0.25"});
  spoilt("mass = 8\n", "mass = 8\ninertia = -1\n", {"boundary[1].inertia:", ">= 0"});  // although it does not turn
  spoilt("inertia = 0.25\n", "inertia = 0.25\naxes = [1, 0, 0, 0]\n",
         {"c.toml:", "boundary[0].axes:", "numbers for the plane", "for space"});
  spoilt("first = 0\nlast = 1\ncolour", "grains = []\ncolour", {"boundary[0].grains:", "array of integers"});
  spoilt("first = 0\nlast = 1\ncolour", "grains = [0, 1.5]\ncolour", {"boundary[0].grains:", "array of integers"});
  spoilt("first = 0\n", "first = 0\ngrains = [0]\n", {"unknown key 'boundary[0].first'"});
  spoilt("force = [1, -2]", "force = [1, inf]", {"boundary[0].force"});
  spoilt("force = [1, -2]", "load = [[0, 1, 2, 3]]", {"boundary[0].load:", "force and torque", "met both"});
  spoilt("force = [4, 5]\n", "", {"boundary[0].load_oscillation[0].force:", "amplitudes", "met neither"});
  spoilt("omega = 6\n", "", {"boundary[0].load_oscillation[0].omega:", "met none"});
  spoilt("[0.5, 0, -20, 0]]", "[0, 0, -20, 0]]", {"boundary[1].load:", "ascending", "met 0 s after 0 s"});
  spoilt("[0.5, 0, -20, 0]]", "[0.5, 0, -20]]", {"boundary[1].load:", "torque", "array of 3"});
  spoilt("from = [-1, 9]\nto = [7, 9]\nradius = 0.5\n", "from = [-1, 9]\nto = [7, 9]\n",
         {"boundary[1].radius:", "met none"});
  spoilt("to = [7, 9]", "to = [-1, 9]", {"boundary[1].to:", "another point"});
  spoilt("from = [-1, 9]\nto = [7, 9]", "point = [3, 9]\nnormal = [0, 1]",
         {"boundary[1].point:", "from and to of a plank"});
  spoilt("colour = \"steel\"\n", "mass_of = 3\n", {"unknown key 'boundary[1].mass_of'"});
  spoilt("free = [\"y\"]\n", "", {"unknown key 'boundary[1].load'"});
  spoilt("colours = [\"red\", \"steel\"]", "colours = [\"red\"]", {"pair[0].colours:", "two texts"});
  spoilt("friction = 0.125", "friction = -1", {"pair[0].friction:", ">= 0"});
  spoilt("restitution = 0.75", "restitution = 1.5", {"pair[0].restitution:", "<= 1"});
  spoilt("signorini = \"velocity\"", "signorini = \"gap\"", {"pair[0].restitution:", "interaction.signorini", "gap"});
  spoilt("touch = false\n", "", {"pair[1].touch:", "a friction, a restitution", "met a pair without a rule"});
  spoilt("touch = false", "touch = false\nfriction = 0", {"pair[1].friction:", "none with touch = false"});
  spoilt("signorini =", "law = \"frictionless\"\nsignorini =", {"pair[0].friction:", "interaction.law coulomb"});
  spoilt(bodies_in_plane.substr(bodies_in_plane.find("[[pair]]")), "", {"colour:", "a section [[pair]] with it"});
  spoilt("free = [\"y\"]\n", "free = [\"y\"]\ninitial_velocity = [1, 1]\n", {"boundary[1].initial_velocity:", "end"});
  spoilt("first = 4\n", "", {"colour[1].first:", "met none"});
  spoilt("[dynamics]\nsteps = 3\n[interaction]\nsignorini = \"velocity\"\n", "", {"[dynamics]"});
  const Spoilt space{bodies_in_space, parse_bodies};
  space("axes = [0.6, 0, 0.8, 0]", "axes = [0.6, 0, 0.9, 0]", {"boundary[0].axes:", "unit quaternion"});
  space("axes = [0.6, 0, 0.8, 0]", "axes = [0.6, 0, 0.8]", {"boundary[0].axes:", "unit quaternion"});
  space("inertia = [1, 2, 4]", "inertia = [1, 2, -4]", {"boundary[0].inertia:", ">= 0"});
  space("mass = 5\n", "mass = 5\naxes = [1, 0, 0, 0]\n", {"boundary[2].axes:", "free rotations", "none"});
  space("inertia = [1, 2, 4]", "inertia = 1", {"boundary[0]", "numbers for"});
  space("axis = [0, 1, 0]\n", "", {"boundary[1].axis:", "met none"});
  space("axis = [0, 1, 0]", "axis = [0, 1, 1]", {"'board'", "axis", "across the normal"});
  space("length = 4", "length = 0", {"boundary[1].length:", "> 0"});
  space("width = 3", "width = -3", {"boundary[1].width:", ">= 0"});
  space("point = [1, 2, -9]\nnormal = [0, 0, 2]", "from = [1, 2, -9]\nto = [0, 0, 2]",
        {"boundary[1].from:", "point and normal of a plank in space"});
}

TEST_CASE("bodies of a case: what does not fit the packing or the directions is refused when it is built") {
  const auto refused_in = [](const std::string& text, const std::string& from, const std::string& to,
                             const Names& names) {
    CAPTURE(to);
    check_error([&] { simulation_of(resolve(parse_bodies(replaced(text, from, to)))); }, names);
  };
  refused_in(bodies_in_plane, "\"spin\", \"y\"]", "\"spin\", \"y\", \"z\"]",
             {"c.toml:", ": boundary[0]: boundary 'clump'", "in the plane", "met z"});
  refused_in(bodies_in_plane, "velocity = [0.5, 0]", "velocity = [0.5, 1]",
             {"c.toml:", "boundary[1]: boundary 'top'", "free or driven", "y as both"});
  refused_in(bodies_in_plane, "[0.5, 0, -20, 0]]", "[0.5, 1, -20, 0]]",
             {"c.toml:", "boundary[1]:", "free directions", "along x"});
  refused_in(bodies_in_plane, "first = 0\nlast = 1\n", "first = 1\nlast = 0\n",
             {"c.toml:", "boundary[0].first", "first <= last", "met 1 and 0", "'clump'"});  // no contactor
  refused_in(bodies_in_plane, "first = 0\nlast = 1\n", "grains = [0, 9]\n",
             {"c.toml:", "boundary[0].grains", "0..8", "met 9", "'clump'"});
  refused_in(bodies_in_plane, "first = 0\nlast = 1\n", "grains = [8, 0, -1]\n",
             {"boundary[0].grains", "grain 8 twice"});
  refused_in(case_text("hexagonal\ncolumns = 3\nrows = 3", "1, 1", "[dynamics]\nsteps = 3\n"), "[dynamics]",
             "[contacts]\nperiod_x = 1.9\n[dynamics]", {"c.toml:", "contacts.period_x", "two diameters", "met 1.9"});
  refused_in(bodies_in_plane, "inertia = 0.25\n", "", {"c.toml:", "boundary[0]:", "moments of inertia > 0"});
  refused_in(bodies_in_plane, "first = 4\nlast = -1", "first = 4\nlast = 9",
             {"colour[1].first", "0..8", "met 4 and 9"});
  refused_in(bodies_in_plane, "[\"blue\", \"red\"]", "[\"blue\", \"green\"]", {"pair[1].colours", "met \"green\""});
  refused_in(bodies_in_plane, "[\"blue\", \"red\"]", "[\"steel\", \"red\"]", {"pair[1].colours", "each pair once"});
  refused_in(replaced(bodies_in_space, "torque = [4, 5, 6]", "torque = [0, 0, 6]"), "\"spin_x\", \"spin_y\", ", "",
             {"'clump'", "all rotations free in space, or none", "1 of 3"});
  refused_in(bodies_in_space, "inertia = [1, 2, 4]", "inertia = [1, 0, 4]", {"'clump'", "moments of inertia > 0"});
  refused_in(case_text("fcc", "1, 1, 1", "[masses]\ndensity = 2\n[dynamics]\nsteps = 3\n") +
                 "[[boundary]]\nname = \"board\"\nshape = \"plank\"\nfrom = [0, 0]\nto = [1, 0]\nradius = 1\n",
             "radius = 1", "radius = 2", {"'board'", "plank by point and normal"});
}
