// SPDX-License-Identifier: GPL-3.0-or-later
// Circles and cylinders in case files and in folders of LMGC90: xKSID, DNLYC and CYLND, by hand.
#include "../support/datbox_texts.hpp"
#include "../support/moving_case.hpp"
#include "../support/spoilt.hpp"
#include "formats/case/case_file.hpp"
#include "formats/lmgc90/vloc_rloc.hpp"

#include <doctest/doctest.h>

#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

using std::numbers::pi;

CaseSpec cylinder_case(const std::string& text) { return parse_case(text, "case.toml"); }

std::string boundary_text(const std::string& more) {
  return "[[boundary]]\nname = \"drum\"\nshape = \"cylinder\"\n" + more;
}

Dynamics cylinder_dynamics(const DatboxTexts& texts) { return datbox_dynamics(parse_datbox(texts, "box")); }

DatboxTexts hollow_disk() {
  DatboxTexts texts = small_datbox();
  texts.bodies = replaced(texts.bodies, "JONCx      1  color  WALLx  ax1 = 3.0000000E+00  ax2 = 5.0000000E-01",
                          "xKSID      1  color  WALLx  byrd= 0.3000000D+01");
  texts.tact = replaced(texts.tact, "JONCx  WALLx", "xKSID  WALLx");
  return texts;
}

// With half a length of 6 and a radius of 7 m about -x, the third axis of the body.
DatboxTexts full_cylinder() {
  DatboxTexts texts = small_datbox_in_space();
  texts.bodies = replaced(texts.bodies,
                          "PLANx      1  color  WALLx  axe1= 0.6000000D+01  axe2= 0.7000000D+01  axe3= 0.5000000D+00",
                          "CYLND      1  color  WALLx  High= 0.6000000D+01  byrd= 0.7000000D+01");
  texts.tact = replaced(texts.tact, "PLANx  WALLx", "CYLND  WALLx");
  return texts;
}

}  // namespace

TEST_CASE("cylinders of a case: a circle in the plane is written and read back, and turns about its middle") {
  const std::string plane = case_text("hexagonal", "1, 1", "[masses]\ndensity = 1\n[dynamics]\nsteps = 1\n");
  const CaseSpec one =
      cylinder_case(plane + boundary_text("from = [3, 4]\nradius = 9\nside = \"outside\"\nspin = 2\n"));
  const BoundarySpec spec = cylinder_case(to_toml(one)).dynamics->boundaries.at(0);
  CHECK(to_toml(spec) == to_toml(one.dynamics->boundaries[0]));
  CHECK(spec.from == std::array<double, 3>{3, 4, 0});
  CHECK(spec.motion.centre == spec.from);
  CHECK(to_toml(spec).find("centre = [3, 4]\n") != std::string::npos);  // so that a restart sees another default
  const GranularSystem system =
      simulation_of(resolve(cylinder_case(plane + boundary_text("from = [3, 4]\nradius = 9\ncentre = [0, 0]\n"))))
          .system;
  const Wall& wall = system.walls.at(0);
  CHECK(wall.radius == 9);
  CHECK(wall.normal == std::array<double, 3>{0, 0, 1});
  CHECK(system.boundaries[0].motion.centre == std::array<double, 3>{0, 0, 0});
  const Wall turned = moved(wall, system.boundaries[0].motion, {.angle = pi / 2});
  CHECK(std::hypot(turned.point[0] + 4, turned.point[1] - 3) < 1e-12);
  CHECK(turned.normal == wall.normal);
  const Spoilt spoilt{plane + boundary_text("from = [3, 4]\nradius = 9\n"),
                      [](const std::string& text) { simulation_of(resolve(cylinder_case(text))); }};
  spoilt("radius = 9", "radius = 9\nto = [5, 6]", {"unknown key", "boundary[0].to"});
  spoilt("radius = 9", "radius = 9\nside = \"outside\"\nends = true", {"boundary 'drum'", "ends"});
  spoilt("radius = 9\n", "", {"boundary[0].radius"});
  spoilt("from = [3, 4]", "from = [3, 4, 5]\nto = [0, 0, 0]", {"boundary 'drum':", "two components", "met three"});
}

