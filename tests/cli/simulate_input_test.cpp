// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: what is refused, when, by which name; files of others; what a restart leaves to be read.
#include "../support/moving_case.hpp"
#include "session.hpp"
#include <nscdd/core/version.hpp>
#include <nscdd/io/trajectory.hpp>

#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>

using namespace nscdd::testing;

namespace {

const std::string generator = "generator = \"deposit\"\ngrains = 120\nwidth = 3.0\nradius_max = 0.198\n";

struct MovingSession : Session {
  MovingSession() { file("shear.toml", moving_case()); }
};

std::string provenance_of(const Session& session, const std::string& file, const std::string& key) {
  for (const auto& [name, text] : nscdd::read_trajectory_header((session.folder / file).string()).provenance)
    if (name == key) return text;
  return "";
}

}  // namespace

TEST_CASE("simulate: files of others beside the trajectory are neither replaced nor removed") {
  const MovingSession session;
  for (const std::string& name : Texts{"run.h5.next", "run.h5.previous", "run.h5.lock"}) {
    session.file(name, "mine");
    check_refused(session, "simulate shear.toml --steps 2 -o run.h5", {name, "move it away"});
    std::filesystem::remove(session.folder / name);
  }
  answer(session, "simulate shear.toml --steps 2 -o run.h5");
  session.file("run.h5.next", "mine");
  check_refused(session, "simulate shear.toml --steps 3 -o run.h5 --restart",
                {"run.h5.next", "move it away"});
  check_refused(session, "simulate shear.toml --steps 3 -o run.h5 --force", {"run.h5.next", "move it away"});
}

TEST_CASE("simulate: what a killed run leaves beside the trajectory is its own") {
  const MovingSession session;
  RunOptions options;
  options.kill_when = [&] { return session.has("run.h5") && session.has("run.h5.next"); };
  REQUIRE(
      session.run(words("simulate shear.toml --steps 4000 --save-every 1000 -o run.h5"), options).exit_code ==
      128 + SIGKILL);
  REQUIRE(session.has("run.h5.lock"));
  session.file("run.h5.next", "damaged");
  session.file("run.h5.previous", "damaged");
  answer(session, "simulate shear.toml --steps 4 -o run.h5 --force");
  CHECK_FALSE(session.has("run.h5.lock"));
  CHECK_FALSE(session.has("run.h5.next"));
  CHECK_FALSE(session.has("run.h5.previous"));
}
