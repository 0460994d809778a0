// SPDX-License-Identifier: GPL-3.0-or-later
// Input files of LMGC90, by hand: what is read from which columns, and what is refused.
#include "../support/datbox_texts.hpp"
#include "../support/spoilt.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Datbox read(const DatboxTexts& texts) { return parse_datbox(texts, "box"); }

void check_near(const std::vector<double>& found, const std::vector<double>& expected, double epsilon) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == doctest::Approx(expected[i]).epsilon(epsilon));
}

}  // namespace

TEST_CASE("DATBOX: bodies, masses and places") {
  const Datbox datbox = read(small_datbox());
  REQUIRE(datbox.bodies.size() == 3);
  CHECK(datbox.bodies[0].velocity == Eigen::Vector3d(7, -8, 0));
  CHECK(datbox_packing(datbox, DatboxGrains::free).radius == std::vector<double>{0.25});
  const Packing packing = datbox_packing(datbox, DatboxGrains::all);
  REQUIRE(packing.size() == 3);
  CHECK(packing.radius == std::vector<double>{0.25, 1, 2});
  CHECK((packing.x[0] == 1.5 && packing.y[0] == 1.75));
  check_near({packing.x[1], packing.y[1], packing.x[2], packing.y[2]}, {10, 23, 6, 20}, 1e-6);
  CHECK(packing.mass[0] == doctest::Approx(1000 * std::numbers::pi * 0.04));  // by avrd, not by byrd
  CHECK(packing.mass[2] == doctest::Approx(5000 * std::numbers::pi * 4));
}

TEST_CASE("DATBOX: laws, gravity, planks and motions") {
  const Dynamics dynamics = datbox_dynamics(read(small_datbox()));
  CHECK(dynamics.interaction.friction == 0.5);  // a single free disk touches what is driven alone
  CHECK(dynamics.interaction.boundary_friction == -1);
  CHECK(dynamics.time.gravity == std::array<double, 2>{1.25, -9.81});
  CHECK(dynamics.time.penetration_correction == 0);
  CHECK(dynamics.time.alert == doctest::Approx(0.4));  // 0.1 m by the smallest radius
  REQUIRE(dynamics.boundaries.size() == 2);
  CHECK((dynamics.pairs.empty() && dynamics.colours.empty()));
  const BoundarySpec& wall = dynamics.boundaries[0];
  CHECK(wall.name == "body 2");
  CHECK((wall.colour.empty() && !wall.body));
  // All points within 0.5 m of the segment of +-3 m about (0, -0.5), at 30 degrees.
  CHECK((wall.shape == BoundaryShape::plank && wall.radius == 0.5));
  const double c = std::sqrt(3.0) / 2, s = 0.5;
  check_near({wall.from[0], wall.from[1]}, {-3 * c, -0.5 - 3 * s}, 1e-6);
  check_near({wall.to[0], wall.to[1]}, {3 * c, -0.5 + 3 * s}, 1e-6);
  // 3 m/s times min(1, 1/4 + t/2), from t = 0.5 s on: full after 1 s.
  CHECK(wall.motion.time == std::vector<double>{0, 1});
  CHECK(std::pair(wall.motion.velocity[0].y, wall.motion.velocity[1].y) == std::pair(1.5, 3.0));
  CHECK(wall.motion.centre == std::array<double, 3>{0, -0.5, 0});
  const BoundarySpec& pair = dynamics.boundaries[1];
  CHECK(pair.shape == BoundaryShape::grains);
  CHECK(std::pair(pair.first, pair.last) == std::pair<Index, Index>(1, 2));
  CHECK(std::pair(pair.motion.velocity[0].x, pair.motion.velocity[0].spin) == std::pair(2.0, -0.075));  // AMP cos(0)
  CHECK(pair.motion.oscillations.empty());
  CHECK(dynamics.interaction.signorini == Signorini::gap);
  CHECK(dynamics.time.boundary_instant == BoundaryInstant::end);
}

