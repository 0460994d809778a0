// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of LMGC90 that move freely along some degrees of freedom, their forces, and laws of pairs of colours, by hand.
#include "../support/datbox_texts.hpp"
#include "../support/run_program.hpp"
#include "../support/spoilt.hpp"

#include <doctest/doctest.h>

#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

using std::numbers::pi;

// A line of DRV_DOF.DAT: CT, AMP, OMEGA, PHI, RAMPI and RAMP, as texts of 14 columns.
std::string drive_line(const std::string& kind, int dof, const std::string& constant,
                       const std::string& ramp = " 0.1000000D+01  0.0000000D+00") {
  return " " + kind + "      " + std::to_string(dof) + " " + constant +
         "  0.0000000D+00  0.0000000D+00  0.0000000D+00 " + ramp + "\n";
}

std::string body_of_drives(bool space, int body, const std::string& lines) {
  const std::string number = std::to_string(body);
  return std::string("$bdyty\n ") + (space ? "RBDY3" : "RBDY2") + std::string(9 - number.size(), ' ') + number +
         "\n$nodty\n " + (space ? "NO6xx" : "NO3xx") + "      1\n$dofty\n" + lines + "$$$$$$\n";
}

// Velocities of a body in the plane that DOF.INI has.
std::string initial_lines(int body, const std::string& velocities) {
  return "$bdyty\n RBDY2        " + std::to_string(body) +
         "\n$nodty\n NO3xx      1                X(1)= 0.0000000D+00  X(2)= 0.0000000D+00  X(3)= 0.0000000D+00\n" +
         std::string(29, ' ') + velocities + "\n$$$$$$\n";
}

Dynamics dynamics_of(const DatboxTexts& texts) { return datbox_dynamics(parse_datbox(texts, "box")); }

// The law iqsc1 replaced; numbers begin in column 46.
DatboxTexts with_law(const std::string& law) {
  DatboxTexts texts = small_datbox();
  texts.tact = replaced(texts.tact, "iqsc1  IQS_CLB                         fric= 0.5000000D+00", "iqsc1  " + law);
  return texts;
}

// A kind of law, up to the first name of a number.
std::string law_head(const std::string& kind) { return kind + std::string(32 - kind.size(), ' '); }

std::string numbers_line(const std::string& numbers) { return "\n" + std::string(40, ' ') + numbers; }

Eigen::Vector3d in_plane(const RigidVelocity& v) { return {v.x, v.y, v.spin}; }
Eigen::Vector3d force_of(const Motion& load, double t) { return in_plane(load.at(t)); }

}  // namespace

TEST_CASE("DATBOX: a plank that nothing drives is free, with the mass and inertia of its averaged radii") {
  DatboxTexts texts = small_datbox();
  texts.driven = texts.driven.substr(texts.driven.find("$bdyty", 1));  // that of the cluster
  texts.initial += initial_lines(2, "V(1)= 0.1000000D+01  V(2)= 0.2000000D+01  V(3)= 0.3000000D+01");
  const BoundarySpec plank = dynamics_of(texts).boundaries.at(0);
  CHECK(plank.name == "body 2");
  CHECK(plank.shape == BoundaryShape::plank);
  CHECK(plank.motion.centre == std::array<double, 3>{0, -0.5, 0});
  REQUIRE(plank.body.has_value());
  CHECK(plank.body->directions == std::array<bool, 6>{true, true, false, false, false, true});
  CHECK(plank.body->mass == doctest::Approx(5000 * pi));
  CHECK(plank.body->inertia[2] == doctest::Approx(5000 * pi));  // gyrd = 1
  CHECK(plank.body->load.velocity.empty());
  CHECK(in_plane(plank.motion.initial.value()) == Eigen::Vector3d(1, 2, 3));
  CHECK(plank.motion.velocity.empty());
  texts.bodies =
      replaced(texts.bodies, "avrd= 0.1000000D+01  gyrd= 0.1000000D+01", "avrd= 0.1000000D+01  gyrd= 0.0000000D+00");
  const FreeBody own = *dynamics_of(texts).boundaries.at(0).body;  // half axes 3 and 0.5, as LMGC90 counts them
  CHECK(own.mass == doctest::Approx(5000 * (6 + pi / 4)));
  CHECK(own.inertia[2] == doctest::Approx(5000 * (pi / 4 * 9.125 + 3 * 9.25)));
}

