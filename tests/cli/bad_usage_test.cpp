// SPDX-License-Identifier: GPL-3.0-or-later
// Options that make no sense: refused with the option and what was expected of it.
#include "session.hpp"

using namespace nscdd::testing;

namespace {

void check_usage(const std::vector<std::string>& arguments, std::initializer_list<std::string> parts) {
  const Session session;
  session.file("mine.csv", row_of_three());
  session.check_refused(arguments, parts);
}

void check_option(const std::string& option, const std::string& value, std::initializer_list<std::string> parts) {
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv", "-", option, value}, parts);
}

// SPEC nonsense, the same for every quantity.
void check_spec(const std::string& option, const std::string& name) {
  for (const std::string& spec :
       Texts{"",       " ",      "abc",     "1,,2",    ",1",          "1,",
             "1;2",    "1 2",    "1:2",     "1:2:",    ":2:3",        "1:2:0",
             "1:2:-3", "1:2:1",  "1:2:2.5", "1:2:x",   "1:2:3:cubic", "1:2:3:linear:4",
             "0:1:3",  "-1:1:3", "1:inf:3", "nan:1:3", "1:2:1000001", "1:2:99999999999999999999",
             "1e999",  "0x10",   "1e",      "--",      "nan"}) {
    CAPTURE(spec);
    check_usage({"sweep", "disks4", "--csv", "-", "--epsilon=1", option + "=" + spec}, {name});
  }
}

}  // namespace

TEST_CASE("usage: no verb or an unknown verb or option") {
  check_usage({"dance"}, {});
  check_usage({"sweep"}, {"CASE"});
  check_usage({"sweep", "disks4", "--csv", "-"}, {"--epsilon"});
  check_usage({"sweep", "disks4", "--epsilon", "1"}, {"--csv"});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv", "-", "--speed", "9"}, {"--speed"});
  check_usage({"sweep", "disks4", "disks8", "--epsilon", "1", "--csv", "-"}, {"disks8"});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv"}, {"--csv"});
  check_usage({"inspect"}, {"CASE"});
  check_usage({"network"}, {"CASE"});
  check_usage({"optimum"}, {"CASE"});
  check_usage({"run"}, {"STUDY"});
  check_usage({"list", "everything"}, {"everything"});
  check_usage({"--speed"}, {});
}

TEST_CASE("usage: errors suggest the nearest name") {
  check_usage({"swep", "disks4"}, {"; did you mean sweep?"});
  check_usage({"sweep", "disk8", "--epsilon", "1", "--csv", "-"}, {"case 'disk8'", "; did you mean disks8?"});
  check_usage({"sweep", "disks8", "--epsilom", "1", "--csv", "-"}, {"--epsilom", "; did you mean --epsilon?"});
  check_usage({"sweep", "disks8", "--epsilom=1", "--csv", "-"}, {"; did you mean --epsilon?"});
  check_usage({"run", "figure5"}, {"study 'figure5'", "; did you mean figure-5?"});
  check_option("--contacts", "unilaterl", {"--contacts", "; did you mean unilateral?"});
  check_option("--set", "packing.grain=3", {"packing.grain", "; did you mean packing.grains?"});
  check_option("--set", "packin.grains=3", {"packin.grains", "; did you mean packing?"});
}

TEST_CASE("usage: SPEC nonsense for epsilon") {
  // --epsilon=1 comes first in check_spec: an option given twice is refused as well
  for (const std::string& spec : Texts{"", "abc", "1,,2", "1:2", "1:2:1", "1:2:0", "1:2:3:cubic", "0:1:3", "1:inf:3",
                                       "nan", "1:2:1000001", "1:2:2.5", "1:2:3:linear:4", "1e999"}) {
    CAPTURE(spec);
    check_usage({"sweep", "disks4", "--csv", "-", std::string("--epsilon=") + spec}, {"epsilon"});
    check_usage({"optimum", "disks4", std::string("--epsilon=") + spec}, {"epsilon"});
  }
}

TEST_CASE("usage: SPEC nonsense for eta, relaxation and Gauss-Seidel sweeps") {
  check_spec("--eta", "eta");
  check_spec("--relaxation", "relaxation");
  check_spec("--gauss-seidel-sweeps", "auss");
}