TEST_CASE("DATBOX: AMP cos(OMEGA t + PHI) is an oscillation from the time of DOF.INI on, with its ramp") {
  DatboxTexts texts = small_datbox();
  texts.driven = replaced(texts.driven, "  0.0000000D+00  0.2000000D+01  0.0000000D+00  0.0000000D+00  0.1000000D+01",
                          "  0.0000000D+00  0.2000000D+01  0.3000000D+01  0.4000000D+00  0.1000000D+01");
  texts.driven =
      replaced(texts.driven, " vlocy      2  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.1000000D+01",
               " vlocy      2  0.0000000D+00 -0.5000000D+01  0.3000000D+01  0.4000000D+00  0.1000000D+01");
  const Motion pair = datbox_dynamics(read(texts)).boundaries[1].motion;
  CHECK(pair.oscillations.size() == 1);  // both have one frequency, phase and ramp
  for (const double t : {0.0, 0.25, 3.0}) {
    const double swing = std::cos(3 * (t + 0.5) + 0.4);
    check_near({pair.at(t).x, pair.at(t).y}, {2 * swing, -5 * swing}, 1e-14);
    CHECK(pair.at(t).spin == -0.075);
  }
  texts.driven = replaced(texts.driven, "0.3000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.2500000D+00",
                          "0.3000000D+01  0.1000000D+01  0.2000000D+01  0.0000000D+00  0.2500000D+00");
  const Motion wall = datbox_dynamics(read(texts)).boundaries[0].motion;
  for (const double t : {0.0, 0.25, 3.0})
    CHECK(wall.at(t).y == doctest::Approx((3 + std::cos(2 * (t + 0.5))) * std::min(1.0, 0.25 + 0.5 * (t + 0.5))));
}

TEST_CASE("DATBOX: laws on the velocity and on the gap, bulk laws with more data, numbers that LMGC90 cuts off") {
  DatboxTexts texts = small_datbox();
  const auto with_law = [&](const std::string& law) {
    DatboxTexts with = texts;
    with.tact = replaced(with.tact, "iqsc1  IQS_CLB                         fric= 0.5000000D+00", law);
    return datbox_dynamics(read(with));
  };
  const std::string fric = " fric= 0.5000000D+00";
  const Dynamics rst = with_law("iqsc1  RST_CLB                         rstn= 0.0000000D+00  rstt= 0.2500000D+00\n" +
                                std::string(39, ' ') + fric.substr(1));
  CHECK((rst.interaction.on_velocity() && rst.interaction.friction == 0.5));
  CHECK((rst.interaction.restitution == 0 && rst.interaction.tangential_restitution == 0.25));
  CHECK(with_law("iqsc1  VEL_SGR_CLB                    " + fric).interaction.on_velocity());
  const Dynamics gap = with_law("iqsc1  GAP_SGR_CLB                    " + fric);
  CHECK_FALSE(gap.interaction.on_velocity());
  CHECK((gap.time.penetration_correction == 1 && gap.time.maximum_push_speed == 1e100));
  texts.bulk = replaced(texts.bulk, "STONE  RIGID        ", "STONE  THERMO_RIGID ");
  CHECK(datbox_packing(read(texts), DatboxGrains::all).mass[0] == doctest::Approx(1000 * std::numbers::pi * 0.04));
  // One column to the right: LMGC90 would read 0.0000000D+0, the same number, and 0.7000000D+0 in place of 7.
  texts.initial = replaced(texts.initial, "V(3)= 0.0000000D+00", "V(3)=  0.0000000D+00");
  CHECK(read(texts).bodies[0].velocity[2] == 0);
  texts.initial = replaced(texts.initial, "V(1)= 0.7000000D+01  ", "V(1)=  0.7000000D+01 ");
  check_error([&] { read(texts); },
              {"DOF.INI:9: V(1): expected a number in columns 35 to 48", "met '0.7000000D+0' of '0.7000000D+01'"});
}