TEST_CASE("DATBOX: a plank that is driven along some degrees of freedom and pushed along another") {
  DatboxTexts texts = small_datbox();
  texts.driven = replaced(texts.driven, "vlocy      2  0.3000000D+01", "force      2  0.3000000D+01");
  const BoundarySpec plank = dynamics_of(texts).boundaries.at(0);
  REQUIRE(plank.body.has_value());
  CHECK(plank.body->directions == std::array<bool, 6>{false, true});
  CHECK(plank.body->mass == doctest::Approx(5000 * pi));
  // 3 N times min(1, 1/4 + t/2) from t = 0.5 s on, the time of DOF.INI, which is 0 here.
  CHECK(plank.body->load.time == std::vector<double>{0, 1});
  CHECK(force_of(plank.body->load, 0) == Eigen::Vector3d(0, 1.5, 0));
  CHECK(force_of(plank.body->load, 0.5) == Eigen::Vector3d(0, 2.25, 0));
  CHECK(force_of(plank.body->load, 2) == Eigen::Vector3d(0, 3, 0));
  CHECK(plank.motion.at(0.5).y == 0);
  CHECK(plank.motion.velocity.size() == 1);  // what is driven is at rest
  // The pushed plank is seen as a boundary: it keeps the friction of boundaries.
  CHECK(scene(datbox_packing(parse_datbox(texts, "box"), DatboxGrains::all), dynamics_of(texts)).system.is_boundary(3));
}

TEST_CASE("DATBOX: a force oscillates from the time of DOF.INI on, and may be a table") {
  DatboxTexts texts = small_datbox();
  texts.driven =
      replaced(texts.driven, "vlocy      2  0.3000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.2500000D+00",
               "force      2  0.3000000D+01  0.2000000D+01  0.4000000D+01  0.1000000D+00  0.2500000D+00");
  const Motion load = dynamics_of(texts).boundaries.at(0).body->load;
  REQUIRE(load.oscillations.size() == 1);
  for (const double t : {0.0, 0.25, 3.0})
    CHECK(load.at(t).y ==
          doctest::Approx((3 + 2 * std::cos(4 * (t + 0.5) + 0.1)) * std::min(1.0, 0.25 + 0.5 * (t + 0.5))));
  texts = small_datbox();
  texts.driven = replaced(texts.driven,
                          "vlocy      2  0.3000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.2500000D+00"
                          "  0.5000000D+00",
                          "force      2 evolution push.dat");
  texts.table = [](const std::string& name) {
    CHECK(name == "push.dat");
    return std::string("0 0\n1 10\n2 10\n");
  };
  const Motion table = dynamics_of(texts).boundaries.at(0).body->load;
  for (const auto& [t, y] : {std::pair(0.0, 5.0), {0.25, 7.5}, {9.0, 10.0}}) CHECK(table.at(t).y == doctest::Approx(y));
}

TEST_CASE("DATBOX: a free disk with a force or with another inertia is a body of one grain") {
  DatboxTexts texts = small_datbox();
  texts.driven +=
      body_of_drives(false, 1, drive_line("force", 1, " 0.4000000D+01") + drive_line("force", 3, "-0.5000000D+00"));
  const Dynamics pushed = dynamics_of(texts);
  REQUIRE(pushed.boundaries.size() == 3);
  const BoundarySpec& disk = pushed.boundaries[0];
  CHECK(disk.name == "body 1");
  CHECK(disk.shape == BoundaryShape::grains);
  CHECK(std::pair(disk.first, disk.last) == std::pair<Index, Index>(0, 0));
  REQUIRE(disk.body.has_value());
  CHECK(disk.body->directions == std::array<bool, 6>{true, true, false, false, false, true});
  CHECK(disk.body->mass == doctest::Approx(1000 * pi * 0.04));  // by avrd, not by byrd
  CHECK(disk.body->inertia[2] == doctest::Approx(1000 * pi * 0.04 * 0.03125));
  CHECK(force_of(disk.body->load, 1) == Eigen::Vector3d(4, 0, -0.5));
  CHECK(disk.motion.centre == std::array<double, 3>{1.5, 1.75, 0});
  CHECK(in_plane(disk.motion.initial.value()) == Eigen::Vector3d(7, -8, 0));
  texts = small_datbox();
  texts.bodies = replaced(texts.bodies, "gyrd= 0.1767767D+00", "gyrd= 0.2000000D+00");
  const Dynamics ring = dynamics_of(texts);
  REQUIRE(ring.boundaries.size() == 3);
  CHECK(ring.boundaries[0].body->mass == doctest::Approx(1000 * pi * 0.04));
  CHECK(ring.boundaries[0].body->inertia[2] == doctest::Approx(1000 * pi * 0.04 * 0.04));
  CHECK(ring.boundaries[0].body->load.velocity.empty());
  check_error([&] { datbox_packing(parse_datbox(texts, "box"), DatboxGrains::free); }, {"BODIES.DAT:4: gyrd"});
}

