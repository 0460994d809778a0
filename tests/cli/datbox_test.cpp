// SPDX-License-Identifier: GPL-3.0-or-later
// A DATBOX of LMGC90: read as a packing and as a case that moves, equal to the case that it was written from.
#include "formats/lmgc90/datbox.hpp"

#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"
#include <nscdd/formats/packing_file.hpp>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// By a writer of its own, which knows the formats of LMGC90 but nothing of this program but its trajectories.
void write_datbox(const Session& session, const std::string& run, const std::string& folder) {
  REQUIRE(run_script("cli/write_datbox.py", {session.path(run), session.path(folder)}) == 0);
}

// A box with a floor and a side of disks that turns, and a side wall that is pushed in.
std::string box_case() {
  std::string text = moving_case();
  text.erase(text.find("[solver]"), text.find("[[boundary]]") - text.find("[solver]"));
  text = replaced(text, "grains = 120", "grains = 60");
  text = replaced(text, "friction = 0.3", "friction = 0.3\nboundary_friction = 0.5");
  text = replaced(text, "steps = 20", "steps = 15\npenetration_correction = 0");
  return replaced(text, "motion = [[0, 0, 0, 0], [0.02, 0, 0, -0.075]]",
                  "motion = [[0, 0, 0, 0], [0.02, -0.05, 0, 0]]");
}

// Runs the box, and writes its DATBOX.
void write_box(const Session& session, const std::string& options = "") {
  session.file("box.toml", box_case());
  session.answer("simulate box.toml -o run.h5" + options);
  write_datbox(session, "run.h5", "box/DATBOX");
}

// Spheres in a box: a side that turns about its foot, one that is pushed in, and a sphere that is driven.
const std::string spheres =
    case_text("sphere_deposit\ngrains = 60\nwidth = 1.0\ndepth = 1.0", "2, 1, 1",
              "[masses]\ndensity = 2500\n[interaction]\nfriction = 0.3\nboundary_friction = 0.5\n"
              "[dynamics]\nstep = 0.005\nsteps = 15\npenetration_correction = 0\n") +
    wall_text("floor", "[0.3, 0.2, 0]", "[0, 0, 1]") +
    wall_text("left", "[0, 0, 0]", "[1, 0, 0]", "centre = [0, 0, 0]\nspin = [0, 0.1, 0]\n") +
    wall_text("right", "[1, 0, 0]", "[-1, 0, 0]", "motion = [[0, 0, 0, 0, 0, 0, 0], [0.02, -0.05, 0, 0, 0, 0, 0]]\n") +
    wall_text("front", "[0, 0, 0]", "[0, 1, 0]") + wall_text("back", "[0, 1, 0]", "[0, -1, 0]") +
    "[[boundary]]\nname = \"probe\"\nshape = \"grains\"\nfirst = -1\nlast = -1\nvelocity = [0.02, 0, 0]\n";

// A clump, a slab that falls on a sphere, and a lid that is pushed on another one by an oscillating force.
const std::string bodies_in_space =
    case_text("grains.csv", "1, 1, 1",
              "[masses]\ndensity = 2500\n[interaction]\nfriction = 0.3\nboundary_friction = 0.5\n"
              "[dynamics]\nstep = 0.002\nsteps = 100\npenetration_correction = 0\n") +
    "[[boundary]]\nname = \"clump\"\nshape = \"grains\"\nfirst = 2\nlast = 4\ncentre = [0.35, 0.1, 0.3]\n"
    "free = [\"x\", \"y\", \"z\", \"spin_x\", \"spin_y\", \"spin\"]\nmass = 30\ninertia = [0.3, 0.2, 0.4]\n"
    "axes = [0.8, 0, 0.6, 0]\ninitial_velocity = [0.1, -0.2, -1]\ninitial_spin = [1, -2, 0.5]\nforce = [5, 0, 0]\n"
    "[[boundary]]\nname = \"slab\"\nshape = \"plank\"\npoint = [0, 0, 0.3]\nnormal = [0, 0, 1]\naxis = [0, 1, 0]\n"
    "length = 0.4\nwidth = 0.2\nradius = 0.05\ncentre = [0, 0, 0.3]\n"
    "free = [\"x\", \"y\", \"z\", \"spin_x\", \"spin_y\", \"spin\"]\nmass = 15\n"
    "inertia = [0.28333333333, 0.08333333333, 0.33333333333]\ninitial_spin = [0, 1, 0]\n"
    "[[boundary]]\nname = \"lid\"\nshape = \"plank\"\npoint = [1, 0, 0.3]\nnormal = [0, 0, 1]\naxis = [1, 0, 0]\n"
    "length = 0.2\nwidth = 0.2\nradius = 0.05\ncentre = [1, 0, 0.3]\nfree = [\"z\"]\nmass = 2\nload = [[0, 0, 0, -5, "
    "0, 0, 0]]\n"
    "[[boundary.load_oscillation]]\nforce = [0, 0, 3]\nomega = 40\n" +
    wall_text("floor", "[0, 0, 0]", "[0, 0, 1]");
