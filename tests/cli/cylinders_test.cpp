// SPDX-License-Identifier: GPL-3.0-or-later
// Runs in drums of the plane and beside cylinders of space: files, restarts, pages, and folders of LMGC90.
#include "formats/lmgc90/datbox.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A lattice of disks in a drum that turns, with a bar that is moved through it.
std::string drum_in_plane(const std::string& more = "spin = 2\n") {
  return case_text("hexagonal\ncolumns = 5\nrows = 5\nradius = 0.1\ndisorder = 0.1", "1, 1",
                   "[masses]\ndensity = 2500\n[interaction]\nfriction = 0.4\n[dynamics]\nstep = 0.002\nsteps = 200\n"
                   "penetration_correction = 0\n"
                   "[[boundary]]\nname = \"drum\"\nshape = \"cylinder\"\nfrom = [0.4, 0.4]\nradius = 0.75\n") +
         more;
}

// Spheres over a full cylinder with ends that moves across its axis, in a hollow one that turns.
const std::string cylinders_in_space =
    case_text("cubic\ncolumns = 3\nrows = 3\nlayers = 3\nradius = 0.1\ndisorder = 0.1", "1, 1, 1",
              "[masses]\ndensity = 2500\n[interaction]\nfriction = 0.4\n[dynamics]\nstep = 0.002\nsteps = 150\n"
              "penetration_correction = 0\n"
              "[[boundary]]\nname = \"drum\"\nshape = \"cylinder\"\nfrom = [0.2, 0, 0.2]\nto = [0.2, 1, 0.2]\n"
              "radius = 0.55\nspin = [0, 2, 0]\n"
              "[[boundary]]\nname = \"rod\"\nshape = \"cylinder\"\nfrom = [0.2, -0.05, -0.2]\nto = [0.2, 0.45, -0.2]\n"
              "radius = 0.1\nside = \"outside\"\nends = true\nvelocity = [0.1, 0, 0]\n") +
    wall_text("front", "[0, -0.3, 0]", "[0, 1, 0]") + wall_text("back", "[0, 0.7, 0]", "[0, -1, 0]");

double largest_move(const Session& session, const std::string& one, const std::string& other, Index step) {
  const GranularState p = read_trajectory_step(session.path(one), step).state,
                      q = read_trajectory_step(session.path(other), step).state;
  REQUIRE(p.x.size() == q.x.size());
  double largest = 0;
  for (std::size_t i = 0; i < p.x.size(); ++i)
    largest = std::max(largest, std::hypot(p.x[i] - q.x[i], p.y[i] - q.y[i], p.z.empty() ? 0 : p.z[i] - q.z[i]));
  return largest;
}

}  // namespace

TEST_CASE_FIXTURE(Session,
                  "cylinders: a drum in the plane is kept by the trajectory, goes on after a restart, is drawn") {
  file("drum.toml", drum_in_plane());
  answer("simulate drum.toml -o whole.h5");
  answer("simulate drum.toml --steps 90 -o parts.h5");
  answer("simulate drum.toml --steps 200 --restart -o parts.h5");
  CHECK(largest_move(*this, "whole.h5", "parts.h5", 200) == 0);
  const Wall wall = read_trajectory_header(path("whole.h5")).system.walls.at(0);
  CHECK(wall.radius == 0.75);
  CHECK(wall.round());
  CHECK(wall.normal == std::array<double, 3>{0, 0, 1});
  answer("report whole.h5 -o drum.html");
  const std::string page = read("drum.html");
  CHECK(times(page, "\"walls\":[[0.4,0.4,") == 201);
  CHECK(times(page, "0.0,0.75]]") == 201);
  const TrajectoryStep last = read_trajectory_step(path("whole.h5"), 200);
  double lowest = 1;
  for (std::size_t i = 0; i < last.state.x.size(); ++i) {
    CHECK(std::hypot(last.state.x[i] - 0.4, last.state.y[i] - 0.4) < 0.75 - 0.09 + 1e-3);
    lowest = std::min(lowest, last.state.y[i]);
  }
  CHECK(lowest < -0.2);  // they have fallen to the bottom
}