TEST_CASE("DATBOX: the linear study takes the mass of a disk with a force from avrd, as that of any free disk") {
  DatboxTexts texts = small_datbox();
  texts.driven += body_of_drives(false, 1, drive_line("force", 1, " 0.4000000D+01"));
  CHECK(datbox_packing(parse_datbox(texts, "box"), DatboxGrains::free).mass.at(0) == doctest::Approx(1000 * pi * 0.04));
}

TEST_CASE("DATBOX: a free cluster in the plane has the centre of its areas if its node is at 0") {
  DatboxTexts texts = small_datbox();
  texts.driven = texts.driven.substr(0, texts.driven.find("$bdyty", 1));
  texts.bodies =
      replaced(texts.bodies, "avrd= 0.0000000D+00  gyrd= 0.0000000D+00", "avrd= 0.1000000D+01  gyrd= 0.5000000D+00");
  const BoundarySpec askew = dynamics_of(texts).boundaries.at(1);
  CHECK(askew.motion.centre == std::array<double, 3>{10, 20, 0});
  REQUIRE(askew.body.has_value());
  CHECK(askew.body->directions == std::array<bool, 6>{true, true, false, false, false, true});
  CHECK(askew.body->mass == doctest::Approx(5000 * pi));
  CHECK(askew.body->inertia[2] == doctest::Approx(5000 * pi / 4));
  CHECK(std::pair(askew.first, askew.last) == std::pair<Index, Index>(1, 2));
  texts.bodies = replaced(texts.bodies, "coo1= 0.1000000D+02  coo2= 0.2000000D+02  coo3= 0.1570796D+01",
                          "coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00");
  const BoundarySpec at_zero = dynamics_of(texts).boundaries.at(1);  // areas 1 and 4 at (3, 0) and (0, 4)
  CHECK(at_zero.motion.centre[0] == doctest::Approx(0.6));
  CHECK(at_zero.motion.centre[1] == doctest::Approx(3.2));
  const Packing packing = datbox_packing(parse_datbox(texts, "box"), DatboxGrains::all);
  CHECK(packing.x.at(1) == doctest::Approx(3));
  CHECK(packing.y.at(2) == doctest::Approx(4));
  check_error([&] { datbox_packing(parse_datbox(texts, "box"), DatboxGrains::free); },
              {"BODIES.DAT:24:", "met one of 2", "free clusters"});
}

TEST_CASE("DATBOX: a free cluster in the plane has the mass and inertia of whole disks about its node if both are 0") {
  DatboxTexts texts = small_datbox();
  texts.driven = texts.driven.substr(0, texts.driven.find("$bdyty", 1));
  const FreeBody askew = *dynamics_of(texts).boundaries.at(1).body;  // radii 1 and 2 at (3, 0) and (0, 4)
  CHECK(askew.mass == doctest::Approx(5000 * pi * (1 + 4)));
  CHECK(askew.inertia[2] == doctest::Approx(5000 * pi * (0.5 + 9 + 4 * (2 + 16))));
  texts.bodies = replaced(texts.bodies, "avrd= 0.0000000D+00  gyrd= 0.0000000D+00",
                          "avrd= 0.1000000D+01  gyrd= 0.0000000D+00");  // LMGC90 then computes both
  CHECK(dynamics_of(texts).boundaries.at(1).body->mass == doctest::Approx(5000 * pi * 5));
  texts.bodies = replaced(texts.bodies, "coo1= 0.1000000D+02  coo2= 0.2000000D+02  coo3= 0.1570796D+01",
                          "coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00");
  const FreeBody central = *dynamics_of(texts).boundaries.at(1).body;  // about (0.6, 3.2)
  CHECK(central.inertia[2] == doctest::Approx(5000 * pi * (0.5 + 16 + 4 * (2 + 1))));
}

