// SPDX-License-Identifier: GPL-3.0-or-later
// Steps that are too long, as users meet them: one grain would pass through another between two searches for contacts.
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"

#include <cmath>

using namespace nscdd::testing;

namespace {

// A disk that flies at another with 19 m/s, 2 mm before it.
std::string shot(const std::string& packing, const std::string& more = "") {
  return case_text(
      packing, "1, 1",
      "[masses]\nmodel = \"given\"\n[interaction]\nlaw = \"frictionless\"\n[dynamics]\nstep = 0.005\nsteps = 3\n"
      "gravity = [0, 0]\n[[prescribed]]\ngrain = 0\nvelocity = [19.0, 0.0]\n" +
          more);
}

struct ShotSession : Session {
  ShotSession() {
    file("two.csv", "x,y,radius,mass\n0,0,0.01,1\n0.022,0,0.01,1\n");
    file("shot.toml", shot("two.csv"));
  }
};

std::string safe_step(const std::string& error) {
  const std::string before = "dynamics.step: expected at most ";
  const std::size_t found = error.find(before);
  REQUIRE(found != std::string::npos);
  const std::size_t start = found + before.size();
  return error.substr(start, error.find(' ', start) - start);
}

nscdd::GranularState last_state(const Session& session, const std::string& file) {
  return nscdd::read_last_step(session.path(file)).state;
}

std::vector<double> velocities(const Session& session, const std::string& file) {
  const auto state = last_state(session, file);
  return {state.velocity_x[0], state.velocity_x[1]};
}

}  // namespace

TEST_CASE_FIXTURE(ShotSession, "simulate: a step in which a disk flies through another is refused, with a safe one") {
  check_refused("simulate shot.toml -o shot.h5",
                {"shot.toml:10: dynamics.step: expected at most 0.000684 s, met 0.005 s, which is too long",
                 "disk 0 and disk 1 moved by 0.0475 m", "4.75 of the smaller radius"});
  CHECK_FALSE(has("shot.h5"));
  for (const std::string step : {"0.02", "0.009", "0.005", "0.002", "0.001", "0.0008"}) {
    CAPTURE(step);
    const Outcome refused = ended(2, "simulate shot.toml -o shot.h5 --set dynamics.step=" + step);
    CHECK(safe_step(refused.standard_error) == "0.000684");
  }
  for (const std::string step : {"0.000684", "0.000677", "0.0005", "0.0001"}) {
    CAPTURE(step);
    answer("simulate shot.toml --force -o shot.h5 --set dynamics.steps=9 --set dynamics.step=" + step);
    for (const double v : velocities(*this, "shot.h5")) CHECK(v == doctest::Approx(9.5).epsilon(1e-9));
  }
}

TEST_CASE_FIXTURE(ShotSession, "every verb that moves the first step of a case refuses one that is too long") {
  file("settle.toml", "[packing]\nsettled = \"shot.toml\"\n[partition]\ngrid = [1, 1]\n");
  check_refused("sweep settle.toml --epsilon 1 --csv -", {"dynamics.step: expected at most 0.000684 s"});
  // Packings that begin with overlaps are told from steps that are too long.
  file("deep.csv", "x,y,radius,mass\n0,0,0.01,1\n0.0149,0,0.01,1\n");
  file("deep.toml", shot("deep.csv"));
  check_refused("simulate deep.toml -o deep.h5", {"disk 0 and disk 1: expected an overlap of at most 0.5"});
}

TEST_CASE_FIXTURE(Session, "simulate --restart: a disk that would be passed later ends the run as in one piece") {
  file("three.csv", "x,y,radius,mass\n0,0,0.01,1\n0.0201,0,0.01,0.05\n0.12,0,0.01,1\n");
  file("throw.toml", shot("three.csv"));
  const std::string asked = "simulate throw.toml --set interaction.restitution=1 --set dynamics.step=0.0003 --steps ";
  const Outcome whole =
      ended(1, asked + "30 -o whole.h5", {"dynamics.step: expected at most ", "disk 1 and disk 2 moved by"});
  const auto last = last_state(*this, "whole.h5");
  REQUIRE(last.step > 2);
  answer(asked + "2 -o parts.h5");
  ended(1, asked + "30 --restart -o parts.h5", {"disk 1 and disk 2 moved by"});
  const auto parts = last_state(*this, "parts.h5");
  CHECK(parts.step == last.step);
  CHECK(parts.x == last.x);
  CHECK(parts.velocity_x == last.velocity_x);
  // Elastic: the light disk gets 2/1.05 of 19 m/s, and hands on 2 x 0.05/1.05 of that.
  const std::string safe = safe_step(whole.standard_error);
  answer("simulate throw.toml --set interaction.restitution=1 --set dynamics.step=" + safe +
         " --set dynamics.steps=" + std::to_string(static_cast<int>(0.003 / std::stod(safe))) + " -o safe.h5");
  const auto state = last_state(*this, "safe.h5");
  CHECK(state.velocity_x[2] == doctest::Approx(2 * 0.05 / 1.05 * 38 / 1.05).epsilon(1e-9));
}

// Grains that a floor throws up and catches again: the floor changes its velocity at each step, in contact or not.
TEST_CASE_FIXTURE(Session, "step length: a shaken floor ends no run whose overlaps are small") {
  file("row.csv", "x,y,radius,mass\n0.1,0.01,0.01,1\n0.1201,0.01,0.01,1\n0.1402,0.01,0.01,1\n");
  for (const double step : {0.001, 0.0005})
    for (const double restitution : {0.0, 0.5}) {
      INFO("step = ", step, ", restitution = ", restitution);
      std::string motion;
      for (int k = 0; k < 20; ++k)  // 2 m/s at 25 Hz
        motion += (k > 0 ? ", [" : "[") + std::to_string(0.005 * k) + ", 0.0, " +
                  std::to_string(2 * std::sin(0.785398 * k)) + ", 0.0]";
      file("shaken.toml",
           case_text("row.csv", "1, 1", "[masses]\nmodel = \"given\"\n[interaction]\nfriction = 0.3\nrestitution = ") +
               std::to_string(restitution) + "\n[dynamics]\nstep = " + std::to_string(step) +
               "\nsteps = " + std::to_string(static_cast<int>(0.08 / step)) +
               "\ngravity = [0, -9.81]\n[[boundary]]\nname = \"floor\"\nshape = \"wall\"\n"
               "from = [-1, 0]\nto = [2, 0]\nmotion = [" +
               motion + "]\n");
      const Outcome outcome = ended(0, "simulate shaken.toml --force -o shaken.h5");
      CHECK(!contains(outcome.standard_error + outcome.standard_output, "too long"));
      CHECK(!contains(outcome.standard_error + outcome.standard_output, "expected an overlap"));
    }
}