TEST_CASE("DATBOX: a driven cluster of spheres is a boundary; velocities of DOF.INI with spins are prescribed") {
  DatboxTexts texts = small_datbox_in_space();
  texts.bodies = replaced(texts.bodies, " SPHER      1  color  ROUGE  byrd= 0.2000000D+01\n",
                          " SPHEb      1  color  ROUGE  byrd= 0.2000000D+01\n" + std::string(29, ' ') +
                              "coo1= 0.1000000D+02  coo2= 0.2000000D+02  coo3= 0.3000000D+02\n"
                              " SPHEb      2  color  ROUGE  byrd= 0.1000000D+01\n" +
                              std::string(29, ' ') + "coo1=-0.1000000D+02  coo2= 0.0000000D+00  coo3= 0.0000000D+00\n");
  const Datbox datbox = read(texts);
  const Packing packing = datbox_packing(datbox, DatboxGrains::all);
  REQUIRE(packing.size() == 3);
  check_near({packing.x[1], packing.y[1], packing.z[1]}, {11, 22, 26}, 1e-14);
  check_near({packing.x[2], packing.y[2], packing.z[2]}, {-9, 2, -4}, 1e-14);
  const double weight = 8.0 / 9;  // of the larger sphere, by volume
  CHECK(datbox.bodies[2].position[0] == doctest::Approx(1 + weight * 10 - (1 - weight) * 10));
  CHECK(datbox.bodies[2].position[2] == doctest::Approx(-4 + weight * 30));
  const BoundarySpec boundary = datbox_dynamics(datbox).boundaries[1];
  CHECK(std::pair(boundary.first, boundary.last) == std::pair<Index, Index>(1, 2));
  texts.driven =
      texts.driven.substr(0, texts.driven.rfind(" vlocy      6")) +
      replaced(texts.driven.substr(texts.driven.rfind(" vlocy      6")), "6  0.0000000D+00", "6  0.1000000D+01");
  check_error([&] { datbox_dynamics(read(texts)); },
              {"BODIES.DAT:", "I1 to I3 of a body with several contactors that turns"});
  // The node of a single one moves, too: its axes, which DOF.INI turns, have no effect on its place.
  texts = small_datbox_in_space();
  texts.bodies = replaced(texts.bodies, " SPHER      1  color  BLEUx  byrd= 0.2500000D+00\n",
                          " SPHEb      1  color  BLEUx  byrd= 0.2500000D+00\n" + std::string(29, ' ') +
                              "coo1= 0.1000000D+01  coo2= 0.0000000D+00  coo3= 0.0000000D+00\n");
  CHECK(datbox_packing(read(texts), DatboxGrains::all).centre(0) == std::array<double, 3>{2.5, 1.75, 3.125});
}

TEST_CASE("DATBOX: spheres, their masses, a plank with edges, and spins along the axes of a body") {
  const Datbox datbox = read(small_datbox_in_space());
  CHECK(datbox.dimension == 3);
  const Packing packing = datbox_packing(datbox, DatboxGrains::all);
  REQUIRE(packing.size() == 2);
  CHECK(packing.x == std::vector<double>{1.5, 1});
  CHECK(packing.y == std::vector<double>{1.75, 2});
  CHECK(packing.z == std::vector<double>{3.125, -4});
  CHECK(packing.radius == std::vector<double>{0.25, 2});
  CHECK(packing.mass[0] == doctest::Approx(1000 * 4.0 / 3 * std::numbers::pi * 0.008));  // by avrd, not by byrd
  CHECK(packing.mass[1] == doctest::Approx(5000 * 4.0 / 3 * std::numbers::pi * 8));
  CHECK(datbox_packing(datbox, DatboxGrains::free).size() == 1);
  CHECK(datbox.bodies[0].velocity == Eigen::Vector3d(7, -8, 9));
  CHECK(datbox.bodies[0].frame.col(0) == Eigen::Vector3d(0, 1, 0));
  const Dynamics dynamics = datbox_dynamics(datbox);
  CHECK(dynamics.time.gravity == std::array<double, 3>{1.25, -9.81, 0.5});
  REQUIRE(dynamics.boundaries.size() == 2);
  const BoundarySpec& wall = dynamics.boundaries[0];
  CHECK((wall.dimension == 3 && wall.shape == BoundaryShape::plank));
  CHECK(wall.normal == std::array<double, 3>{-1, 0, 0});
  CHECK(wall.point == std::array<double, 3>{5, 1.25, 0});  // the middle of the plank, with the shift of its frame
  CHECK(wall.axis == std::array<double, 3>{0, 0, 1});
  CHECK(std::array{wall.length, wall.width, wall.radius} == std::array{12.0, 14.0, 0.5});
  CHECK_FALSE(wall.body.has_value());
  CHECK(wall.motion.centre == std::array<double, 3>{5, 1.25, 0});
  const RigidVelocity v = wall.motion.at(0);
  // V(4) is along the first axis, which is z.
  CHECK(std::array{v.x, v.y, v.z, v.spin, v.spin_x, v.spin_y} == std::array{1.0, 2.0, 3.0, 4.0, -5.0, 0.0});
  const BoundarySpec& driven = dynamics.boundaries[1];
  CHECK(driven.shape == BoundaryShape::grains);
  CHECK(std::pair(driven.first, driven.last) == std::pair<Index, Index>(1, 1));
  CHECK(driven.motion.at(1).z == 7);
  CHECK(driven.dimension == 3);  // else its text would be one of the plane
  CHECK(driven.motion.centre == std::array<double, 3>{1, 2, -4});
  // Without inertia and averaged radius both are those of the contactor, and a plank may lie the other way round.
  DatboxTexts texts = small_datbox_in_space();
  texts.bodies = replaced(texts.bodies, "avrd= 0.2000000D+00\n", "avrd= 0.0000000D+00\n");
  texts.bodies = replaced(
      texts.bodies, "                             I1  = 0.8377580D-03  I2  = 0.8377580D-03  I3  = 0.8377580D-03\n", "");
  CHECK(datbox_packing(read(texts), DatboxGrains::free).mass[0] ==
        doctest::Approx(1000 * 4.0 / 3 * std::numbers::pi / 64));
  texts.bodies = replaced(texts.bodies, "alp3= 0.1000000D+01", "alp3=-0.1000000D+01");
  texts.bodies = replaced(texts.bodies, "gam1=-0.1000000D+01", "gam1= 0.1000000D+01");
  CHECK(datbox_dynamics(read(texts)).boundaries[0].normal == std::array<double, 3>{1, 0, 0});
  CHECK(datbox_dynamics(read(texts)).boundaries[0].axis == std::array<double, 3>{0, 0, -1});
}