TEST_CASE("DATBOX: a free cluster of spheres has the centre, mass, principal moments and axes of whole spheres") {
  DatboxTexts texts = small_datbox_in_space();
  texts.driven = texts.driven.substr(0, texts.driven.find("$bdyty", 1));
  // Radii 1, their centre (1, 2, -4) + (1, 1, 2), 5 m to either side along (3, 4, 0).
  texts.bodies = replaced(texts.bodies, " SPHER      1  color  ROUGE  byrd= 0.2000000D+01\n",
                          " SPHEb      1  color  ROUGE  byrd= 0.1000000D+01\n" + std::string(29, ' ') +
                              "coo1= 0.4000000D+01  coo2= 0.5000000D+01  coo3= 0.2000000D+01\n"
                              " SPHEb      2  color  ROUGE  byrd= 0.1000000D+01\n" +
                              std::string(29, ' ') + "coo1=-0.2000000D+01  coo2=-0.3000000D+01  coo3= 0.2000000D+01\n");
  const Datbox datbox = parse_datbox(texts, "box");
  const Packing packing = datbox_packing(datbox, DatboxGrains::all);
  const BoundarySpec clump = datbox_dynamics(datbox).boundaries.at(1);
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(clump.motion.centre[k] == doctest::Approx(std::array{2.0, 3.0, -2.0}[k]));
    CHECK(packing.centre(1)[k] == doctest::Approx(std::array{5.0, 7.0, -2.0}[k]));
    CHECK(packing.centre(2)[k] == doctest::Approx(std::array{-1.0, -1.0, -2.0}[k]));
  }
  REQUIRE(clump.body.has_value());
  const FreeBody& body = *clump.body;
  CHECK(body.directions == std::array<bool, 6>{true, true, true, true, true, true});
  const double mass = 5000 * 4.0 / 3 * pi;  // of a sphere
  CHECK(body.mass == doctest::Approx(2 * mass));
  CHECK(body.inertia[0] == doctest::Approx(2 * mass * 0.4));
  CHECK(body.inertia[1] == doctest::Approx(2 * mass * 25.4));
  CHECK(body.inertia[2] == doctest::Approx(2 * mass * 25.4));
  CHECK(std::abs((body.axes * Eigen::Vector3d::UnitX()).dot(Eigen::Vector3d(0.6, 0.8, 0))) == doctest::Approx(1));
  CHECK(body.axes.norm() == doctest::Approx(1).epsilon(1e-14));
  // Given moments stay, along the axes x, y and z.
  texts.bodies.insert(texts.bodies.rfind("$nodty"),
                      std::string(29, ' ') + "I1  = 0.1000000D+01  I2  = 0.2000000D+01  I3  = 0.3000000D+01\n");
  const FreeBody given = *dynamics_of(texts).boundaries.at(1).body;
  CHECK(given.inertia == std::array<double, 3>{5000, 10000, 15000});
  CHECK(given.axes.w() == 1);
}

