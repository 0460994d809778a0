// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd export --operators: what SciPy reads is what the formulas say, and has the radii of nscdd sweep.
#include "session.hpp"

#include <cmath>
#include <csignal>
#include <map>
#include <sstream>

using namespace nscdd::testing;

namespace {

// Checks of tests/cli/read_operators.py, and the radii that it prints.
std::map<std::string, double> read_by_scipy(const Session& session, const std::string& folder,
                                            const std::string& epsilon = "") {
  const std::string path = session.path(folder);
  const Texts arguments = epsilon.empty() ? Texts{path} : Texts{path, epsilon};
  REQUIRE_MESSAGE(run_script("cli/read_operators.py", arguments, path + ".txt") == 0,
                  "SciPy (Debian package python3-scipy) does not find what it should");
  std::map<std::string, double> radii;
  std::istringstream lines(session.read(folder + ".txt"));
  std::string name;
  for (double value = 0; lines >> name >> value;) radii[name] = value;
  return radii;
}

// An export and the sweep of the same point.
void compare(const std::string& options, std::initializer_list<std::string> solvers) {
  CAPTURE(options);
  const Session session;
  session.file("fcc.toml", case_text("fcc\ncolumns = 4\nrows = 3\nlayers = 3", "2, 1, 2"));
  session.answer("export " + options + " --operators all");
  const CsvTable swept = session.table("sweep " + options);
  const double radius = swept.number(0, "spectral_radius");
  const auto found = read_by_scipy(session, "all");
  for (const std::string& solver : solvers) {
    REQUIRE(found.contains(solver));
    CHECK(std::abs(found.at(solver) - radius) < 1e-9 * std::max(1.0, radius));
  }
}

}  // namespace

TEST_CASE("export --operators: SciPy finds the radius of the sweep in the files") {
  compare("disks4 --epsilon 0", {"dense", "pencil"});
  compare("disks8 --epsilon 1 --eta 0.3", {"dense", "pencil"});
  compare("hexagonal --epsilon 1e-2 --eta inf", {"dense", "pencil", "arpack"});
  compare("hexagonal --subdomains 3x2 --epsilon 0.1W --eta 10W", {"dense", "pencil", "arpack"});
  compare("hexagonal --subdomains 2x2 --epsilon 1 --eta 0.01", {"dense", "pencil", "arpack"});  // it diverges
  compare("hexagonal --epsilon 1e-2 --eta 0.3 --relaxation 0.7", {"dense", "pencil", "arpack"});
  compare("fcc.toml --epsilon 1e-2 --eta 0.3", {"dense", "pencil", "arpack"});  // spheres
  compare("fcc.toml --epsilon 0 --contacts unilateral --set loads.compression=1,0.3,0.1", {"dense", "pencil"});
}

TEST_CASE("export --operators: contacts of Stage 1 may be some, in the rigid limit, with unit eigenvalues") {
  compare("disks8 --epsilon 0 --eta 0.1 --contacts active", {"dense", "pencil"});
  compare("hexagonal --set loads.compression=1,0.3 --epsilon 0 --contacts unilateral", {"dense", "pencil"});
  compare("hexagonal --epsilon 0", {"dense", "pencil"});
}

TEST_CASE_FIXTURE(Session, "export --operators: a contact problem has links of friction and three rows per body") {
  file("box.toml", replaced(replaced(moving_case(), "grains = 120", "grains = 30"), "steps = 20", "steps = 12"));
  answer("simulate box.toml --algorithm nlgs -o run.h5");
  answer("export run.h5 --fclib 12 -o p.hdf5");
  const std::string options = "p.hdf5 --subdomains metis:3 --epsilon 0.1 --eta 1";
  answer("export " + options + " --operators all");
  const double radius = table("sweep " + options).number(0, "spectral_radius");
  CHECK(std::abs(read_by_scipy(*this, "all").at("pencil") - radius) < 1e-9);
  CHECK(contains(read("all/manifest.toml"), "dofs_per_grain = 3"));
}

TEST_CASE_FIXTURE(Session, "export --operators: the sparse files alone are enough for ARPACK") {
  const std::string options = "hexagonal --set packing.columns=30 --set packing.rows=30 --subdomains 3x3";
  answer("export " + options + " --operators sparse --sparse-only");
  const double radius = table("sweep " + options + " --epsilon 0.1").number(0, "spectral_radius");
  const auto found = read_by_scipy(*this, "sparse", "0.1");
  CHECK(std::abs(found.at("sparse") - radius) < 1e-8);
  CHECK_FALSE(found.contains("dense"));
  CHECK(found.at("operators") == 4 + 9 * 5);
}