TEST_CASE("cylinders of a case: in space the motion is about `from`, and a full one may have ends") {
  const std::string space = case_text("fcc", "1, 1, 1", "[masses]\ndensity = 1\n[dynamics]\nsteps = 1\n");
  const std::string rod = "from = [0, 0, 40]\nto = [0, 6, 40]\nradius = 2\nside = \"outside\"\nends = true\n";
  const CaseSpec one = cylinder_case(space + boundary_text(rod));
  const BoundarySpec spec = cylinder_case(to_toml(one)).dynamics->boundaries.at(0);
  CHECK(spec.ends);
  CHECK(spec.motion.centre == std::array<double, 3>{0, 0, 40});
  const Wall wall = simulation_of(resolve(one)).system.walls.at(0);
  CHECK(wall.point == std::array<double, 3>{0, 3, 40});
  CHECK(wall.half_length == 3);
  CHECK(wall.has_ends());
  CHECK_FALSE(wall.plank());
  const Spoilt spoilt{space + boundary_text(rod), cylinder_case};
  spoilt("\"outside\"", "\"inside\"", {"ends: expected side outside"});
  spoilt("to = [0, 6, 40]\n", "", {"boundary[0].to"});
}

TEST_CASE("DATBOX: a hollow disk xKSID is a circle with grains inside; a free one needs its own mass") {
  const Dynamics dynamics = cylinder_dynamics(hollow_disk());
  const BoundarySpec& drum = dynamics.boundaries.at(0);
  CHECK(drum.shape == BoundaryShape::cylinder);
  CHECK(drum.side == CylinderSide::inside);
  CHECK(drum.from == std::array<double, 3>{0, -0.5, 0});  // without the angle of the body
  CHECK((drum.motion.centre == drum.from && drum.radius == 3));
  CHECK(drum.motion.at(5).y == 3);
  CHECK(dynamics.pairs.empty());
  CHECK(datbox_packing(parse_datbox(hollow_disk(), "box"), DatboxGrains::all).size() == 3);
  DatboxTexts texts = hollow_disk();
  texts.tact = replaced(texts.tact, "xKSID  WALLx", "JONCx  WALLx");
  CHECK_FALSE(cylinder_dynamics(texts).pairs.at(0).rule.touch);
  texts = hollow_disk();
  texts.driven = texts.driven.substr(texts.driven.find("$bdyty", 1));
  CHECK(cylinder_dynamics(texts).boundaries.at(0).body->mass == doctest::Approx(5000 * pi));  // avrd = 1
  texts.bodies =
      replaced(texts.bodies, "avrd= 0.1000000D+01  gyrd= 0.1000000D+01", "avrd= 0.0000000D+00  gyrd= 0.0000000D+00");
  check_error([&] { cylinder_dynamics(texts); }, {"BODIES.DAT:14:", "avrd and gyrd"});
  texts = hollow_disk();
  texts.bodies = replaced(texts.bodies, "byrd= 0.3000000D+01\n",
                          "byrd= 0.3000000D+01\n DISKx      2  color  WALLx  byrd= 0.3000000D+01\n");
  CHECK(cylinder_dynamics(texts).boundaries.at(0).shape == BoundaryShape::grains);
  CHECK(cylinder_dynamics(texts).boundaries.at(1).radius == 3);  // the hollow one, a part of the same boundary
}

