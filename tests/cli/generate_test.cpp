// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd generate: packings out of generators and cases, and what it refuses.
#include "session.hpp"

#include <filesystem>

using namespace nscdd::testing;

namespace {

// The lines that are no remarks.
std::string without_remarks(const std::string& text) { return text.substr(text.find("\nx,y,radius") + 1); }

}  // namespace

TEST_CASE_FIXTURE(Session, "generate: a generator at its defaults, with settings, and to standard output") {
  CHECK(answer("generate strip -o strip.csv") == "");
  CHECK(read_table(without_remarks(read("strip.csv"))).rows.size() == 4);
  answer("generate deposit --set packing.grains=50 --set packing.seed=3 -o bed.csv");
  const std::string printed = answer("generate deposit --set packing.grains=50 --set packing.seed=3 -o -");
  CHECK(read_table(without_remarks(printed)).rows.size() == 50);
  CHECK(without_remarks(printed) == without_remarks(read("bed.csv")));
  CHECK(printed.rfind("# program: nscdd ", 0) == 0);
  for (const std::string& part : Texts{"#   GSL ", "# command_line: nscdd generate deposit", "#   grains = 50\n",
                                       "#   seed = 3\n", "#   distribution = \"uniform\"\n"}) {
    CAPTURE(part);
    CHECK(contains(printed, part));
  }
  CHECK(content_of(folder.path()).size() == 2);
}

TEST_CASE_FIXTURE(Session, "generate: a case by name and by file, masses where it has them") {
  answer("generate disks12 -o disks.csv");
  const CsvTable disks = read_table(without_remarks(read("disks.csv")));
  REQUIRE(disks.rows.size() == 12);
  CHECK(disks.number(11, "mass") == 1);
  file("own.toml", case_text("hexagonal\ncolumns = 5\nrows = 4\nvacancies = 0.25"));
  const CsvTable own = read_table(without_remarks(answer("generate own.toml -o -")));
  CHECK(own.rows.size() == 15);
  CHECK(own.columns == Texts{"x", "y", "radius"});
  const CsvTable heavy = read_table(without_remarks(answer("generate own.toml --set masses.density=4 -o -")));
  CHECK(heavy.number(0, "mass") > 3.14);
}

TEST_CASE("generate: equal commands give equal bytes, and seeds differ") {
  const Session first, second;
  for (const std::string& name : Texts{"a.csv", "a.h5", "a.hdf5"}) {
    const std::string line = "generate deposit --set packing.grains=200 -o " + name;
    first.answer(line);
    second.answer(line);
    CHECK(first.read(name) == second.read(name));
  }
  first.answer("generate deposit --set packing.grains=200 --set packing.seed=2 -o b.csv");
  CHECK(without_remarks(first.read("b.csv")) != without_remarks(first.read("a.csv")));
}

TEST_CASE_FIXTURE(Session, "generate: CSV and HDF5 are the same packing wherever one is read") {
  answer("generate deposit --set packing.grains=60 -o bed.csv");
  answer("generate deposit --set packing.grains=60 -o bed.h5");
  const std::string options = " --subdomains 2x1 --epsilon 0,1 --csv -";
  CHECK(answer("sweep bed.csv" + options) == answer("sweep bed.h5" + options));
  answer("generate bed.h5 -o again.csv");
  CHECK(without_remarks(read("again.csv")) == without_remarks(read("bed.csv")));
  file("cases/bed.toml", case_text("../bed.h5", "2, 1"));
  CHECK(answer("sweep cases/bed.toml --epsilon 0,1 --csv -") == answer("sweep bed.h5" + options));
  CHECK(answer("inspect bed.h5") == answer("inspect bed.csv"));
}

TEST_CASE_FIXTURE(Session, "generate: the known cases of disorder are there, and their active sets work") {
  for (const std::string& name : Texts{"deposit", "vacancies"}) {
    CAPTURE(name);
    const CsvTable row = table("sweep " + name + " --contacts active --epsilon 0 --eta 1");
    CHECK(row.text(0, "converged") == "true");
    CHECK(row.number(0, "active_contacts") > 0);
  }
}

TEST_CASE_FIXTURE(Session, "generate: what makes no packing is refused") {
  file("bad.toml", case_text("deposit\ndistribution = \"gauss\""));
  check_refused("generate", {"SPEC"});
  check_refused("generate deposit", {"--output"});
  check_refused("generate deposit strip -o a.csv", {"strip"});
  check_refused("generate heap -o a.csv", {"heap", "disks4"});
  check_refused("generate bad.toml -o a.csv", {"bad.toml:3: packing.distribution", "lognormal", "gauss"});
  const auto setting = [&](const std::string& text, std::initializer_list<std::string> parts) {
    check_refused("generate deposit -o a.csv --set " + text, parts);
    check_refused("generate deposit -o a.h5 --set " + text, parts);
  };
  setting("packing.grains", {"KEY=VALUE", "packing.grains"});
  setting("packing.grains=0", {"packing.grains"});
  setting("packing.grains=1e3", {"packing.grains", "integer"});
  setting("packing.grains=100000000", {"packing.grains", "10000000"});
  setting("packing.columns=3", {"packing.columns", "packing.distribution"});
  setting("packing.radius_min=-1", {"packing.radius_min", "-1"});
  setting("packing.radius_min=0.3", {"packing.radius_min", "radius_max"});
  setting("packing.width=0.3", {"packing.width"});
  setting("packing.width=1e9", {"packing.width"});
  setting("packing.seed=-1", {"packing.seed"});
  setting("packing.distribution=gauss", {"packing.distribution", "two_sizes"});
  setting("partition.grid=2,2", {"--set", "packing.KEY"});
  check_refused("generate hexagonal -o a.csv --set packing.vacancies=1", {"packing.vacancies"});
  check_refused("generate hexagonal -o a.csv --set packing.disorder=-0.1", {"packing.disorder"});
}

