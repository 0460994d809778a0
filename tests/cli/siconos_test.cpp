// SPDX-License-Identifier: GPL-3.0-or-later
// Texts of Siconos, and packings as text, wherever their HDF5 and CSV counterparts are read.
#include "../support/fclib_files.hpp"
#include "formats/contact_problem/siconos_dat.hpp"
#include "session.hpp"

#include <sstream>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// The same problem as text and as HDF5.
struct ProblemSession : Session {
  ProblemSession() {
    const GlobalFrictionProblem global = random_bodies_problem(4, 12, 20);
    file("global.dat", siconos_text({global, {}, {}, {}}, "test"));
    file("global.hdf5", raw_global(global).bytes());
    const LocalFrictionProblem local = reduce(global);
    file("local.dat", siconos_text({local, {}, {}, {}}, "test"));
    file("local.hdf5", raw_local(local).bytes());
  }
};

std::string without_seconds(const std::string& report) {
  std::string text, line;
  for (std::istringstream lines(report); std::getline(lines, line);)
    if (!line.starts_with("seconds")) text += line + "\n";
  return text;
}

}  // namespace

TEST_CASE_FIXTURE(ProblemSession, "siconos: solve, sweep, inspect and optimum answer as for the same problem in HDF5") {
  for (const std::string name : {"global", "local"})
    CHECK(without_seconds(answer("solve " + name + ".dat")) == without_seconds(answer("solve " + name + ".hdf5")));
  for (const std::string verb :
       {"sweep FILE --subdomains metis:3 --epsilon 0,1 --eta 1,inf --csv -", "inspect FILE --subdomains metis:3",
        "optimum FILE --subdomains metis:3 --epsilon 1 --contacts all"})
    CHECK(answer(replaced(verb, "FILE", "global.dat")) == answer(replaced(verb, "FILE", "global.hdf5")));
  file("box.toml", "[problem]\nfile = \"global.dat\"\n[partition]\nmetis = 3\n");
  CHECK(table("sweep box.toml --epsilon 1").text(0, "spectral_radius") ==
        table("sweep global.hdf5 --subdomains metis:3 --epsilon 1").text(0, "spectral_radius"));
  check_refused("sweep local.dat --subdomains metis:3 --epsilon 1 --csv -", {"expected a global problem"});
}

TEST_CASE_FIXTURE(ProblemSession, "siconos: solve turns one format into the other, and says what is lost") {
  ended(0, "solve global.hdf5 -o text.dat", {"only the problem"});
  answer("solve text.dat -o back.hdf5");
  const auto problem = [&](const std::string& name) {
    return std::get<GlobalFrictionProblem>(read_contact_problem(path(name)).problem);
  };
  CHECK((problem("back.hdf5").h - problem("global.hdf5").h).norm() == 0);
  CHECK((problem("back.hdf5").mass - problem("global.hdf5").mass).norm() == 0);
  CHECK(problem("back.hdf5").f == problem("global.hdf5").f);
  check_refused("solve global.hdf5 -o text.dat", {"text.dat", "--force"});
  check_refused("solve text.dat -o text.dat --force", {"text.dat"});
}

TEST_CASE_FIXTURE(ProblemSession, "siconos: a folder of problems, and what is refused by name") {
  file("problems/a.dat", read("local.dat"));
  file("problems/b.hdf5", read("global.hdf5"));
  const CsvTable rows = table("solve problems");
  REQUIRE(rows.rows.size() == 2);
  CHECK(rows.text(0, "problem") == "a.dat");
  CHECK(rows.text(0, "status") == "converged");
  file("space.dat", "3\n1\n0\n3\n3\n3\t3\n1 0 0\n0 1 0\n0 0 1\n-1 0 0\n0.5\n");
  const std::string sweep = "sweep space.dat --subdomains metis:2 --epsilon 1 --csv -";
  check_refused(sweep, {"space.dat: expected a global problem"});
  CHECK(run("solve space.dat").exit_code == 0);  // r = (1, 0, 0)
  file("rolling.dat", "5\n1\n0\n5\n5\n5\t5\n1 0 0 0 0\n");
  check_refused("solve rolling.dat", {"rolling.dat", "not supported: rolling friction (1 contacts"});
  file("notes.pdf", "no problem\n");
  check_refused("sweep notes.pdf --epsilon 1 --csv -", {"notes.pdf: expected a case file", ".dat"});
}

TEST_CASE_FIXTURE(Session, "text packings are read as CSV is, and one whose z differs is in space") {
  file("p.csv", "x,y,radius\n0,0,0.5\n1,0,0.5\n2,0,0.5\n1,1,0.5\n");
  file("p.txt", "# x y r\n0 0 0.5\n1 0 0.5\n2 0 0.5\n1 1 0.5\n");
  file("q.dat", "#format x_y_z_r\n0 0 3 0.5\n1 0 3 0.5\n2 0 3 0.5\n1 1 3 0.5\n");
  file("case.toml", case_text("p.txt", "2, 1"));
  file("space.txt", "0 0 0 0.5\n0 0 1 0.5\n0 1 0 0.5\n");
  file("space.csv", "x,y,radius,z\n0,0,0.5,0\n0,0,0.5,1\n0,1,0.5,0\n");
  const auto radius = [&](const std::string& name) {
    return table("sweep " + name + " --epsilon 1 --subdomains 2x1").text(0, "spectral_radius");
  };
  const std::string expected = radius("p.csv");
  CHECK(std::stod(expected) > 0);
  for (const std::string name : {"p.txt", "q.dat", "case.toml"}) CHECK(radius(name) == expected);
  file("broken.txt", "0 0 0 0.5\n1 0 0.1.2 0.5\n");
  check_refused("inspect broken.txt", {"broken.txt:2: z:", "0.1.2"});
  CHECK(answer("generate space.csv -o -").ends_with("x,y,z,radius\n0,0,0,0.5\n0,0,1,0.5\n0,1,0,0.5\n"));
  answer("generate space.txt -o space.h5");
  for (const std::string name : {"space.txt", "space.csv", "space.h5"}) {
    const CsvTable links = table("network " + name + " --prescribed 0:1:0:0");
    REQUIRE(links.rows.size() == 2);
    CHECK(links.text(0, "grain_b") == "1");
    CHECK(links.text(1, "grain_b") == "2");
  }
}