TEST_CASE("usage: too many values in one SPEC") {
  check_option("--eta", "1:2:1000000,1:2:1000000", {"eta", "1000000"});
  check_option("--relaxation", "1:2:1000000,1:2:1000000", {"relaxation", "1000000"});
  check_option("--gauss-seidel-sweeps", "1:1:1000000,1:1:1000000", {"1000000"});
}

TEST_CASE("usage: epsilon below zero or infinite") {
  for (const std::string& value : Texts{"-1", "1,-1e-300", "-1:1:3:linear", "inf", "-inf"}) {
    check_usage({"sweep", "disks4", "--csv", "-", "--epsilon", value}, {"epsilon", ">= 0"});
    check_usage({"optimum", "disks4", "--epsilon", value}, {"epsilon", ">= 0"});
  }
}

TEST_CASE("usage: eta zero or below") {
  for (const std::string& value : Texts{"0", "-0.0", "-1", "1,0", "0:1:3:linear", "-inf"})
    check_option("--eta", value, {"eta", "> 0"});
}

TEST_CASE("usage: relaxation zero or below or infinite") {
  for (const std::string& value : Texts{"0", "-1", "inf"}) check_option("--relaxation", value, {"relaxation", "> 0"});
  check_option("--relaxation", "best", {"relaxation", "best"});
  check_usage(words("sweep disks4 --epsilon 1 --csv - --relaxation optimal --gauss-seidel-sweeps 2"),
              {"relaxation", "--gauss-seidel-sweeps"});
}

TEST_CASE("usage: Gauss-Seidel sweeps below one or broken") {
  for (const std::string& value : Texts{"0", "-1", "1.5", "-inf", "1e10"})
    check_option("--gauss-seidel-sweeps", value, {"auss"});
}

TEST_CASE("usage: an unknown solver or contact set or tolerance") {
  check_option("--solver", "guess", {"--solver", "dense", "guess"});
  check_option("--contacts", "some", {"--contacts", "active", "some"});
  for (const std::string& value : Texts{"0", "-1", "nan", "inf", "small"})
    check_option("--residual-tolerance", value, {"--residual-tolerance"});
}

TEST_CASE_FIXTURE(Session, "usage: certificates and lists of eigenvalues are of an exact Stage 1") {
  for (const std::string& option : Texts{"--certify", "--eigenvalues 3"})
    for (const std::string& sweeps : Texts{"1", "inf,2"})
      check_refused("sweep disks8 --epsilon 1 --csv - --gauss-seidel-sweeps " + sweeps + " " + option,
                    {"--gauss-seidel-sweeps: expected inf", "--certify"});
}

TEST_CASE_FIXTURE(Session, "usage: a load that moves nothing is no missing load") {
  file("one.csv", "x,y,radius\n0,0,1\n");
  check_refused(
      "sweep one.csv --subdomains 2x1 --epsilon 0 --contacts unilateral --csv - --set "
      "loads.compression=1,1",
      {"moves a grain", "all velocities given are zero"});
}

TEST_CASE_FIXTURE(Session, "usage: the active set without a prescribed velocity") {
  file("mine.csv", row_of_three());
  check_refused("sweep mine.csv --epsilon 0 --contacts active --csv -", {"prescribed", "--prescribed"});
  check_refused("sweep mine.csv --epsilon 0 --contacts active --csv out.csv --hdf5 out.h5", {"prescribed"});
  check_refused("sweep mine.csv --epsilon 0 --contacts unilateral --csv -", {"prescribed", "loads"});
  check_refused("network mine.csv --contacts all", {"--contacts", "unilateral"});
  check_refused("sweep mine.csv --epsilon 0 --csv - --set loads.compression=1", {"loads.compression"});
  check_refused("optimum mine.csv", {"prescribed"});
  check_refused("optimum mine.csv --csv -", {"prescribed"});
  check_refused("optimum mine.csv --csv out.csv", {"prescribed"});
}

TEST_CASE("usage: a prescribed velocity that makes no sense") {
  for (const std::string& value :
       Texts{"", "1", "1:1", "1:1:1:1:1", "1:1:0:x", "x:1:0", "1:x:0", "1.5:1:0", "1:nan:0", "1:0:inf", ":1:0"})
    check_option("--prescribed", value, {"--prescribed"});
  check_option("--prescribed", "4:1:0", {"grain 4"});
  check_option("--prescribed", "1:1:1:1", {"prescribed[0].velocity", "two numbers for a packing in the plane"});
  check_option("--prescribed", "-5:1:0", {"grain -5"});
  check_option("--prescribed", "99999999999999999999:1:0", {"--prescribed"});
  check_usage(words("sweep mine.csv --epsilon 1 --csv - --prescribed 1:1:0 --prescribed 1:2:0"), {"grain 1"});
  check_usage(words("sweep mine.csv --epsilon 1 --csv - --prescribed 3:1:0 --prescribed -1:2:0"), {"grain"});
}