TEST_CASE("DATBOX: a velocity by a table is linear between its rows, and on beyond them as LMGC90 has it") {
  DatboxTexts texts = small_datbox();
  const std::string formula =
      " vlocy      2  0.3000000D+01  0.0000000D+00  0.0000000D+00  0.0000000D+00  0.2500000D+00"
      "  0.5000000D+00";
  texts.driven = replaced(texts.driven, formula, " vlocy      2 evolution lift.dat");
  const auto with_table = [&](const std::string& table) {
    DatboxTexts with = texts;
    with.table = [table](const std::string& name) {
      CHECK(name == "lift.dat");
      return table;
    };
    return datbox_dynamics(read(with)).boundaries[0].motion;
  };
  // DOF.INI begins at 0.5 s, which is 0 here.
  const Motion motion = with_table("! rise, rest\n0 0\r\n 1.5d0\t3\n\n2.0 3.0D+000 remark\n");
  CHECK(motion.at(0).y == doctest::Approx(1));
  CHECK(motion.at(0.5).y == doctest::Approx(2));
  CHECK((motion.at(1).y == 3 && motion.at(100).y == 3 && motion.at(0).x == 0));
  const Motion on = with_table("1 2\n2 4\n");
  CHECK(on.at(0).y == doctest::Approx(1));
  CHECK(on.at(9.5).y == doctest::Approx(20));
  for (const auto& one : {std::pair("", "expected at least two rows, met 0"),
                          {"1 2\n", "expected at least two rows, met 1"},
                          {"1 2\n1 3\n", "lift.dat:2: expected times that ascend, met 1"},
                          {"1 2\n2\n", "lift.dat:2: expected a time and a velocity, met ''"},
                          {"1 2\n2 up\n", "lift.dat:2: expected a time and a velocity, met 'up'"}})
    CHECK_THROWS_WITH_AS(with_table(one.first), doctest::Contains(one.second), Error);
  for (const std::string name : {"../secret", "/etc/passwd", "..", ""}) {
    DatboxTexts other = small_datbox();
    other.driven = replaced(other.driven, formula, " vlocy      2 evolution " + name);
    other.table = [](const std::string&) { return std::string("0 0\n1 1\n"); };
    CHECK_THROWS_WITH_AS(read(other), doctest::Contains("expected the name of a file beside DRV_DOF.DAT"), Error);
  }
}

TEST_CASE("DATBOX: an exponent of three digits stands without its letter, as Fortran writes it") {
  DatboxTexts texts = small_datbox();
  texts.initial = replaced(texts.initial, "V(1)= 0.7000000D+01", "V(1)= 0.7000000-120");
  CHECK(read(texts).bodies[0].velocity[0] == doctest::Approx(7e-121).epsilon(1e-7));
  texts.initial = replaced(texts.initial, "V(1)= 0.7000000-120", "V(1)= 0.7000000-999");
  CHECK(read(texts).bodies[0].velocity[0] == 0);
  texts.initial = replaced(texts.initial, "V(1)= 0.7000000-999", "V(1)= 0.7000000+200");
  CHECK_THROWS_WITH_AS(read(texts), doctest::Contains("V(1): expected a number"), Error);
}