TEST_CASE_FIXTURE(Session, "cylinders: the page of a run draws one that has ends with half its length") {
  file("rod.toml", cylinders_in_space);
  answer("simulate rod.toml -o rod.h5 --save-every 75");
  answer("report rod.h5 -o rod.html");
  CHECK(contains(read("rod.html"), "[[0.2,0.0,0.2,0.0,1.0,0.0,0.55],[0.23,0.2,-0.2,0.0,1.0,0.0,-0.1,0.25],"));
  const Wall wall = read_trajectory_header(path("rod.h5")).system.walls.at(1);
  CHECK(wall.has_ends());
  CHECK(wall.half_length == 0.25);
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: drums and cylinders are written, and read back to the same run") {
  for (const bool space : {false, true}) {
    CAPTURE(space);
    file("run.toml", space ? cylinders_in_space : drum_in_plane());
    answer("simulate run.toml -o run.h5 --force");
    answer("export run.h5 --lmgc90 out --force");
    const std::string bodies = read("out/DATBOX/BODIES.DAT"), sights = read("out/DATBOX/TACT_BEHAV.DAT"),
                      contacts = read("out/OUTBOX/Vloc_Rloc.OUT.150");
    for (const std::string& kind : space ? Texts{"DNLYC", "CYLND", "PLANx"} : Texts{"xKSID"}) {
      CHECK(contains(bodies, " " + kind + "      1  color  BOUND"));
      CHECK(contains(sights, kind + "  BOUND"));
    }
    for (const std::string& kind : space ? Texts{"SPDCx", "SPCDx"} : Texts{"DKKDx"})
      CHECK(contains(contacts, "$icdan  " + kind + "        1"));
    answer(std::string("simulate out --steps 150 --set dynamics.step=0.002 --set dynamics.boundary_instant=middle") +
           " -o back.h5 --force");
    CHECK(largest_move(*this, "run.h5", "back.h5", 50) < 1e-4);
    const std::vector<Wall> walls = read_trajectory_header(path("back.h5")).system.walls;
    CHECK(walls[0].radius == (space ? 0.55 : 0.75));
    if (space) CHECK(walls[1].half_length == doctest::Approx(0.25));
    CHECK(read_trajectory_step(path("run.h5"), 150).contacts.size() > 30);
    ended(0, "solve out/OUTBOX/Vloc_Rloc.OUT.150 --guess 1", {});
  }
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: the files say the forces of a drum, on the disks and at their places") {
  file("one.csv", "x,y,radius\n1,0.6,0.5\n");
  file("one.toml", case_text("one.csv", "1, 1",
                             "[masses]\ndensity = 100\n[dynamics]\nstep = 0.01\nsteps = 3\n"
                             "[[boundary]]\nname = \"drum\"\nshape = \"cylinder\"\nfrom = [1, 2.1]\nradius = 2\n"));
  answer("simulate one.toml -o one.h5");
  answer("export one.h5 --lmgc90 out");
  const std::string contacts = read("out/OUTBOX/Vloc_Rloc.OUT.3");
  CHECK(contains(contacts, "RBDY2      1  DISKx      1  CLB_B  RBDY2      2  xKSID      1  stick      2"));
  CHECK(contains(contacts, "rln/H 0.7704756D+03"));  // 100 kg/m^2 times pi/4 m^2 times 9.81 m/s^2
  CHECK(contains(contacts, "n(1)= 0.0000000D+00  n(2)= 0.1000000D+01"));
  CHECK(contains(contacts, "coo1= 0.1000000D+01  coo2= 0.1000000D+00"));
}

TEST_CASE_FIXTURE(Session, "export --lmgc90: what of cylinders LMGC90 has not, or otherwise, is refused or said") {
  file("disk.toml", drum_in_plane("side = \"outside\"\ncentre = [3, 3]\nfree = [\"x\"]\nmass = 1\n"));
  file("disk.toml", replaced(read("disk.toml"), "from = [0.4, 0.4]", "from = [3, 3]"));
  answer("simulate disk.toml --steps 1 -o disk.h5");
  check_refused("export disk.h5 --lmgc90 new", {"LMGC90", "boundary 'drum'", "grains inside"});
  CHECK(!has("new"));
  file("off.toml", drum_in_plane("spin = 2\ncentre = [0.4, 0.3]\n"));
  answer("simulate off.toml --steps 1 -o off.h5");
  ended(0, "export off.h5 --lmgc90 off",
        {"no DATBOX is written: boundary 'drum': expected a plank or cylinder that turns about its middle"});
  // 2 h pi r^2 (r^2/4 + h^2/3) and 2 h pi r^2 r^2/2 with r = 0.1, h = 0.25, and 2500 kg/m^3.
  const std::string free = "free = [\"x\", \"y\", \"z\", \"spin_x\", \"spin_y\", \"spin\"]\nmass = 39.269908\n";
  const auto rod = [&](const std::string& more) {
    file("rod.toml", replaced(cylinders_in_space, "velocity = [0.1, 0, 0]\n", free + more));
    answer("simulate rod.toml --steps 1 -o rod.h5 --force");
  };
  rod("centre = [0.2, 0.2, -0.2]\ninertia = [0.9162979, 0.19634954, 0.9162979]\n");
  answer("export rod.h5 --lmgc90 rod");
  const BoundarySpec written = datbox_dynamics(read_datbox(path("rod"))).boundaries.at(0);  // before the others
  REQUIRE(written.body.has_value());
  CHECK(written.body->mass == doctest::Approx(39.269908).epsilon(1e-6));
  CHECK(written.body->inertia[2] == doctest::Approx(0.19634954).epsilon(1e-6));  // about its axis
  rod("centre = [0.2, 0.2, -0.2]\ninertia = [0.9162979, 0.2, 0.9162979]\n");
  ended(0, "export rod.h5 --lmgc90 two",
        {"boundary 'rod': expected the inertia of a full cylinder with the density of grains, 0.916", "0.196"});
  rod("centre = [0.2, 0.1, -0.2]\ninertia = [0.9162979, 0.19634954, 0.9162979]\n");
  ended(0, "export rod.h5 --lmgc90 three",
        {"boundary 'rod': expected its centre to be the middle of its plank or cylinder"});
}