const std::string grains_of_bodies =
    "x,y,z,radius\n0.02,0.05,0.1,0.1\n1,0,0.1,0.1\n0.25,0,0.3,0.1\n0.45,0,0.3,0.1\n0.35,0.3,0.3,0.1\n";

// Limits of differences of places (m) and velocities (m/s) of free grains of two runs, those of disks with their rims.
void check_same_motion(const Session& session, std::initializer_list<Index> steps, double places, double velocities,
                       const std::string& one = "run.h5") {
  const GranularSystem system = read_trajectory_header(session.path(one)).system;
  const bool space = system.dimension == 3;
  for (const Index step : steps) {
    CAPTURE(step);
    const GranularState p = read_trajectory_step(session.path(one), step).state;
    const GranularState q = read_trajectory_step(session.path("back.h5"), step).state;
    REQUIRE(p.x.size() == q.x.size());
    double apart = 0, faster = 0;
    for (std::size_t i = 0; i < p.x.size(); ++i) {
      const double dz = space ? p.z[i] - q.z[i] : 0;
      apart = std::max({apart, std::abs(p.x[i] - q.x[i]), std::abs(p.y[i] - q.y[i]), std::abs(dz)});
      if (!system.free(static_cast<Index>(i))) continue;
      const double third = space ? p.velocity_z[i] - q.velocity_z[i] : system.radius[i] * (p.spin[i] - q.spin[i]);
      faster = std::max({faster, std::abs(p.velocity_x[i] - q.velocity_x[i]),
                         std::abs(p.velocity_y[i] - q.velocity_y[i]), std::abs(third)});
    }
    CHECK(apart < places);
    CHECK(faster < velocities);
  }
}

// A step of a case is exported as OUTBOX without a DATBOX, and standard error says why.
void check_no_datbox(const Session& session, const std::string& text, const std::string& why) {
  session.file("case.toml", text);
  session.answer("simulate case.toml --steps 1 -o run.h5 --force");
  session.ended(0, "export run.h5 --lmgc90 out --force", {"no DATBOX is written: " + why});
  CHECK_FALSE(session.has("out/DATBOX/BODIES.DAT"));
  CHECK(session.has("out/OUTBOX/DOF.OUT.1"));
}

}  // namespace

TEST_CASE_FIXTURE(Session, "DATBOX: a run from it is that of the case it was written from, to its seven digits") {
  write_box(*this);
  answer("simulate box/DATBOX --steps 15 --set dynamics.step=0.005 --set dynamics.boundary_instant=middle -o back.h5");
  const GranularSystem system = read_trajectory_header(path("back.h5")).system;
  CHECK(system.free_grains() == 60);
  CHECK(system.boundaries.size() == 3);
  CHECK(system.walls.size() == 1);
  // A gap that is off by the seventh digit of a coordinate is off by that over the step as a speed.
  check_same_motion(*this, {0, 1, 5, 15}, 5e-6, 1e-3);
  // They do move, by far more than that.
  const GranularState end = read_trajectory_step(path("run.h5"), 15).state;
  const GranularState begin = read_trajectory_step(path("run.h5"), 0).state;
  double moved = 0;
  for (std::size_t i = 0; i < end.x.size(); ++i) moved = std::max(moved, std::abs(end.x[i] - begin.x[i]));
  CHECK(moved > 1e-3);
}