TEST_CASE("DATBOX: contacts are found in spite of seven digits") {
  // Rows of disks of radius 1/3 that touch, far from the origin.
  constexpr int columns = 12, rows = 5;
  DatboxTexts texts = small_datbox();
  texts.bodies.clear();
  texts.driven.clear();
  texts.initial.clear();
  const double radius = 1.0 / 3;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double x = 70 + 2 * radius * column + radius * (row % 2), y = radius * std::sqrt(3.0) * row;
      const auto digits = [](const char* name, double value) {
        char text[32];
        std::snprintf(text, sizeof text, "  %s%14.6E", name, value);
        return std::string(text);
      };
      texts.bodies += "$bdyty\n RBDY2      1\n$blmty\n PLAIN      1  behav  STONE" + digits("avrd=", radius) +
                      digits("gyrd=", radius / std::numbers::sqrt2) + "\n$nodty\n NO3xx      1" + std::string(14, ' ') +
                      digits("coo1=", x) + digits("coo2=", y) + digits("coo3=", 0) +
                      "\n$tacty\n DISKx      1  color  BLEUx" + digits("byrd=", radius) + "\n$$$$$$\n";
    }
  const Datbox datbox = read(texts);
  const Packing packing = datbox_packing(datbox, DatboxGrains::free);
  CHECK(packing.half_digit == doctest::Approx(0.5e-5));  // of 70.33333
  const ContactNetwork network = detect_contacts(packing);
  CHECK(network.size() == rows * (columns - 1) + (rows - 1) * (2 * columns - 1));
  CHECK(network.rounding.decided.size > 0);
  // Numbers of full length, such as sums of places and displacements, are worth no more.
  Packing turned = packing;
  for (std::size_t i = 0; i < turned.x.size(); ++i) {
    turned.x[i] = std::cos(0.3) * packing.x[i] - std::sin(0.3) * packing.y[i];
    turned.y[i] = std::sin(0.3) * packing.x[i] + std::cos(0.3) * packing.y[i];
  }
  CHECK(detect_contacts(turned).size() == network.size());
  turned.half_digit = 0;
  CHECK_THROWS_AS(detect_contacts(turned), Error);
}