TEST_CASE("usage: subdomains that make no sense") {
  for (const std::string& value : Texts{"2", "x", "2x", "x2", "2x1x3", "0x1", "-1x1", "1.5x1", "2X1", "metis",
                                        "metis:", "metis:0", "metis:x", "99999999999x1", "100000x100000"}) {
    CAPTURE(value);
    check_usage({"sweep", "mine.csv", "--epsilon", "1", "--csv", "-", std::string("--subdomains=") + value}, {});
  }
}

TEST_CASE("usage: what is refused of the command line itself says what was met and which help has more") {
  const std::string help = "'nscdd sweep --help' says how";
  check_option("--solver", "dens",
               {"--solver: expected one of \"auto\", \"dense\"", "met \"dens\"; did you mean dense?", help});
  check_option("--threads", "-1", {"--threads: expected a finite number >= 0 and <= 4096, met -1", help});
  check_option("--density", "heavy", {"--density: expected a number, met 'heavy'", help});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv"}, {"--csv: expected a value, met none", help});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv", "a", "--csv", "b"}, {"--csv: expected it once", help});
  check_usage({"sweep", "--epsilon", "1", "--csv", "-"}, {"expected CASE, met none", help});
  check_usage({"sweep", "disks4", "more", "--epsilon", "1", "--csv", "-"}, {"no further argument, met 'more'", help});
  check_option("--subdomains", "metis:x", {"--subdomains: expected an integer, met 'x'"});
  check_option("--eta", "W", {"expected a number before W", "met 'W'"});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv", "-", "--certify=yes"},
              {"--certify: expected no value, met 'yes'", help});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv", "--certify"}, {"--csv: expected a value, met none", help});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv", "-", "-o"}, {"expected a known option, met '-o'", help});
  check_usage({"export", "run.h5", "--vtk", "a", "--lmgc90", "b"}, {"--lmgc90: expected no --vtk with it, met --vtk"});
  check_option("--subdomains", "", {"--subdomains: expected a value, met an empty text", help});
  check_usage({"solve", "a.hdf5", "--resume"}, {"--resume: expected --csv with it, met none"});
  check_usage({"sweep", "disks4", "--epsilon", "1", "--csv", "-", "--tolerance", "1", "--set", "contacts.tolerance=1"},
              {"--set contacts.tolerance: expected contacts.tolerance once, met --tolerance too"});
  check_usage({"inspect", "disks4", "--subdomains", "2x1", "--set", "partition.grid=3,1"},
              {"--set partition.grid: expected partition.grid once, met --subdomains too"});
  check_usage({"network", "disks4", "--csv", "-", "--grains", "-"}, {"another name for each output"});
}

TEST_CASE_FIXTURE(Session, "usage: names and values in one word, arguments behind --, numbers of Fortran") {
  const std::string expected = answer("sweep disks4 --epsilon 1 --csv -");
  CHECK(answer("sweep --epsilon=1.0D+00 --csv=- -- disks4") == expected);
  answer("generate disks4 -odisks.csv");
  CHECK(contains(read("disks.csv"), "\nx,y,radius"));
}

TEST_CASE("usage: densities and tolerances and settings that make no sense") {
  for (const std::string& value : Texts{"-1", "0", "nan", "inf", "heavy"})
    check_option("--density", value, {"density"});
  for (const std::string& value : Texts{"-1", "2", "nan", "close"}) {
    check_option("--tolerance", value, {"tolerance"});
    check_option("--overlap-tolerance", value, {"tolerance"});
  }
  check_option("--set", "packing.grains", {"--set", "KEY=VALUE"});
  check_option("--set", "packing.grains=many", {"packing.grains", "many"});
  check_option("--set", "packing.grains=0", {"packing.grains", ">= 1"});
  check_option("--set", "packing.colour=1", {"packing.colour", "packing.grains"});
  check_option("--set", "nonsense=1", {"nonsense"});
  check_usage(words("sweep mine.csv --epsilon 1 --csv - --set packing.radius=1"), {"packing.radius", "file"});
}
