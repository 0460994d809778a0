// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: links to a trajectory, names beside it, the table that a restart goes on with.
#include "../support/moving_case.hpp"
#include "session.hpp"
#include <nscdd/io/trajectory.hpp>

#include <doctest/doctest.h>

#include <filesystem>

using namespace nscdd::testing;
namespace fs = std::filesystem;

namespace {

struct MovingSession : Session {
  MovingSession() { file("shear.toml", moving_case()); }
  std::string bytes(const std::string& name) const { return nscdd::read_text((folder / name).string()); }
  nscdd::Index last_step(const std::string& name) const {
    return nscdd::read_last_step((folder / name).string()).state.step;
  }
};

}  // namespace

TEST_CASE("simulate: through a symbolic link the trajectory it leads to is written, whole, and stays linked") {
  const MovingSession session;
  fs::create_directory(session.folder / "store");
  answer(session, "simulate shear.toml --steps 2 -o store/real.h5");
  fs::create_symlink("store/real.h5", session.folder / "first.h5");
  fs::create_symlink("first.h5", session.folder / "link.h5");
  answer(session, "simulate shear.toml --steps 4 --restart -o link.h5");
  CHECK(fs::is_symlink(session.folder / "link.h5"));
  CHECK(session.last_step("store/real.h5") == 4);
  answer(session, "simulate shear.toml --steps 4 -o plain.h5");
  CHECK(nscdd::read_last_step((session.folder / "store/real.h5").string()).state.x ==
        nscdd::read_last_step((session.folder / "plain.h5").string()).state.x);
  session.file("store/real.h5.next", "mine");
  check_refused(session, "simulate shear.toml --steps 5 --restart -o link.h5",
                {"store/real.h5.next", "move it away"});
}

TEST_CASE("simulate: a second name of a trajectory keeps the version it has") {
  const MovingSession session;
  answer(session, "simulate shear.toml --steps 2 -o run.h5");
  fs::create_hard_link(session.folder / "run.h5", session.folder / "kept.h5");
  const std::string before = session.bytes("kept.h5");
  answer(session, "simulate shear.toml --steps 5 --restart -o run.h5");
  CHECK(session.bytes("kept.h5") == before);
  CHECK(session.last_step("run.h5") == 5);
}
