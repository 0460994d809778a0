// SPDX-License-Identifier: GPL-3.0-or-later
// A run as one VTKHDF file: the same pictures, number by number, as VTK reads from the .vtp files of the run.
#include "session.hpp"

#include <set>
#include <sstream>

using namespace nscdd::testing;

namespace {

struct VtkhdfSession : Session {
  VtkhdfSession() { file("box.toml", small_moving_case()); }
};

constexpr int not_known = 77;  // exit code of read_vtk.py where VTK is too old for the file

int read_by(const std::string& script, const std::string& file) {
  return run_script("unit/" + script, {file}, file + ".txt");
}

// A step as a script has it: its time and the lines of its arrays, which come in any order.
struct Picture {
  std::string time;
  std::set<std::string> lines;
  bool operator==(const Picture&) const = default;
};

std::vector<Picture> pictures_in(const std::filesystem::path& file) {
  std::vector<Picture> pictures;
  std::istringstream lines(read_file(file.string() + ".txt"));
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("file ", 0) == 0)
      pictures.push_back({line.substr(line.rfind(' ') + 1), {}});
    else
      pictures.back().lines.insert(line);
  return pictures;
}

std::vector<Picture> read(const Session& session, const std::string& script, const std::string& name) {
  const std::filesystem::path file = session.folder / name;
  REQUIRE_MESSAGE(read_by(script, file) == 0, script << " does not read " << name);
  return pictures_in(file);
}

// Also by VTK itself, where it is recent enough.
void check_same_pictures(const Session& session, const std::string& collection, const std::string& file,
                         std::size_t steps, std::size_t lines) {
  const std::vector<Picture> expected = read(session, "read_vtk.py", collection);
  REQUIRE(expected.size() == steps);
  CHECK(expected[0].lines.size() == lines);
  CHECK(read(session, "read_vtkhdf.py", file) == expected);
  const int status = read_by("read_vtk.py", session.folder / file);
  REQUIRE((status == 0 || status == not_known));
  if (status == 0) CHECK(pictures_in(session.folder / file) == expected);
}

}  // namespace

TEST_CASE_FIXTURE(VtkhdfSession, "export --vtkhdf: one file has every step as its .vtp file has it") {
  answer("simulate box.toml --subdomains 2x1 -o run.h5");
  answer("export run.h5 --vtk all");
  CHECK(answer("export run.h5 --vtkhdf run.vtkhdf") == "run.vtkhdf: 13 steps (0:12), 54 disks\n");
  check_same_pictures(*this, "all/run.pvd", "run.vtkhdf", 13, 22);

  answer("export run.h5 --vtk some --steps 3:12:3");
  answer("export run.h5 --vtkhdf some.hdf --steps 3:12:3");
  std::filesystem::rename(folder / "some.hdf", folder / "some.vtkhdf");
  check_same_pictures(*this, "some/run.pvd", "some.vtkhdf", 4, 22);
  CHECK_FALSE(has("run.vtkhdf.partial"));
}

TEST_CASE_FIXTURE(Session, "export --vtkhdf: steps without contacts in between, and switched models") {
  // A grain that falls, bounces and falls again: contacts come, go and come.
  file("ball.csv", "x,y,radius\n0,1.2,0.5\n");
  file("ball.toml", case_text("ball.csv", "1, 1",
                              "[masses]\ndensity = 1000\n[interaction]\nfriction = 0\nrestitution = 0.9\n"
                              "[dynamics]\nstep = 0.05\nsteps = 40\n") +
                        line_text("floor", "[-1, 0]", "[1, 0]"));
  answer("simulate ball.toml -o ball.h5");
  answer("export ball.h5 --vtk ball");
  answer("export ball.h5 --vtkhdf ball.vtkhdf");
  check_same_pictures(*this, "ball/ball.pvd", "ball.vtkhdf", 41, 22);
  std::string contacts;
  for (const Picture& picture : pictures_in(folder / "ball/ball.pvd"))
    contacts += picture.lines.contains("lines/offsets 0 2") ? "1" : "0";
  CHECK(contains(contacts, "01"));
  CHECK(contains(contacts, "10"));

  file("box.toml", replaced(moving_case(), "[solver]", "[solver]\nswitch = \"linear\"\nswitch_after = 5"));
  answer("simulate box.toml --subdomains 2x2 --algorithm generic --steps 4 -o run.h5");
  answer("export run.h5 --vtk all");
  answer("export run.h5 --vtkhdf run.vtkhdf");
  check_same_pictures(*this, "all/run.pvd", "run.vtkhdf", 5, 27);
}

TEST_CASE_FIXTURE(VtkhdfSession, "export --vtkhdf: whole or absent, and nothing is replaced in silence") {
  file("old.vtkhdf", "precious");
  answer("simulate box.toml --steps 3 -o run.h5");
  check_refused("export run.h5 --vtkhdf old.vtkhdf", {"old.vtkhdf", "exists already"});
  check_refused("export run.h5 --vtkhdf run.h5 --force", {"would be lost"});
  check_refused("export run.h5 --vtkhdf new.vtp", {"new.vtp", ".vtkhdf"});
  check_refused("export run.h5 --vtkhdf -", {"-: expected the name of a file that ends in .vtkhdf"});
  check_refused("export run.h5 --vtkhdf none/new.vtkhdf", {"there is no folder none"});
  check_refused("export run.h5 --vtkhdf new.vtkhdf --vtk folder", {"--vtk"});
  check_refused("export run.h5 --vtkhdf new.vtkhdf --fclib 1 -o p.hdf5", {"expected one of", "several"});
  check_refused("export run.h5 --vtkhdf new.vtkhdf --steps 7", {"--steps", "keeps (0:3), met none"});
  check_refused("export run.h5 --vtkhdf new.vtkhdf", {"new.vtkhdf", "cannot be written"}, {.largest_file = 6000});

  answer("export run.h5 --vtkhdf old.vtkhdf --force");
  answer("export run.h5 --vtkhdf again.vtkhdf");
  CHECK(read("old.vtkhdf") == read("again.vtkhdf"));  // equal runs give equal bytes
}
