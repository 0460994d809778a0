// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: steps that were broken off, taken or counted wrongly because of a body beside those that matter.
#include "../support/granular.hpp"
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"

using namespace nscdd;
using namespace nscdd::testing;

namespace {

struct SmallSession : Session {
  /// A case of a packing x,y,radius on one subdomain without gravity.
  void moving(const std::string& grains, const std::string& sections, double step = 1e-3) const {
    file("p.csv", "x,y,radius\n" + grains);
    file("c.toml", "[packing]\nfile = \"p.csv\"\n[partition]\ngrid = [1, 1]\n" + sections +
                       "[dynamics]\nsteps = 30\ngravity = [0, 0]\nstep = " + std::to_string(step) + "\n");
  }
  double summed(const std::string& column) const {
    double sum = 0;
    for (const double one : read_summary(path("o.h5"), column)) sum += one;
    return sum;
  }
};

const std::string simulate = "simulate c.toml -o o.h5 --force ";

}  // namespace

TEST_CASE_FIXTURE(SmallSession, "simulate: a wall that has come to rest is where it is, not where it would be") {
  moving("0.57,0,0.01\n",
         "[[boundary]]\nname = \"w\"\nshape = \"wall\"\nfrom = [-0.05, 1]\nto = [-0.05, 0]\n"
         "motion = [[0, 5, 0, 0], [0.02, 0, 0, 0]]\n",
         0.01);
  answer(simulate + "--set dynamics.gravity=-20,0");
}

TEST_CASE_FIXTURE(SmallSession, "simulate: a light plate that is driven across may push a heavy disk") {
  moving("0.11,0,0.1\n",
         "[[boundary]]\nname = \"plate\"\nshape = \"plank\"\nfrom = [0, -1]\nto = [0, 1]\nradius = 0.01\n"
         "centre = [0, 0]\nfree = [\"y\"]\nmass = 0.001\nvelocity = [1, 0]\n");
  answer(simulate);
}

TEST_CASE_FIXTURE(SmallSession, "simulate: a disk that hovers does not hide that another has no room") {
  const std::string walls =
      "[[boundary]]\nname = \"left\"\nshape = \"wall\"\nfrom = [-0.01, 1]\nto = [-0.01, 0]\nvelocity = [0.1, 0]\n"
      "[[boundary]]\nname = \"right\"\nshape = \"wall\"\nfrom = [0.01, 0]\nto = [0.01, 1]\nvelocity = [-0.1, 0]\n"
      "[[boundary]]\nname = \"floor\"\nshape = \"plank\"\nfrom = [-0.005, -0.03985]\nto = [0.005, -0.03985]\n"
      "radius = 0.01\n";
  moving("0,0,0.01\n0,-0.0205,0.009\n", walls, 1e-4);
  ended(1, simulate + "--algorithm nlgs --steps 1 --iterations 2000", {"no solution", "disk 0"});
}

TEST_CASE_FIXTURE(SmallSession,
                  "simulate: impulses are those of the contacts, whoever finds them and however they pull") {
  moving("0,0.1,0.1\n0,0.3,0.1\n",
         "[interaction]\nlaw = \"cohesive\"\ncohesion = 1000\n"
         "[[boundary]]\nname = \"floor\"\nshape = \"wall\"\nfrom = [0, 0]\nto = [1, 0]\n");
  const std::string two_steps = simulate + "--set dynamics.gravity=0,-9.81 --steps 2 --algorithm ";
  for (const std::string algorithm : {"auto", "nlgs", "newton"}) {
    CAPTURE(algorithm);
    answer(two_steps + algorithm);
    CHECK(summed("impulses") == doctest::Approx(2 * 9.81e-3 * std::sqrt(5.0)).epsilon(1e-6));  // 2 m g h below, m g h
  }
}

TEST_CASE_FIXTURE(SmallSession,
                  "simulate: a run with a body of grains and disks goes on, its grains with their colours") {
  moving(
      "0,0,0.1\n0,0.25,0.1\n",
      "[[boundary]]\nname = \"body\"\nshape = \"grains\"\nfirst = 0\nlast = 0\ncentre = [0, 0]\nvelocity = [0.1, 1]\n"
      "[[boundary]]\npart_of = \"body\"\nshape = \"disks\"\nfrom = [-0.2, 0]\nto = [0.2, 0]\nradius = 0.05\n"
      "[[colour]]\nname = \"last\"\nfirst = -1\nlast = -1\n[[pair]]\ncolours = [\"last\", \"\"]\nfriction = 0\n",
      5e-3);
  answer(simulate);
  const std::vector<double> all = numbers_of(read_last_step(path("o.h5")).state);
  answer(simulate + "--steps 5");  // before they meet
  answer("simulate c.toml -o o.h5 --restart");
  CHECK(numbers_of(read_last_step(path("o.h5")).state) == all);
  const GranularSystem system =
      rebuilt_simulation("o.h5", read_trajectory_header(path("o.h5")), read_last_step(path("o.h5")).state).system;
  CHECK(system.pairs.of(0, 1).friction == 0);
  CHECK_FALSE(system.pairs.of(0, system.grains() - 1).friction.has_value());
}

TEST_CASE_FIXTURE(SmallSession, "simulate: conjugate gradients of a case do not act in Schwarz's method") {
  moving("",
         "[solver]\nalgorithm = \"generic\"\ninterface_method = \"conjugate_gradient\"\ntolerance = 1e-4\n"
         "[[boundary]]\nname = \"floor\"\nshape = \"wall\"\nfrom = [0, -0.5]\nto = [1, -0.5]\n");
  const std::string text =
      replaced(replaced(read("c.toml"), "file = \"p.csv\"", "generator = \"hexagonal\""), "[1, 1]", "[2, 1]");
  const auto iterations = [&](const std::string& content) {
    file("c.toml", content);
    answer(simulate + "--algorithm schwarz --steps 1 --set dynamics.gravity=0,-9.81 --iterations 100000");
    return summed("iterations");
  };
  CHECK(iterations(text) == iterations(replaced(text, "interface_method = \"conjugate_gradient\"\n", "")));
}

TEST_CASE_FIXTURE(SmallSession, "simulate: without friction a surface may tie the free directions of a body") {
  moving("0,0,0.1\n-0.8,5,0.1\n",
         "[interaction]\nlaw = \"frictionless\"\n[[boundary]]\nname = \"slope\"\nshape = \"wall\"\n"
         "from = [0, -0.1414213562373]\nto = [1, 0.8585786437627]\n[[boundary]]\nname = \"b\"\nshape = \"grains\"\n"
         "first = 0\nlast = 0\nfree = [\"y\"]\nmass = 1\ncentre = [0, 0]\n");
  answer(simulate);
}