TEST_CASE_FIXTURE(Session, "DATBOX: restitution, initial velocities and no friction") {
  file("ball.csv", "x,y,radius\n0,0.6,0.5\n3,0.55,0.5\n");
  file("ball.toml", case_text("ball.csv", "1, 1",
                              "[masses]\ndensity = 1234.5\n"
                              "[interaction]\nfriction = 0.25\nrestitution = 0.75\ntangential_restitution = 0.5\n"
                              "[dynamics]\nstep = 0.01\nsteps = 30\ngravity = [0.5, -9.81]\n") +
                        line_text("floor", "[-1, 0]", "[1, 0]") + "[[prescribed]]\ngrain = 0\nvelocity = [0.5, -1]\n");
  answer("simulate ball.toml -o run.h5");
  write_datbox(*this, "run.h5", "DATBOX");
  answer("simulate DATBOX/ --steps 30 --set dynamics.step=0.01 -o back.h5");
  const GranularState end = read_trajectory_step(path("run.h5"), 30).state;
  CHECK(end.velocity_y[0] > -1);  // it came back from the floor
  CHECK(end.spin[0] != 0);
  check_same_motion(*this, {1, 10, 30}, 1e-6, 1e-6);
}

TEST_CASE_FIXTURE(Session, "DATBOX: read wherever a packing is") {
  write_box(*this, " --steps 1");
  const Packing packing = read_packing(path("box"));
  const GranularSystem system = read_trajectory_header(path("run.h5")).system;
  REQUIRE(packing.size() == 60);  // without what is driven
  for (std::size_t i = 0; i < 60; ++i) {
    CHECK(packing.mass[i] == doctest::Approx(system.mass[i]).epsilon(1e-6));
    CHECK(packing.radius[i] == doctest::Approx(system.radius[i]).epsilon(1e-6));
  }
  const std::string remark = "coordinates with an error of up to ";
  CHECK(contains(remarked("inspect box/DATBOX", remark), "box"));
  const CsvTable swept = read_table(remarked("sweep box/DATBOX --subdomains 2x1 --epsilon 1 --csv -", remark));
  CHECK(swept.text(0, "case") == "box");
  CHECK(swept.number(0, "grains") == static_cast<double>(packing.size()));
  answer("generate box/DATBOX -o packing.csv");
  CHECK(read_packing(path("packing.csv")).x == packing.x);
  file("mine.toml", case_text("box/DATBOX", "2, 1"));
  CHECK(value(remarked("inspect mine.toml", remark), "contacts") == swept.text(0, "contacts"));
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: places, velocities and forces obey Newton's law by the files alone") {
  file("box.toml", box_case());
  answer("simulate box.toml -o run.h5");
  const Outcome outcome = run("export run.h5 --lmgc90 out --steps 10:15");
  CHECK(contains(outcome.standard_output, "out: 6 steps (10:15)"));
  CHECK(run_script("cli/check_outbox.py", {path("run.h5"), path("out/OUTBOX"), "12"}) == 0);
  check_refused("export run.h5 --lmgc90 out", {"out", "--force"});
  check_refused("export run.h5 --lmgc90 new --vtk pictures", {"--lmgc90"});
  check_refused("export run.h5 --lmgc90 new --vtkhdf new.vtkhdf", {"expected one of", "several"});
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: the folder reads back to the case that it was written from") {
  std::string text = box_case();
  SUBCASE("a wall that is pushed in, and a side of disks that turns") {}
  SUBCASE("a wall that begins far from the grains") { text = replaced(text, "from = [3, 0]", "from = [3, -100]"); }
  SUBCASE("restitution") {
    text = replaced(text, "friction = 0.3", "friction = 0.3\nrestitution = 0.4");
    text = replaced(text, "\npenetration_correction = 0", "");
  }
  file("box.toml", text);
  answer("simulate box.toml -o run.h5");
  answer("export run.h5 --lmgc90 out");
  for (const std::string file :
       {"BODIES.DAT", "BULK_BEHAV.DAT", "TACT_BEHAV.DAT", "DRV_DOF.DAT", "DOF.INI", "Vloc_Rloc.INI"})
    CHECK(has("out/DATBOX/" + file));
  CHECK(contains(read("out/DATBOX/DRV_DOF.DAT"), "evolution velocity_"));
  answer("simulate out --steps 15 --set dynamics.step=0.005 --set dynamics.boundary_instant=middle -o back.h5");
  const GranularSystem before = read_trajectory_header(path("run.h5")).system,
                       after = read_trajectory_header(path("back.h5")).system;
  REQUIRE(after.boundaries.size() == before.boundaries.size());
  REQUIRE(after.walls.size() == before.walls.size());
  const Interaction interaction = datbox_dynamics(read_datbox(path("out"))).interaction;
  CHECK(std::pair(interaction.friction, interaction.boundary_friction) == std::pair(0.3, 0.5));
  CHECK(interaction.restitution == (contains(text, "restitution") ? 0.4 : 0));
  for (const double t : {0.0, 0.01, 0.02, 0.5})
    for (std::size_t b = 0; b < before.boundaries.size(); ++b) {
      const RigidVelocity p = before.boundaries[b].motion.at(t), q = after.boundaries[b].motion.at(t);
      for (const auto& [one, other] : {std::pair(p.x, q.x), {p.y, q.y}, {p.spin, q.spin}})
        CHECK(one == doctest::Approx(other).epsilon(1e-6));
    }
  // With restitution overlaps are pushed apart, and the eighth digit of a place decides which gaps are overlaps.
  if (!contains(text, "restitution")) check_same_motion(*this, {1, 5, 15}, 5e-6, 1e-3);
  // Once more from what was read: the same folder, to the digits of its numbers.
  answer("export back.h5 --lmgc90 again");
  const Packing once = datbox_packing(read_datbox(path("out")), DatboxGrains::all),
                twice = datbox_packing(read_datbox(path("again")), DatboxGrains::all);
  REQUIRE(once.size() == twice.size());
  for (std::size_t i = 0; i < once.x.size(); ++i) {
    CHECK(once.radius[i] == twice.radius[i]);
    CHECK(std::abs(once.x[i] - twice.x[i]) < 2e-6);
    CHECK(std::abs(once.y[i] - twice.y[i]) < 2e-6);
  }
  CHECK(read("again/DATBOX/TACT_BEHAV.DAT") == read("out/DATBOX/TACT_BEHAV.DAT"));
  // A later step: grains and boundaries where they then are.
  answer("export run.h5 --lmgc90 later --steps 15");
  CHECK(contains(read("later/DATBOX/DOF.INI"), "$steps       15"));
  remarked("simulate later --steps 1 -o later.h5", "0.005 s (as before DOF.INI)");  // from there on, spins included
  CHECK(read_packing(path("later")).size() == 60);
  const GranularState end = read_trajectory_step(path("run.h5"), 15).state;
  const Packing later = datbox_packing(read_datbox(path("later")), DatboxGrains::all);
  REQUIRE(later.size() == static_cast<Index>(end.x.size()));
  CHECK(std::ranges::any_of(end.poses, [](const Pose& pose) { return std::abs(pose.angle) > 1e-4; }));
  const GranularState start = read_trajectory_step(path("later.h5"), 0).state;
  const auto free = std::span(end.spin).first(60);
  CHECK(std::ranges::any_of(free, [](double spin) { return std::abs(spin) > 1e-3; }));
  for (std::size_t i = 0; i < end.x.size(); ++i) {  // those of the side that has turned, too
    CHECK(std::abs(later.x[i] - end.x[i]) < 2e-6);
    CHECK(std::abs(later.y[i] - end.y[i]) < 2e-6);
    if (i < 60) CHECK(start.spin[i] == doctest::Approx(end.spin[i]).epsilon(1e-6));
  }
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: no DATBOX is written of what would be another case, with a note") {
  check_no_datbox(*this, replaced(box_case(), "friction = 0.3", "law = \"cohesive\"\ncohesion = 1.0\nfriction = 0.3"),
                  "interaction.law: expected cohesive with the condition on the gap and a cohesion_range");
  check_no_datbox(
      *this,
      replaced(replaced(box_case(), "[[0, 0, 0, 0], [0.02, -0.05, 0, 0]]", "[[0, 0, 0, 0], [0.02, -0.05, 0, 0.1]]"),
               "centre = [3, 0]", "centre = [2.5, 0]"),
      "boundary 'right': expected a wall that turns about a point on it or behind it");
  check_no_datbox(*this, replaced(box_case(), "spin = -0.075", "spin = -0.075\norientation = \"fixed\""),
                  "boundary 'left': expected disks that turn with their boundary");
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: a wall that turns about a point on it or behind it is a plank") {
  for (const std::string centre : {"centre = [3, 0]", "centre = [3.4, 1]"}) {
    CAPTURE(centre);
    file("box.toml",
         replaced(replaced(box_case(), "[[0, 0, 0, 0], [0.02, -0.05, 0, 0]]", "[[0, 0, 0, 0], [0.02, 0, 0, -0.075]]"),
                  "centre = [3, 0]", centre));
    answer("simulate box.toml -o run.h5 --force");
    answer("export run.h5 --lmgc90 out --force");
    answer(
        "simulate out --steps 15 --set dynamics.step=0.005 --set dynamics.boundary_instant=middle -o back.h5 --force");
    // An angle of seven digits, and what grains make of it. The wall itself moves by millimetres.
    check_same_motion(*this, {15}, 5e-5, 1e-2);
  }
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: spheres obey Newton's law by the files alone") {
  file("bed.toml", spheres);
  answer("simulate bed.toml -o run.h5");
  const Outcome outcome = run("export run.h5 --lmgc90 out --steps 10:15");
  CHECK(contains(outcome.standard_output, "out: 6 steps (10:15), 60 spheres"));
  CHECK(outcome.standard_error == "");
  CHECK(run_script("cli/check_outbox_in_space.py", {path("run.h5"), path("out/OUTBOX"), "12"}) == 0);
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: a folder of spheres reads back to the case that it was written from") {
  file("bed.toml", spheres);
  answer("simulate bed.toml -o run.h5");
  answer("export run.h5 --lmgc90 out");
  CHECK(contains(read("out/DATBOX/DRV_DOF.DAT"), "evolution velocity_63_1.dat"));
  answer("simulate out --steps 15 --set dynamics.step=0.005 --set dynamics.boundary_instant=middle -o back.h5");
  const GranularSystem before = read_trajectory_header(path("run.h5")).system,
                       after = read_trajectory_header(path("back.h5")).system;
  REQUIRE(after.dimension == 3);
  REQUIRE(after.walls.size() == before.walls.size());
  const Interaction interaction = datbox_dynamics(read_datbox(path("out"))).interaction;
  CHECK(std::pair(interaction.friction, interaction.boundary_friction) == std::pair(0.3, 0.5));
  for (std::size_t w = 0; w < before.walls.size(); ++w) {
    // Bodies are the free spheres, those of boundaries, and the walls, in this order.
    const Wall &p = before.walls[w], &q = after.walls[w];
    double height = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      CHECK(p.normal[k] == doctest::Approx(q.normal[k]).epsilon(1e-6));
      height += (q.point[k] - p.point[k]) * p.normal[k];
    }
    CHECK(q.plank());  // whose face is the wall
    CHECK(std::abs(height + q.radius) < 1e-6);
    for (const double t : {0.0, 0.01, 0.5}) {
      const RigidVelocity u = before.boundaries[at(p.boundary)].motion.at(t),
                          v = after.boundaries[at(q.boundary)].motion.at(t);
      for (const auto& [one, other] : {std::pair(u.x, v.x), {u.spin_y, v.spin_y}, {u.spin_x, v.spin_x}})
        CHECK(one == doctest::Approx(other).epsilon(1e-6));
    }
  }
  check_same_motion(*this, {1, 5}, 1e-4, 1e-2);
  check_same_motion(*this, {15}, 1e-4, 5e-2);  // coordinates of seven digits drift apart
  // The linear study, and a packing that it is: without what is driven.
  const Packing packing = read_packing(path("out"));
  CHECK(packing.dimension() == 3);
  CHECK(packing.size() == 59);
  const std::string remark = "coordinates with an error of up to ";
  CHECK(contains(remarked("inspect out", remark), "grains               59"));
  remarked("sweep out --subdomains 2x1x1 --epsilon 1 --eta inf --csv swept.csv", remark);
}

