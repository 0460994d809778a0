// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: verdicts on its steps, runs that end at a step without a solution, and the chains that jam.
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"

#include <cmath>

using namespace nscdd::testing;

namespace {

// Walls at x = -0.5 and `right`, the latter moving to the left at 0.1 m/s, without gravity and pushes of overlaps.
std::string closing_case(const std::string& packing, const std::string& right) {
  return case_text(packing, "2, 1",
                   "[masses]\nmodel = \"given\"\n[interaction]\nfriction = 0.3\n[dynamics]\nstep = 0.005\nsteps = 6\n"
                   "penetration_correction = 0\ngravity = [0, 0]\n") +
         line_text("left", "[-0.5, 5]", "[-0.5, -5]") +
         line_text("right", "[" + right + ", -5]", "[" + right + ", 5]", "velocity = [-0.1, 0]\n");
}

// Touching disks in a row from x = 0 on, in the order of `places`, with several one that touches none of them.
std::string disks_at(const std::vector<int>& places) {
  std::string text = "x,y,radius,mass\n";
  for (const int x : places) text += std::to_string(x) + ",0.5,0.5,1\n";
  return text + (places.size() > 1 ? "2,7,0.5,1\n" : "");
}

}  // namespace

TEST_CASE_FIXTURE(Session, "simulate: a step without a solution ends the run with its chain, and --restart goes on") {
  file("one.csv", disks_at({0}));
  file("closing.toml", closing_case("one.csv", "0.5"));
  const std::string said =
      "step 1: no solution: the wall of boundary 'left', disk 0, the wall of boundary 'right': closing at 0.1 m/s "
      "(proved for changes of velocity below ";
  const Outcome closing = ended(1, "simulate closing.toml -o run.h5", {"run.h5: " + said, "the last good state"});
  CHECK(contains(closing.standard_output, "impossible: 0 steps in this run, 0 of 6 in all"));
  const std::string run = path("run.h5");
  CHECK(nscdd::read_end(run).starts_with("impossible: " + said));
  CHECK(nscdd::read_statuses(run).empty());
  const auto check_chain = [&](nscdd::Index step) {
    const auto chain = nscdd::read_chains(run, step);
    REQUIRE(chain.size() == 2 * nscdd::at(step));
    for (std::size_t k = 0; k < chain.size(); ++k) {
      CHECK(chain[k].step == nscdd::Index(k / 2) + 1);
      CHECK(chain[k].geometry.a == 0);
      CHECK(chain[k].geometry.b == 1 + nscdd::Index(k % 2));
      CHECK(chain[k].stress == doctest::Approx(1).epsilon(1e-12));
    }
  };
  check_chain(1);
  nscdd::TrajectoryStep drawn = nscdd::read_last_step(run);
  CHECK(drawn.contacts.empty());
  nscdd::add_chain(run, drawn);
  REQUIRE(drawn.contacts.size() == 2);
  CHECK(drawn.contacts[0].self_stress == doctest::Approx(1));
  answer("report run.h5 -o run.html");
  CHECK(contains(read("run.html"), said));
  answer("export run.h5 --vtk pictures");
  CHECK(contains(read("pictures/step-000000.vtp"), "NumberOfPoints=\"3\" NumberOfVerts=\"1\" NumberOfLines=\"2\""));
  CHECK(contains(read("pictures/step-000000.vtp"), "Name=\"self_stress\""));
  ended(1, "simulate closing.toml --restart -o run.h5", {said});
  check_chain(1);
  check_refused("simulate closing.toml --restart --tolerance 1e-6 -o run.h5", {"expected the case and options"});
  const Outcome further = ended(0, "simulate closing.toml --restart --set solver.impossible=go_on -o run.h5",
                                {"in 6 of 6 steps, at first in step 1, the boundaries leave no room: it is proved"});
  CHECK(contains(further.standard_output, "steps: 6 impossible\nverdicts: 6 impossible; least margin -0.0"));
  check_chain(6);
  for (const double speed : nscdd::read_summary(run, "closing_speed")) CHECK(speed == doctest::Approx(0.1));
  for (const double margin : nscdd::read_summary(run, "margin")) CHECK(margin < 0);
  nscdd::TrajectoryStep third = nscdd::read_trajectory_step(run, 3);
  nscdd::add_chain(run, third);
  REQUIRE(third.contacts.size() == 2);
  CHECK(third.contacts[1].self_stress == doctest::Approx(1));
  CHECK(third.contacts[1].carries());
  const std::string never = "simulate closing.toml --verdict never -o never.h5 --steps 3";
  ended(0, never, {"in 3 of 3 steps, at first in step 1, contacts close although"});
  for (const double margin : nscdd::read_summary(path("never.h5"), "margin")) CHECK(std::isnan(margin));
  check_refused(never + " --force --set solver.impossible=go_on", {"solver.verdict failed or every", "met never"});
}

TEST_CASE_FIXTURE(Session, "simulate: a gap does not change the closing speed of the walls") {
  file("one.csv", disks_at({0}));
  // Gaps are those after half a step, 0.15 mm here. A wall at 0.1 m/s closes 0.5 mm in a step of 5 ms.
  file("closing.toml", closing_case("one.csv", "0.5004"));
  ended(1, "simulate closing.toml --verdict every -o run.h5",
        {"step 1: no solution: ", "closing at 0.1 m/s, 0.07 m/s with overlaps and gaps (proved"});
}