TEST_CASE("DATBOX: what is not modelled or cannot be read is refused by file and line, in the plane and in space") {
  DatboxTexts texts = small_datbox();
  const auto refused = [&](std::string DatboxTexts::*file, const std::string& from, const std::string& to,
                           const Names& names) {
    DatboxTexts spoilt_one = texts;
    spoilt_one.*file = replaced(texts.*file, from, to);
    check_error([&] { datbox_dynamics(read(spoilt_one)); }, names);
  };
  const auto bodies = &DatboxTexts::bodies, tact = &DatboxTexts::tact, driven = &DatboxTexts::driven,
             bulk = &DatboxTexts::bulk, initial = &DatboxTexts::initial;
  refused(bodies, "DISKx      1", "POLYG      1", {"box/BODIES.DAT:10:", "contactors"});
  refused(bodies, "RBDY2      1", "MAILx      1", {"box/BODIES.DAT:4:", "bodies"});
  refused(bodies, "byrd= 0.2500000D+00", "byrd= 0.2500000D+001", {"BODIES.DAT:10: byrd:", "number"});
  refused(bodies, "byrd= 0.2500000D+00", "byrd=-0.2500000D+00", {"BODIES.DAT:10: byrd:", "above 0"});
  refused(bodies, "coo1= 0.1000000D+01", "coo1= 0.10O0000D+01", {"BODIES.DAT:8: coo1:", "number"});
  refused(bodies, "behav  STONE", "behav  CLAYx", {"BODIES.DAT:4: bulk law 'CLAYx'"});
  refused(tact, "BLEUx  iqsc1", "BLEUx  other", {"TACT_BEHAV.DAT:5:", "IQS_CLB", "met MAC_CZM"});
  refused(tact, "ROUGE  iqsc1", "ROUGE  lostx", {"TACT_BEHAV.DAT:15:", "described"});
  refused(driven, "vlocy      2", "vlocy      4", {"DRV_DOF.DAT:7:", "1, 2 or 3"});
  refused(driven, " vlocy      2  0.3000000D+01", " vlocy      2 evolution n.dat",
          {"DRV_DOF.DAT:7: evolution:", "met 'n.dat"});
  refused(driven, "0.2500000D+00  0.5000000D+00", "0.2500000D+00 -0.5000000D+00", {"DRV_DOF.DAT:7: RAMP"});
  refused(driven, "RBDY2        3", "RBDY2        7", {"DRV_DOF.DAT:11:", "3 bodies"});
  refused(bulk, "Umas= 0.1000000D+04", "Umas= 0.0000000D+04", {"BULK_BEHAV.DAT:5: Umas"});
  refused(initial, "V(2)=-0.8000000D+01", "V(2)=-0.8      D+01", {"DOF.INI:9: V(2)"});
  refused(driven, "RBDY2        3", "RBDY2        2", {"DRV_DOF.DAT:11:", "met body 2 again"});
  refused(initial, "$nodty", "!nodty", {"DOF.INI:10:", "$nodty", "met none"});
  refused(bulk, "$gravy", "!gravy", {"box/BULK_BEHAV.DAT:", "$gravy", "met none"});
  refused(tact, " other  MAC_CZM", " iqsc0  MAC_CZM", {"TACT_BEHAV.DAT:5:", "met 'iqsc0' again"});
  refused(tact, "fric= 0.3000000D+00", "fric=-0.3000000D+00", {"TACT_BEHAV.DAT:2: fric: expected a number from 0"});
  refused(tact, "IQS_CLB                         fric= 0.3000000D+00",
          "RST_CLB                         rstn= 0.3000000D+01  rstt= 0.0000000D+00", {"TACT_BEHAV.DAT:2: rstn:", "1"});
  refused(tact, "0.5000000D-01", "-.5000000D-01", {"TACT_BEHAV.DAT:12: alert: expected a number from 0"});
  refused(driven, "vlocy      3  0.0000000D+00", "vlocy      2  0.0000000D+00", {"DRV_DOF.DAT:8:", "vlocy 2 again"});
  refused(bulk, " HARDx  RIGID", " STONE  RIGID", {"BULK_BEHAV.DAT:8:", "'STONE' again"});
  refused(bulk, "$behav  lawty\n HARDx", "$gravy\n HARDx", {"BULK_BEHAV.DAT:7:", "gravity once"});
  refused(bulk, "Umas= 0.1000000D+04", "Umas=          1000", {"BULK_BEHAV.DAT:5: Umas: expected", "decimal point"});
  texts.driven = replaced(texts.driven, " vlocy      3  0.0000000D+00", " force      3  0.1000000D+01");
  CHECK(datbox_packing(read(texts), DatboxGrains::all).size() ==
        3);  // what drives planks is of no account for the packing
  texts = small_datbox();
  texts.bodies = texts.bodies.substr(0, texts.bodies.rfind("$$$$$$"));
  check_error([&] { datbox_dynamics(read(texts)); }, {"BODIES.DAT:24:", "$$$$$$"});

  texts = small_datbox_in_space();
  refused(bodies, "SPHER      1  color  BLEUx", "POINT      1  color  BLEUx", {"BODIES.DAT:10:", "SPHER"});
  refused(bodies, "RBDY3      2", "RBDY2      2", {"BODIES.DAT:14:", "RBDY3"});
  refused(bodies, "NO6xx      1", "NO3xx      1", {"BODIES.DAT:7:", "NO6xx"});
  refused(bodies, "gam1=-0.1000000D+01", "gam1=-0.9000000D+00", {"BODIES.DAT:22:", "axes"});
  refused(bodies, "gam1=-0.1000000D+01", "gam1= 0.1000000D+01", {"BODIES.DAT:22:", "axes"});
  refused(driven, "vlocy      6", "vlocy      7", {"DRV_DOF.DAT:11:", "1, 2 ... 6"});
  refused(initial, "a(2)= 0.1000000D+01", "a(2)= 0.2000000D+01", {"DOF.INI:12:", "axes"});
  refused(initial, "RBDY3        1", "RBDY2        1", {"DOF.INI:4:", "RBDY3"});
  // Planks of the plane are none of space.
  refused(bodies, "PLANx      1", "JONCx      1", {"BODIES.DAT:21:", "SPHER"});
  texts.table = [](const std::string&) { return std::string("0 4\n1 0\n"); };
  refused(driven, " vlocy      4  0.4000000D+01", " vlocy      4 evolution turn.dat      ", {"BODIES.DAT:14:", "axis"});
}