TEST_CASE_FIXTURE(Session,
                  "export --lmgc90: free bodies in space read back to the motion that they were written from") {
  file("grains.csv", grains_of_bodies);
  file("bodies.toml", bodies_in_space);
  answer("simulate bodies.toml -o run.h5");
  answer("export run.h5 --lmgc90 good");
  REQUIRE(has("good/DATBOX/BODIES.DAT"));
  const std::string as_before = " --set dynamics.step=0.002 --set dynamics.boundary_instant=middle";
  answer("simulate good --steps 100 -o back.h5" + as_before);
  const std::vector<BoundarySpec> written = datbox_dynamics(read_datbox(path("good"))).boundaries;
  REQUIRE(written.size() == 4);
  const double expected[][4] = {{30, 0.3, 0.2, 0.4}, {15, 0.0833333333, 0.2833333333, 0.3333333333}, {2, 0, 0, 0}};
  for (std::size_t b = 0; b < 3; ++b) {  // the clump; the slab, along its length, width and normal; the lid
    REQUIRE(written[b].body.has_value());
    CHECK(written[b].body->mass == doctest::Approx(expected[b][0]).epsilon(3e-6));
    for (std::size_t k = 0; b < 2 && k < 3; ++k)
      CHECK(written[b].body->inertia[k] == doctest::Approx(expected[b][k + 1]).epsilon(3e-6));
    CHECK(written[b].body->wholly_free(3) == (b < 2));
  }
  CHECK(written[2].body->directions == std::array<bool, 6>{false, false, true, false, false, false});
  const auto compare = [&](const std::string& other, Index step, Index step_of_other) {
    CAPTURE(step);
    const TrajectoryStep p = read_trajectory_step(path("run.h5"), step),
                         q = read_trajectory_step(path(other), step_of_other);
    double places = 0;
    for (std::size_t i = 0; i < p.state.x.size(); ++i)
      places = std::max({places, std::abs(p.state.x[i] - q.state.x[i]), std::abs(p.state.z[i] - q.state.z[i])});
    for (std::size_t b = 0; b < 3; ++b) {
      const Pose &u = p.state.poses[b], &v = q.state.poses[b];
      places = std::max({places, std::abs(u.x - v.x), std::abs(u.y - v.y), std::abs(u.z - v.z)});
    }
    CHECK(places < 1e-5);
    if (step_of_other > 0) CHECK(p.contacts.size() == q.contacts.size());
  };
  for (const Index step : {0, 1, 50, 100}) compare("back.h5", step, step);
  const GranularState begin = read_trajectory_step(path("run.h5"), 0).state,
                      end = read_trajectory_step(path("run.h5"), 100).state;
  CHECK(end.poses[0].turn.angularDistance(begin.poses[0].turn) > 0.1);
  CHECK(end.poses[1].turn.angularDistance(begin.poses[1].turn) > 0.1);
  CHECK(begin.poses[2].z - end.poses[2].z > 0.04);
  // From a later step on, with the poses and spins that bodies then have.
  answer("export run.h5 --lmgc90 later --steps 50");
  answer("simulate later --steps 50 -o later.h5" + as_before);
  compare("later.h5", 50, 0);
  compare("later.h5", 100, 50);
  answer("export back.h5 --lmgc90 again");
  CHECK(read("again/DATBOX/TACT_BEHAV.DAT") == read("good/DATBOX/TACT_BEHAV.DAT"));
  CHECK(has("again/DATBOX/DRV_DOF.DAT"));
  // The centre of a body that does not turn may be anywhere.
  file("bodies.toml", replaced(bodies_in_space, "centre = [1, 0, 0.3]", "centre = [1, 0.5, 0.4]"));
  answer("simulate bodies.toml -o aside.h5");
  answer("export aside.h5 --lmgc90 aside");
  answer("simulate aside --steps 100 -o back.h5 --force" + as_before);
  check_same_motion(*this, {100}, 1e-5, infinity, "aside.h5");
  check_no_datbox(*this, replaced(bodies_in_space, "force = [5, 0, 0]", "torque = [0, 0, 1]"),
                  "boundary 'clump': expected no torque on a body in space");
  check_no_datbox(*this, replaced(bodies_in_space, "centre = [0.35, 0.1, 0.3]", "centre = [0.35, 0.1, 0.31]"),
                  "boundary 'clump': expected its centre to be that of its shapes");
  check_no_datbox(*this, replaced(bodies_in_space, "centre = [0, 0, 0.3]", "centre = [0, 0.1, 0.3]"),
                  "boundary 'slab': expected its centre to be the middle of its plank or cylinder");
  check_no_datbox(*this, replaced(bodies_in_space, "0.08333333333", "0.09"),
                  "boundary 'slab': expected the inertia of a full box with the density of grains");
  file("grains.csv",
       "x,y,z,radius,mass\n0.02,0.05,0.1,0.1,10\n1,0,0.1,0.1,11\n0.25,0,0.3,0.1,1\n0.45,0,0.3,0.1,1\n"
       "0.35,0.3,0.3,0.1,1\n");
  check_no_datbox(*this, replaced(bodies_in_space, "[masses]\ndensity = 2500\n", ""),
                  "masses: expected free spheres of one density");
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: what of spheres LMGC90 would compute otherwise is said") {
  check_no_datbox(*this, replaced(spheres, "velocity = [0.02, 0, 0]", "spin = [0, 0, 0.1]"),
                  "boundary 'probe': expected a boundary of spheres, or of several shapes, that does not turn");
  check_no_datbox(*this, replaced(spheres, "centre = [0, 0, 0]", "centre = [0.2, 0, 0]"),
                  "boundary 'left': expected a wall that turns about a point on it or behind it");
  check_no_datbox(
      *this, replaced(spheres, "spin = [0, 0.1, 0]", "motion = [[0, 0, 0, 0, 0, 0.1, 0], [1, 0, 0, 0, 0, 0, 0.1]]"),
      "boundary 'left': expected a wall that turns about one axis");
  check_no_datbox(*this, replaced(spheres, "friction = 0.3", "law = \"cohesive\"\ncohesion = 1.0\nfriction = 0.3"),
                  "interaction.law: expected cohesive with the condition on the gap and a cohesion_range");
}