TEST_CASE("DATBOX: two planks and a sphere are one body; planks side by side weigh as a box") {
  DatboxTexts texts = small_datbox_in_space();
  texts.driven = texts.driven.substr(0, texts.driven.find("$bdyty", 1));
  // Boxes of 1 x 2 x 4 along x, y and z, whose axes are y, z and x, 1 m to either side of the node along y.
  const std::string planks = read_file(source_folder() / "tests/data/lmgc90/two_planks.DAT");
  texts.bodies = replaced(texts.bodies, " SPHER      1  color  ROUGE  byrd= 0.2000000D+01\n", planks);
  std::vector<BoundarySpec> shapes = dynamics_of(texts).boundaries;
  REQUIRE(shapes.size() == 3);  // the plank of body 2 is the first
  CHECK(shapes[1].body->mass == doctest::Approx(5000 * 16));
  for (const std::size_t k : {0U, 1U, 2U})
    CHECK(shapes[1].body->inertia[k] == doctest::Approx(5000 * 16.0 / 3 * std::array{8.0, 4.25, 4.25}[k]));
  CHECK((shapes[2].part && shapes[2].name == "body 3" && !shapes[2].body && shapes[1].body->axes.w() == 1));
  for (const auto& [shape, y] : {std::pair(1U, 3.0), {2U, 1.0}}) {
    CHECK(shapes[shape].point[1] == doctest::Approx(y));
    CHECK(shapes[shape].axis == std::array<double, 3>{0, 1, 0});
    CHECK(shapes[shape].normal == std::array<double, 3>{1, 0, 0});
  }
  DatboxTexts more = texts;
  more.bodies = replaced(texts.bodies, planks,
                         planks + " SPHEb      3  color  ROUGE  byrd= 0.1000000D+01\n" + std::string(29, ' ') +
                             "coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00\n");
  shapes = dynamics_of(more).boundaries;
  REQUIRE(shapes.size() == 4);
  CHECK((shapes[1].shape == BoundaryShape::grains && shapes[1].first == 1 && shapes[1].last == 1 && shapes[3].part));
  CHECK(shapes[1].body->mass == doctest::Approx(5000 * (16 + 4 * pi / 3)));
  for (const PairSpec& pair : dynamics_of(more).pairs)  // a body does not meet itself
    CHECK(pair.colours != std::array<std::string, 2>{"PLANx ROUGE", "SPHER ROUGE"});
  const std::string first = planks.substr(0, planks.find('\n') + 1);
  more.bodies = replaced(texts.bodies, planks, planks + replaced(first, "PLANx", "CYLND"));
  check_error([&] { dynamics_of(more); }, {"BODIES.DAT:", "a cylinder alone"});
  more = texts;
  more.bodies.replace(more.bodies.rfind("ROUGE"), 5, "BLEUx");
  more.tact = replaced(more.tact, "PLANx  WALLx", "PLANx  BLEUx");  // colours matter: WALLx is not seen
  check_error([&] { dynamics_of(more); }, {"BODIES.DAT:", "one kind and colour", "PLANx ROUGE as before"});
}

TEST_CASE("DATBOX: a plank and disks in the plane are one body, turned about the centre of all if the node is at 0") {
  DatboxTexts texts = small_datbox();
  const std::string disk = " DISKb      1  color  ROUGE",
                    plank = " JONCx      1  color  ROUGE  ax1 = 0.3141593D+01  ax2 = 0.1000000D+01\n";
  texts.bodies = replaced(texts.bodies, disk, plank + disk);
  std::vector<BoundarySpec> shapes = dynamics_of(texts).boundaries;
  REQUIRE(shapes.size() == 3);
  CHECK((shapes[1].shape == BoundaryShape::grains && shapes[1].first == 1 && shapes[1].last == 2 && shapes[2].part));
  CHECK(shapes[2].from[1] == doctest::Approx(20 - pi));
  CHECK(shapes[2].to[0] == doctest::Approx(10));
  texts.bodies = replaced(texts.bodies, "coo1= 0.1000000D+02  coo2= 0.2000000D+02  coo3= 0.1570796D+01",
                          "coo1= 0.0000000D+00  coo2= 0.0000000D+00  coo3= 0.0000000D+00");
  shapes = dynamics_of(texts).boundaries;  // areas over pi 5 at the node, 1 and 4 at (3, 0) and (0, 4)
  CHECK(shapes[1].motion.centre[0] == doctest::Approx(0.3));
  CHECK(shapes[1].motion.centre[1] == doctest::Approx(1.6));
  CHECK(shapes[2].from[0] == doctest::Approx(-pi));
  CHECK(std::abs(shapes[2].from[1]) < 1e-12);
}