TEST_CASE("DATBOX: cylinders lie along the third axis of their body; the full one ends, and weighs what it holds") {
  const BoundarySpec full = cylinder_dynamics(full_cylinder()).boundaries.at(0);
  CHECK(full.shape == BoundaryShape::cylinder);
  CHECK(full.side == CylinderSide::outside);
  CHECK(full.ends);
  CHECK(full.radius == 7);
  CHECK(full.from == std::array<double, 3>{11, 1.25, 0});
  CHECK(full.to == std::array<double, 3>{-1, 1.25, 0});
  CHECK(full.motion.centre == std::array<double, 3>{5, 1.25, 0});
  CHECK(full.motion.at(0).spin == 4);
  DatboxTexts texts = full_cylinder();
  texts.driven = texts.driven.substr(texts.driven.find("$bdyty", 1));
  const FreeBody body = cylinder_dynamics(texts).boundaries.at(0).body.value();
  const double mass = 5000 * pi * 49 * 12;
  CHECK(body.mass == doctest::Approx(mass));
  CHECK(body.inertia[0] == doctest::Approx(mass * (49 / 4.0 + 144 / 12.0)));
  CHECK(body.inertia[1] == doctest::Approx(body.inertia[0]));
  CHECK(body.inertia[2] == doctest::Approx(mass * 49 / 2));
  CHECK((body.axes * Eigen::Vector3d::UnitZ() + Eigen::Vector3d::UnitX()).norm() < 1e-12);
  texts.bodies = replaced(texts.bodies, "HARDx  avrd= 0.0000000D+00\n$nodty\n NO6xx      1                coo1= 0.5",
                          "HARDx  avrd= 0.0000000D+00\n" + std::string(29, ' ') +
                              "I1  = 0.1000000D+01  I2  = 0.2000000D+01  I3  = 0.3000000D+01\n$nodty\n NO6xx      1" +
                              std::string(16, ' ') + "coo1= 0.5");
  CHECK(cylinder_dynamics(texts).boundaries.at(0).body->inertia == body.inertia);  // as LMGC90, not of the file
  // A hollow one has no frame of its own, and no ends here.
  texts = full_cylinder();
  texts.bodies = replaced(texts.bodies, "CYLND", "DNLYC");
  texts.tact = replaced(texts.tact, "CYLND", "DNLYC");
  check_error([&] { cylinder_dynamics(texts); }, {"BODIES.DAT:14:", "a cylinder alone"});
  const std::size_t frame = texts.bodies.find("                             localframe");
  texts.bodies.erase(frame, texts.bodies.find("$$$$$$", frame) - frame);
  const BoundarySpec hollow = cylinder_dynamics(texts).boundaries.at(0);
  CHECK(hollow.side == CylinderSide::inside);
  CHECK_FALSE(hollow.ends);
  CHECK(hollow.from == std::array<double, 3>{5, 1, -6});
  CHECK(hollow.to == std::array<double, 3>{5, 1, 6});
}

TEST_CASE("Vloc_Rloc: the lever of a hollow disk is its radius against n, as LMGC90 has it") {
  DatboxTexts texts = hollow_disk();
  texts.driven = texts.driven.substr(texts.driven.find("$bdyty", 1));
  const Datbox datbox = parse_datbox(texts, "box");
  DatboxContact contact{.kind = "DKKDx", .candidate = 0, .antagonist = 1, .law = "iqsc1", .frame = {}, .place = {}};
  contact.point = {1.5, 1.5, 0};  // on the disk
  contact.frame << 0, 1, 0, 1, 0, 0, 0, 0, 1;
  contact.gap = 0.25;
  const FclibFile file = contact_problem_of(datbox, {.step = 1, .time = 0.5, .contacts = {contact}}, "Vloc_Rloc.INI");
  const Matrix h = std::get<GlobalFrictionProblem>(file.problem).h.toDense();
  REQUIRE(h.rows() == 6);
  CHECK(h(1, 0) == 1);
  CHECK(h(2, 1) == doctest::Approx(0.25));  // -r n x t of the disk
  CHECK(h(4, 0) == -1);
  CHECK(h(3, 1) == -1);
  CHECK(h(5, 0) == doctest::Approx(0));
  CHECK(h(5, 1) == doctest::Approx(-3));  // -(-R n x t)
}