TEST_CASE_FIXTURE(Session, "simulate: every algorithm names the disks of a chain in their order, and at most twelve") {
  file("five.csv", disks_at({2, 0, 4, 1, 3}));
  file("five.toml", closing_case("five.csv", "4.5"));
  for (const std::string algorithm : {"auto", "newton", "nlgs", "admm", "accelerated", "generic", "two_stage_newton"}) {
    CAPTURE(algorithm);
    ended(1, "simulate five.toml --force -o five.h5 --algorithm " + algorithm,
          {"step 1: no solution: the wall of boundary 'left', disk 1, disk 3, disk 0, disk 4, disk 2, the wall of "
           "boundary 'right': closing at 0.1 m/s (proved"});
  }
  std::vector<int> places(50);
  for (int k = 0; k < 50; ++k) places[nscdd::at(k)] = k;
  file("fifty.csv", disks_at(places));
  file("fifty.toml", closing_case("fifty.csv", "49.5"));
  ended(1, "simulate fifty.toml --verdict every -o fifty.h5",
        {"left', disk 0, disk 1, ", "disk 10 and 40 more: closing at 0.1 m/s"});
}

TEST_CASE_FIXTURE(Session, "simulate: a sphere between planes that close has no room") {
  file("ball.csv", "x,y,z,radius,mass\n0,0,0.5,0.5,1\n");
  const auto plane = [](const std::string& name, const std::string& z, const std::string& up,
                        const std::string& speed) {
    return "[[boundary]]\nname = \"" + name + "\"\nshape = \"wall\"\npoint = [0, 0, " + z + "]\nnormal = [0, 0, " + up +
           "]\ncentre = [0, 0, " + z + "]\nvelocity = [0, 0, " + speed + "]\n";
  };
  file("planes.toml", case_text("ball.csv", "1, 1, 1",
                                "[masses]\nmodel = \"given\"\n[dynamics]\nstep = 0.005\nsteps = 3\n"
                                "penetration_correction = 0\ngravity = [0, 0, -9.81]\n") +
                          plane("floor", "0", "1", "0.05") + plane("lid", "1", "-1", "-0.1"));
  ended(1, "simulate planes.toml -o run.h5",
        {"the wall of boundary 'floor', sphere 0, the wall of boundary 'lid': closing at 0.15 m/s"});
  const auto chain = nscdd::read_chains(path("run.h5"));
  REQUIRE(chain.size() == 2);
  CHECK(std::abs(chain[0].geometry.normal[2]) == doctest::Approx(1));
  CHECK(chain[1].geometry.point[2] == doctest::Approx(1).epsilon(1e-3));
}

TEST_CASE_FIXTURE(Session, "simulate: a wedge that friction jams is undecided, and the run goes on") {
  // The disk can escape from walls at 0.5 rad, but not where the friction is above tan(0.25) = 0.255.
  file("one.csv", disks_at({0}));
  const auto wedge = [](const std::string& friction) {
    return case_text("one.csv", "1, 1",
                     "[masses]\nmodel = \"given\"\n[interaction]\nfriction = " + friction +
                         "\n[dynamics]\nstep = 0.005\nsteps = 3\npenetration_correction = 0\ngravity = [0, 0]\n") +
           line_text("left", "[-0.5, 5]", "[-0.5, -5]") +
           line_text("slope", "[-1.958339, -4.127628]", "[2.835921, 4.648202]", "velocity = [-0.1, 0]\n");
  };
  file("jams.toml", wedge("0.3"));
  file("slides.toml", wedge("0"));
  const Outcome jammed = run("simulate jams.toml --verdict every -o jams.h5");
  CHECK(jammed.exit_code == 0);
  CHECK(contains(jammed.standard_output, "verdicts: 3 undecided"));
  CHECK(nscdd::read_chains(path("jams.h5")).empty());
  for (const double margin : nscdd::read_summary(path("jams.h5"), "margin")) CHECK(margin <= 0);
  CHECK(contains(answer("simulate slides.toml --verdict every -o slides.h5"), "verdicts: 3 exists"));
}

TEST_CASE_FIXTURE(MovingSession, "simulate: --verdict every proves steps that converge, and changes none of them") {
  const std::string text = answer("simulate shear.toml --steps 5 --verdict every -o run.h5");
  CHECK(contains(text, "verdicts: 5 exists; least margin "));
  const std::vector<double> margins = nscdd::read_summary(path("run.h5"), "margin");
  REQUIRE(margins.size() == 5);
  for (const double margin : margins) CHECK(margin > 0);
  for (const double speed : nscdd::read_summary(path("run.h5"), "closing_speed")) CHECK(std::isnan(speed));
  answer("simulate shear.toml --steps 5 -o plain.h5");
  CHECK(nscdd::read_last_step(path("run.h5")).state.x == nscdd::read_last_step(path("plain.h5")).state.x);
  // Steps that use up their iterations by design are not judged.
  const std::string loose =
      run("simulate shear.toml --steps 5 -o loose.h5 --algorithm nlgs --criterion none --iterations 3").standard_output;
  CHECK(contains(loose, "steps: 5 maximum_reached"));
  CHECK_FALSE(contains(loose, "verdicts"));
  check_refused("simulate shear.toml -o none.h5 --verdict always",
                {"--verdict: expected one of \"failed\", \"every\", \"never\", met \"always\""});
}