TEST_CASE("DATBOX: spheres with a force or other moments of inertia are bodies; moments turn with their axes") {
  DatboxTexts texts = small_datbox_in_space();
  texts.driven += body_of_drives(true, 1, drive_line("force", 3, " 0.4000000D+01"));
  const BoundarySpec pushed = dynamics_of(texts).boundaries.at(0);
  CHECK(pushed.body->load.at(0).z == 4);
  CHECK(pushed.body->mass == doctest::Approx(1000 * 4.0 / 3 * pi * 0.008));
  CHECK(pushed.body->inertia[1] == doctest::Approx(0.8377580));
  CHECK((pushed.body->axes * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm() <
        1e-12);  // the frame of DOF.INI
  texts = small_datbox_in_space();
  texts.driven += body_of_drives(true, 1, drive_line("force", 5, " 0.4000000D+01"));
  const FreeBody turned = *dynamics_of(texts).boundaries.at(0).body;
  CHECK((turned.torque_turns && turned.load.at(0).spin_y == 4 && turned.load.at(0).spin_x == 0));
  texts.driven = replaced(texts.driven, "force      5  0.4", "force      5  0.0");  // none
  CHECK_FALSE(dynamics_of(texts).boundaries.at(0).body->torque_turns);
  texts = small_datbox_in_space();
  texts.bodies = replaced(texts.bodies, "I2  = 0.8377580D-03", "I2  = 0.9377580D-03");
  const Dynamics other = dynamics_of(texts);
  REQUIRE(other.boundaries.size() == 3);
  CHECK(other.boundaries[0].body->inertia[1] == doctest::Approx(0.9377580));
  CHECK(other.boundaries[0].motion.initial->z == 9);
}

TEST_CASE("DATBOX: a velocity and a force of one degree of freedom are refused by line, as is a body without mass") {
  for (const bool all_driven : {false, true}) {
    CAPTURE(all_driven);
    DatboxTexts texts = small_datbox();
    const std::string last = " vlocy      3  0.0000000D+00";
    texts.driven =
        replaced(texts.driven, last, drive_line("force", 2, " 0.1000000D+01") + (all_driven ? last : "!" + last));
    check_error([&] { dynamics_of(texts); }, {"DRV_DOF.DAT:8:", "degree of freedom 2", "met both"});
  }
  DatboxTexts texts = small_datbox();
  texts.driven = replaced(texts.driven, "vlocy      2  0.3000000D+01", "force      2  0.3000000D+01");
  texts.bodies =
      replaced(texts.bodies, "avrd= 0.1000000D+01  gyrd= 0.1000000D+01", "avrd= 0.0000000D+00  gyrd= 0.1000000D+01");
  texts.bodies = replaced(texts.bodies, "JONCx      1  color  WALLx  ax1 ", "xKSID      1  color  WALLx  byrd");
  check_error([&] { dynamics_of(texts); }, {"BODIES.DAT:14:", "avrd", "met 0"});
  texts = small_datbox();
  texts.bodies = replaced(texts.bodies, "$tacty\n DISKx      1  color  BLEUx  byrd= 0.2500000D+00\n", "");
  check_error([&] { dynamics_of(texts); }, {"BODIES.DAT:4:", "a body with a contactor"});
}

TEST_CASE("DATBOX: colours that see each other by another friction, or not at all, are pairs") {
  DatboxTexts texts = small_datbox();
  texts.tact = replaced(texts.tact, "ROUGE  iqsc1", "ROUGE  iqsc0");
  const Dynamics frictions = dynamics_of(texts);
  CHECK(frictions.interaction.friction == 0.3);  // of the first pair, BLEUx and ROUGE
  REQUIRE(frictions.pairs.size() == 1);
  CHECK(frictions.pairs[0].colours == std::array<std::string, 2>{"DISKx BLEUx", "JONCx WALLx"});
  const PairRule& rule = frictions.pairs[0].rule;
  CHECK((rule.touch && rule.friction == 0.5 && !rule.restitution));
  REQUIRE(frictions.colours.size() == 2);  // also of the disks of the cluster
  CHECK(frictions.colours[1].name == "DISKx ROUGE");
  CHECK(std::pair(frictions.colours[1].first, frictions.colours[1].last) == std::pair<Index, Index>(1, 2));
  CHECK(frictions.colours[0].name == "DISKx BLEUx");
  CHECK(std::pair(frictions.colours[0].first, frictions.colours[0].last) == std::pair<Index, Index>(0, 0));
  CHECK(frictions.boundaries[0].colour == "JONCx WALLx");
  CHECK(frictions.boundaries[1].colour == "DISKx ROUGE");
  texts = small_datbox();
  texts.tact = replaced(texts.tact, "JONCx  WALLx", "JONCx  OTHER");
  const Dynamics unseen = dynamics_of(texts);
  REQUIRE(unseen.pairs.size() == 1);
  CHECK(unseen.pairs[0].colours == std::array<std::string, 2>{"DISKx BLEUx", "JONCx WALLx"});
  CHECK_FALSE(unseen.pairs[0].rule.touch);
  CHECK(unseen.interaction.friction == 0.5);
}

TEST_CASE("DATBOX: colours that see each other by another restitution are pairs") {
  DatboxTexts texts =
      with_law(law_head("RST_CLB") + "rstn= 0.5000000D+00  rstt= 0.2500000D+00" + numbers_line("fric= 0.5000000D+00"));
  texts.tact = replaced(texts.tact, "iqsc0  IQS_CLB                         fric= 0.3000000D+00",
                        "iqsc0  " + law_head("RST_CLB") + "rstn= 0.7000000D+00  rstt= 0.2500000D+00" +
                            numbers_line("fric= 0.5000000D+00"));
  texts.tact = replaced(texts.tact, "ROUGE  iqsc1", "ROUGE  iqsc0");
  const Dynamics dynamics = dynamics_of(texts);
  CHECK(dynamics.interaction.restitution == 0.7);
  REQUIRE(dynamics.pairs.size() == 1);
  const PairRule& rule = dynamics.pairs[0].rule;
  CHECK((rule.restitution == 0.5 && !rule.tangential_restitution && !rule.friction));
}

TEST_CASE("DATBOX: COUPLED_DOF is a bond of its pair of colours") {
  DatboxTexts texts = with_law("COUPLED_DOF");
  texts.tact = replaced(texts.tact, "ROUGE  iqsc1", "ROUGE  iqsc0");
  const Dynamics dynamics = dynamics_of(texts);
  const Interaction& interaction = dynamics.interaction;
  CHECK((interaction.law == "cohesive" && interaction.cohesion == 0 && interaction.friction == 0.3));
  REQUIRE(dynamics.pairs.size() == 1);
  CHECK(dynamics.pairs[0].colours == std::array<std::string, 2>{"DISKx BLEUx", "JONCx WALLx"});
  CHECK(dynamics.pairs[0].rule.bond);
}

TEST_CASE("DATBOX: one Signorini condition and one cohesion for all contacts") {
  DatboxTexts texts = small_datbox();
  texts.tact = replaced(texts.tact, "ROUGE  iqsc1", "ROUGE  iqsc0");
  texts.tact = replaced(texts.tact, "iqsc0  IQS_CLB    ", "iqsc0  VEL_SGR_CLB");
  check_error([&] { dynamics_of(texts); }, {"TACT_BEHAV.DAT:", "Signorini"});
  texts = small_datbox();
  texts.tact = replaced(texts.tact, "ROUGE  iqsc1", "ROUGE  iqsc0");
  texts.tact =
      replaced(texts.tact, "iqsc0  IQS_CLB                         fric= 0.3000000D+00",
               "iqsc0  " + law_head("IQS_WET_DS_CLB") + "cohn= 0.2000000D+02  coht= 0.0000000D+00" +
                   numbers_line("Weth= 0.1000000D-02") + numbers_line("dfrc= 0.3000000D+00  sfrc= 0.3000000D+00"));
  check_error([&] { dynamics_of(texts); }, {"TACT_BEHAV.DAT:", "one cohesion", "20 N"});
}

TEST_CASE("DATBOX: laws with a static and a dynamic friction, IQS_WET_DS_CLB as a cohesion within a range") {
  for (const std::string law : {"IQS_DS_CLB", "VEL_SGR_DS_CLB", "GAP_SGR_DS_CLB"}) {
    const Dynamics read = dynamics_of(with_law(law_head(law) + "dfrc= 0.4000000D+00  sfrc= 0.6000000D+00"));
    CHECK((read.interaction.friction == 0.4 && read.interaction.static_friction == 0.6));
    CHECK(read.interaction.on_velocity() == (law == "VEL_SGR_DS_CLB"));
    CHECK((read.time.maximum_push_speed == 1e100) == (law == "GAP_SGR_DS_CLB"));
  }
  const Dynamics shock = dynamics_of(with_law(law_head("RST_DS_CLB") + "rstn= 0.5000000D+00  rstt= 0.2500000D+00" +
                                              numbers_line("dfrc= 0.4000000D+00  sfrc= 0.4000000D+00")));
  CHECK((shock.interaction.restitution == 0.5 && shock.interaction.tangential_restitution == 0.25));
  CHECK((shock.interaction.friction == 0.4 && shock.interaction.static_friction == -1));
  const std::string wet = law_head("IQS_WET_DS_CLB") + "cohn= 0.2000000D+02  coht= 0.0000000D+00" +
                          numbers_line("Weth= 0.1000000D-02") +
                          numbers_line("dfrc= 0.3000000D+00  sfrc= 0.3000000D+00");
  const Interaction interaction = dynamics_of(with_law(wet)).interaction;
  CHECK((interaction.law == "cohesive" && interaction.cohesion == 20));
  CHECK((interaction.cohesion_range == 1e-3 && interaction.friction == 0.3));
  check_error([&] { dynamics_of(with_law(replaced(wet, "coht= 0.0", "coht= 0.1"))); }, {"TACT_BEHAV.DAT:8:", "coht:"});
  CHECK(dynamics_of(with_law(replaced(wet, "sfrc= 0.3", "sfrc= 0.5"))).interaction.static_friction == 0.5);
  check_error([&] { dynamics_of(with_law(replaced(wet, "coht=", "xxxx="))); },
              {"TACT_BEHAV.DAT:8:", "IQS_WET_DS_CLB", "without coht"});
}

TEST_CASE("DATBOX: laws that are no impulses of one contact are refused by name where contacts use them") {
  for (const std::string law : {"MD_JKRs", "ELASTIC_REPELL_CLB", "PERIO_DOF", "IQS_MOHR_DS_CLB"})
    check_error([&] { dynamics_of(with_law(law_head(law) + "fric= 0.5000000D+00")); },
                {"TACT_BEHAV.DAT:8:", "IQS_CLB", "met " + law});
}

TEST_CASE("DATBOX: the friction of each pair of colours is the one that contacts of a step have") {
  const auto frictions = [](const DatboxTexts& texts) {
    const Datbox datbox = parse_datbox(texts, "box");
    const Dynamics dynamics = datbox_dynamics(datbox);
    const GranularSystem system = scene(datbox_packing(datbox, DatboxGrains::all), dynamics).system;
    return [system, dynamics](Index a, Index b) {
      if (const PairRule& rule = system.pairs.of(a, b); rule.friction) return *rule.friction;
      return dynamics.interaction.friction_of(system.is_boundary(a) || system.is_boundary(b), true);
    };
  };
  // A plank that is free has the friction of its law, not that of grains.
  DatboxTexts texts = small_datbox();
  texts.driven.clear();
  texts.bodies =
      replaced(texts.bodies, "avrd= 0.0000000D+00  gyrd= 0.0000000D+00", "avrd= 0.1000000D+01  gyrd= 0.5000000D+00");
  texts.tact = replaced(texts.tact, "ROUGE  iqsc1", "ROUGE  iqsc0");
  CHECK(frictions(texts)(0, 3) == 0.5);
  CHECK(frictions(texts)(0, 1) == 0.3);
  // A colour of free and of driven disks.
  texts = small_datbox();
  texts.bodies = replaced(replaced(texts.bodies, "ROUGE", "BLEUx"), "ROUGE", "BLEUx");
  texts.tact = replaced(texts.tact, "DISKx  ROUGE  iqsc1", "DISKx  BLEUx  iqsc0");
  CHECK(frictions(texts)(0, 3) == 0.5);
  CHECK(frictions(texts)(0, 1) == 0.3);
}