TEST_CASE_FIXTURE(Session, "DATBOX: what is not modelled is refused with its file and line") {
  write_box(*this, " --steps 1");
  const std::string bodies = read("box/DATBOX/BODIES.DAT"), laws = read("box/DATBOX/TACT_BEHAV.DAT"),
                    drives = read("box/DATBOX/DRV_DOF.DAT");
  const auto refused = [&](const std::string& name, const std::string& text, std::initializer_list<std::string> parts) {
    const std::string before = read("box/DATBOX/" + name);
    file("box/DATBOX/" + name, text);
    check_refused("simulate box/DATBOX --steps 1 -o new.h5", parts);
    file("box/DATBOX/" + name, before);
  };
  refused("BODIES.DAT", replaced(bodies, "DISKx", "POLYG"), {"BODIES.DAT:9:", "other shapes", "POLYG"});
  refused("TACT_BEHAV.DAT", replaced(laws, "IQS_CLB", "MAC_CZM"), {"TACT_BEHAV.DAT:3:", "MAC_CZM"});
  refused("DRV_DOF.DAT", replaced(drives, "vlocy", "speed"), {"DRV_DOF.DAT:7:", "vlocy or force"});
  const std::string spinning = replaced(read("box/DATBOX/DOF.INI"), "V(3)= 0.0000000D+00", "V(3)= 0.1000000D+01");
  file("box/DATBOX/DOF.INI", spinning);
  check_refused("sweep box --epsilon 1 --csv box/DATBOX/DRV_DOF.DAT --force", {"would be lost"});
  remarked("inspect box/DATBOX", "an error of up to ");  // the linear study has no spins
  file("empty/DATBOX/other", "");
  check_refused("inspect empty/DATBOX", {"empty/DATBOX", "BODIES.DAT"});
}