TEST_CASE_FIXTURE(Session, "generate: an output that is no packing file, exists, or cannot be written is refused") {
  for (const std::string& name : Texts{"a.txt", "a", "a.h5.gz", "a.CSV"})
    check_refused("generate strip -o " + name, {name, ".csv", ".h5"});
  file("old.csv", "precious");
  file("old.h5", "precious");
  check_refused("generate strip -o old.csv", {"old.csv: exists already", "--force"});
  check_refused("generate strip -o old.h5", {"old.h5: exists already", "--force"});
  check_refused("generate deposit --set packing.width=0.1 --force -o old.h5", {"packing.width"});
  check_refused("generate strip -o missing/a.csv", {"missing"});
  fs::create_directory(folder / "folder.csv");
  check_refused("generate strip --force -o folder.csv", {"folder.csv"});
  fs::create_symlink("/dev/full", folder / "full.csv");
  fs::create_symlink("/dev/full", folder / "full.h5");
  check_refused("generate strip -o full.csv", {"full.csv", "No space left"});
  check_refused("generate strip -o full.h5", {"full.h5", "No space left"});
  answer("generate strip --force -o old.csv");
  CHECK(read_table(without_remarks(read("old.csv"))).rows.size() == 4);
}

TEST_CASE_FIXTURE(Session, "generate: a disk that fills up leaves nothing behind") {
  for (const std::string& name : Texts{"big.csv", "big.h5"})
    check_refused("generate strip --set packing.grains=100000 -o " + name, {name}, {.largest_file = 100'000});
}

TEST_CASE_FIXTURE(Session, "generate: a killed run leaves what was there") {
  file("bed.h5", "precious");
  ended(128 + 9, "generate deposit --set packing.grains=3000 -o bed.h5 --force", {},
        {.signal_at = SignalAt{"bed.h5.partial"}});
  CHECK(read("bed.h5") == "precious");
  check_refused("generate strip -o bed.h5", {"bed.h5"});
  answer("generate strip -o bed.h5 --force");
  CHECK(content_of(folder.path()).size() == 1);
}

TEST_CASE_FIXTURE(Session, "generate: a progress bar where standard error is a terminal") {
  const Outcome outcome =
      ended(0, "generate deposit --set packing.grains=1000000 -o bed.h5", {"generate ["}, {.on_terminal = true});
  CHECK(outcome.standard_output == "");
}

TEST_CASE_FIXTURE(Session, "packing file: HDF5 that is none is refused wherever a packing is read") {
  file("text.h5", "x,y,radius\n0,0,1\n");
  file("own.toml", case_text("text.h5"));
  answer("sweep disks4 --epsilon 1 --csv a.csv --hdf5 sweep.h5");
  for (const std::string& verb : Texts{"inspect ", "network ", "generate -o b.csv ", "sweep --epsilon 1 --csv - "}) {
    check_refused(verb + "text.h5", {"text.h5", "HDF5"});
    check_refused(verb + "sweep.h5", {"sweep.h5: packing: expected a group"});
    check_refused(verb + "own.toml", {"own.toml:2: packing.file", "text.h5", "HDF5"});
    check_refused(verb + "missing.h5", {"missing.h5"});
  }
}

TEST_CASE_FIXTURE(Session, "inspect: geometry of four disks known by hand, and the sizes as a table") {
  file("square.csv", "x,y,radius\n0,0,1\n2,0,1\n0,2,1\n2,2,1\n9,1,0.5\n");
  const std::string report = answer("inspect square.csv --histogram sizes.csv");
  // four unit disks and one of radius 1/2 in a box 10.5 x 4
  CHECK(contains(report, "\nsolid fraction       0.317899 "));  // 4.25 pi / 42
  CHECK(contains(report, "\nrattlers             1 "));
  CHECK(contains(report, "without them  2\n"));
  CHECK(contains(report, "  4  ########################################\n"));
  const CsvTable sizes = csv("sizes.csv");
  REQUIRE(sizes.rows.size() == 10);
  CHECK(sizes.text(0, "grains") == "1");
  CHECK(sizes.text(9, "grains") == "4");
  CHECK(sizes.number(0, "radius_from") == 0.5);
  CHECK(sizes.number(9, "radius_to") == 1);
  CHECK(sizes.number(9, "number_fraction") == 0.8);
  CHECK(sizes.number(9, "area_fraction") > 0.94);
  check_refused("inspect square.csv --histogram sizes.csv", {"sizes.csv: exists already", "--force"});
  check_refused("inspect square.csv --histogram -", {"--histogram"});
  answer("inspect square.csv --histogram sizes.csv --force");
}

TEST_CASE_FIXTURE(Session, "inspect: ranks of a large network only where asked for") {
  const std::string lattice = "inspect hexagonal --set packing.columns=190 --set packing.rows=190";
  const std::string without = answer(lattice);
  CHECK(contains(without, "not computed, nor ranks (more than 100000 contacts; --ranks asks for them)"));
  const std::string with = answer(lattice + " --ranks");
  CHECK(!contains(with, "not computed"));
  const auto whole = [](const std::string& report) {
    const auto start = report.find("\nwhole ") + 7;
    return words(report.substr(start, report.find('\n', start) - start));
  };
  CHECK(whole(without) == Texts{"36100", "107541", "-", "-", "-"});
  CHECK(whole(with) == Texts{"36100", "107541", "72197", "3", "35344"});
}