TEST_CASE_FIXTURE(Session, "export --operators: equal bytes again, and no operators of an empty interface") {
  for (const std::string place : {"a", "b"}) answer("export disks8 --epsilon 1 --operators " + place + "/x");
  for (const std::string name : {"M.mtx", "P.mtx", "B.mtx", "A_0.mtx"})
    CHECK(read("a/x/" + name) == read("b/x/" + name));
  ended(0, "export disks4 --subdomains 1x1 --epsilon 1 --operators one", {"the interface is empty"});
  CHECK_FALSE(has("one/X.mtx"));
  CHECK_FALSE(has("one/A_0.mtx"));
  CHECK(read_by_scipy(*this, "one").at("operators") == 3 + 4);
}

TEST_CASE_FIXTURE(Session, "export --operators: nothing is overwritten, and what is refused leaves nothing") {
  file("notes/mine.txt", "precious");
  file("p.csv", row_of_three());
  answer("export disks4 --epsilon 1 --operators all");
  check_refused("export disks4 --epsilon 1 --operators all", {"all", "--force"});
  check_refused("export disks4 --epsilon 1 --operators notes", {"notes", "--force"});
  check_refused("export disks4 --epsilon 1 --operators p.csv", {"p.csv", "expected a folder"});
  check_refused("export disks4 --operators new", {"--epsilon", "--sparse-only"});
  check_refused("export disks4 --epsilon 0,1 --operators new", {"--epsilon", "one number"});
  check_refused("export disks4 --epsilon 1 --eta 0 --operators new", {"eta", "number > 0"});
  check_refused("export disks4 --epsilon 1 --relaxation 0 --operators new", {"--relaxation", "> 0"});
  check_refused("export disks4 --sparse-only --relaxation 0.5 --operators new", {"--relaxation"});
  check_refused("export disks4 --epsilon 1 --sparse-only --operators new", {"--epsilon", "--sparse-only"});
  check_refused("export disks4 --epsilon 1 --vtk v --operators new", {"--vtk"});
  check_refused("export disks4 --epsilon 1 --fclib 1 -o p.hdf5 --operators new", {"several"});
  check_refused("export disks4 --subdomains 2x1 --vtk v", {"--subdomains", "--operators"});
  check_refused("export p.csv --epsilon 1 --contacts active --operators new",
                {"active contacts: expected a prescribed velocity"});
  check_refused("export disks4 --epsilon 1 --operators new --memory-limit 1e-6", {"1e-06 GiB"});
  const std::string large = "export hexagonal --set packing.columns=60 --set packing.rows=60 --subdomains 30x30 ";
  check_refused(large + "--epsilon 1 --operators new --memory-limit 4", {"interface unknowns", "--sparse-only"});
  // A folder of another case, exported over: its manifest is the new one, the case file is no output.
  const std::string before = read("all/manifest.toml");
  answer("export disks8 --epsilon 1 --operators all --force");
  CHECK(read("all/manifest.toml") != before);
  answer("generate deposit --set packing.grains=20 -o all/operators.h5 --force");
  check_refused("export all/operators.h5 --epsilon 1 --operators all --force", {"all/operators.h5"});
}

TEST_CASE_FIXTURE(Session, "export --operators: an interrupt or a full disk takes back what was written, and no more") {
  const std::string line = "export hexagonal --subdomains 6x6 --epsilon 1 --eta 1 --operators new";
  check_refused(line, {"new", ".mtx"}, {.largest_file = 20000});
  ended(130, line, {"new: interrupted"}, {.signal_at = SignalAt{"P.mtx*", 1, SIGINT}});
  CHECK_FALSE(has("new"));
  answer(line);
  CHECK(has("new/B.mtx"));
  const std::string before = read("new/manifest.toml") + read("new/M.mtx");
  ended(130, line + " --set packing.rows=9 --force", {"new: interrupted"},
        {.signal_at = SignalAt{"P.mtx*", 1, SIGINT}});
  CHECK(read("new/manifest.toml") + read("new/M.mtx") == before);
  CHECK_FALSE(has("new/M.mtx.partial"));
}

TEST_CASE_FIXTURE(Session, "export --operators: refused with 3/5 of the memory it takes, done with 7/5") {
  const std::string line =
      "export hexagonal --set packing.columns=45 --set packing.rows=45 --subdomains 9x9 --epsilon 1 --eta 1 "
      "--operators all --force --memory-limit ";
  const Outcome outcome = run(line + "4");
  REQUIRE(outcome.exit_code == 0);
  const double taken = static_cast<double>(outcome.peak_memory) / (1 << 30);
  check_refused(line + std::to_string(0.6 * taken), {"--memory-limit"});
  CHECK(run(line + std::to_string(1.4 * taken)).exit_code == 0);
}
