// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd run: a study becomes tables, and is compared with its baseline.
#include "session.hpp"

#include <filesystem>

using namespace nscdd::testing;

namespace {

const std::string small_study =
    "title = \"a small study\"\n"
    "[[table]]\nname = \"radius\"\ncases = [\"disks4\", \"mine.toml\"]\nepsilon = \"0,1\"\neta = [0.3, inf]\n"
    "[[table]]\nname = \"best\"\nobservable = \"optimum\"\ncases = [\"strip\"]\ncontacts = \"active\"\nepsilon = 0\n"
    "vary = { \"packing.grains\" = [4, 6] }\n";

const std::string small_case = case_text("strip\ngrains = 5", "2, 1");

// A study folder with the baseline that its own run gives.
struct StudySession : Session {
  StudySession() {
    file("study/study.toml", small_study);
    file("study/mine.toml", small_case);
    answer("run study --output first");
    file("study/baseline.csv", read("first/study/radius.csv"));
    file("study/baseline-best.csv", read("first/study/best.csv"));
  }
};

}  // namespace

TEST_CASE_FIXTURE(Session, "run: tables and HDF5 with their names on standard output") {
  file("study/study.toml", small_study);
  file("study/mine.toml", small_case);
  CHECK(answer("run study") == "results/study/radius.csv\nresults/study/best.csv\nresults/study/study.h5\n");
  const CsvTable radius = csv("results/study/radius.csv");
  REQUIRE(radius.rows.size() == 8);
  CHECK(radius.text(0, "case") == "disks4");
  CHECK(radius.text(7, "case") == "mine");
  CHECK(radius.number(7, "grains") == 5);
  const CsvTable best = csv("results/study/best.csv");
  REQUIRE(best.rows.size() == 2);
  CHECK(best.number(0, "packing.grains") == 4);
  CHECK(best.number(1, "packing.grains") == 6);
  const std::string hdf5 = read("results/study/study.h5");
  CHECK(contains(hdf5, "nscdd run study"));
  CHECK(contains(hdf5, "title = \"a small study\""));
}

TEST_CASE("run: equal runs give equal bytes") {
  const Session first, second;
  for (const Session* session : {&first, &second}) session->answer("run figure-7");
  const auto content = content_of((first.folder / "results"));
  CHECK(content.size() == 3);  // folder, table, HDF5
  CHECK(content == content_of((second.folder / "results")));
}

TEST_CASE_FIXTURE(StudySession, "run: a study by its folder or its file or from within") {
  answer("run study/ --output slash");
  answer("run study/study.toml --output file");
  answer("run ./study/../study --output dots");
  CHECK(has("slash/study/study.h5"));
  CHECK(has("file/study/study.h5"));
  CHECK(has("dots/study/study.h5"));
  CHECK(run_program(folder / "study", words("run . --output ../within")).exit_code == 0);
  CHECK(has("within/study/study.h5"));
}

TEST_CASE_FIXTURE(Session, "run: a switched step of grains that fly together differs by rounding only") {
  file("row.csv", "x,y,radius,mass\n0,0,0.5,1\n0.6,0.8,0.5,1\n1.2,1.6,0.5,1\n1.8,2.4,0.5,1\n");
  file("apart.csv", "x,y,radius,mass\n0,0,0.5,1\n3,0,0.5,1\n6,0,0.5,1\n9,0,0.5,1\n");
  // The last bits of two velocities differ: interface impulses are 10^-17 N s, and so is their change by the switch.
  const auto flying = [](const std::string& packing) {
    return "[packing]\nfile = \"" + packing +
           "\"\n[masses]\nmodel = \"given\"\n[partition]\ngrid = [2, 1]\n[interaction]\nfriction = 0.3\n"
           "[dynamics]\nstep = 0.005\nsteps = 3\ngravity = [0, 0]\n"
           "[solver]\nalgorithm = \"generic\"\ncriterion = \"none\"\nmaximum_iterations = 8\n"
           "switch = \"linear\"\nswitch_after = 3\nswitch_flexibility = \"1e-8 W\"\n"
           "[[prescribed]]\ngrain = 0\nvelocity = [0.33333333333333337, 0.1]\n"
           "[[prescribed]]\ngrain = 1\nvelocity = [0.3333333333333333, 0.10000000000000002]\n"
           "[[prescribed]]\ngrain = 2\nvelocity = [0.3333333333333333, 0.1]\n"
           "[[prescribed]]\ngrain = 3\nvelocity = [0.3333333333333333, 0.1]\n";
  };
  file("study/row.toml", flying("../row.csv"));
  file("study/apart.toml", flying("../apart.csv"));
  file("study/study.toml",
       "title = \"flying\"\n[[table]]\nname = \"switch\"\nobservable = \"switching\"\n"
       "cases = [\"row.toml\", \"apart.toml\"]\nsteps = [1, 2, 3]\n");
  answer("run study");
  const CsvTable rows = csv("results/study/switch.csv");
  REQUIRE(rows.rows.size() == 6);
  double largest = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    CAPTURE(k);
    CHECK(rows.number(k, "impulse_error") <= 1e-4);
    CHECK(rows.number(k, "velocity_error") <= 1e-14);
    CHECK(rows.number(k, "natural_map") <= 1e-14);
    largest = std::max(largest, rows.number(k, "impulse_error"));
    if (k >= 3) CHECK(rows.number(k, "share") == 0);
  }
  CHECK(largest > 0);
}

TEST_CASE_FIXTURE(StudySession, "run --check: exit code 0 where the baseline is met") {
  ended(0, "run study --check --output second", {"agrees"});
}

TEST_CASE_FIXTURE(StudySession, "run --check: exit code 1 where the baseline differs") {
  const std::string baseline = read("study/baseline.csv");
  const CsvTable table = read_table(baseline);
  const std::string radius = table.text(1, "spectral_radius");
  // a radius that is off, a text that is off, a row too few, a column too few
  const std::string off = radius.substr(0, 5) + (radius[5] == '9' ? '8' : '9') + radius.substr(6);
  const std::vector<std::string> perturbed{replaced(baseline, radius, off), replaced(baseline, "mine,", "yours,"),
                                           baseline.substr(0, baseline.rfind('\n', baseline.size() - 2) + 1),
                                           replaced(baseline, "subdomains,", "parts,")};
  for (const std::string& text : perturbed) {
    CAPTURE(text);
    file("study/baseline.csv", text);
    ended(1, "run study --check --force --output second", {"study/radius differs from study/baseline.csv"});
    CHECK(has("second/study/radius.csv"));  // for the user to look into
  }
}

TEST_CASE_FIXTURE(StudySession, "run --check: the last decimals of a radius are rounding") {
  const std::string baseline = read("study/baseline.csv");
  const std::string radius = read_table(baseline).text(1, "spectral_radius");
  file("study/baseline.csv", replaced(baseline, radius, radius.substr(0, 14)));
  CHECK(run("run study --check --output second").exit_code == 0);
}

TEST_CASE_FIXTURE(StudySession, "run --check: tolerances of the study, for all columns or for one") {
  const std::string baseline = read("study/baseline.csv");
  const std::string radius = read_table(baseline).text(1, "spectral_radius");
  file("study/baseline.csv", replaced(baseline, radius, radius.substr(0, 7)));
  const auto checked = [&](const std::string& line) {
    file("study/study.toml", replaced(small_study, "eta = [0.3, inf]\n", "eta = [0.3, inf]\n" + line));
    return run("run study --check --force --output second").exit_code;
  };
  CHECK(checked("") == 1);
  CHECK(checked("check_tolerance = 1e-4\n") == 0);
  CHECK(checked("column_tolerance = { eta = 1e-4 }\n") == 1);
  CHECK(checked("column_tolerance = { spectral_radius = 1e-4 }\n") == 0);
  CHECK(checked("check_tolerance = 1e-4\ncolumn_tolerance = { spectral_radius = 1e-9 }\n") == 1);
}

TEST_CASE_FIXTURE(StudySession, "run --large: adds the tables that are marked so, with or without a baseline") {
  file("study/study.toml", small_study + "large = true\n");
  std::filesystem::remove(folder / "study/baseline-best.csv");
  const Outcome small = ended(0, "run study --check --output second", {"without best, which --large adds"});
  CHECK(small.standard_output == "second/study/radius.csv\nsecond/study/study.h5\n");
  CHECK_FALSE(has("second/study/best.csv"));
  const Outcome large = ended(0, "run study --check --large --output third");
  CHECK(read("third/study/best.csv") == read("first/study/best.csv"));
  file("study/baseline-best.csv", replaced(read("first/study/best.csv"), "interior", "none"));
  CHECK(run("run study --check --large --output third --force").exit_code == 1);
}

TEST_CASE_FIXTURE(StudySession, "run --check: exit code 1 where a later table differs") {
  const std::string baseline = read("study/baseline-best.csv");
  file("study/baseline-best.csv", replaced(baseline, "interior", "elsewhere"));
  ended(1, "run study --check --output second", {"baseline-best.csv"});
}

TEST_CASE_FIXTURE(StudySession, "run --check: exit code 2 where a baseline is missing or unreadable") {
  for (const std::string& name : Texts{"study/baseline.csv", "study/baseline-best.csv"}) {
    const std::string kept = read(name);
    std::filesystem::remove(folder / name);
    const Outcome missing = ended(2, "run study --check --force --output second");
    CHECK(missing.standard_error.find(std::string("nscdd: error: ") + name) == 0);
    file(name, "a,b\n1\n");
    const Outcome malformed = ended(2, "run study --check --force --output second");
    CHECK(malformed.standard_error.find(std::string("nscdd: error: ") + name + ":2") == 0);
    file(name, kept);
  }
  CHECK_FALSE(has("second"));  // said before any work is done
}

TEST_CASE_FIXTURE(StudySession, "run: existing results are refused without --force") {
  check_refused("run study --output first", {"first/study/radius.csv", "--force"});
  std::filesystem::remove(folder / "first/study/radius.csv");
  check_refused("run study --output first", {"first/study/best.csv"});
  std::filesystem::remove(folder / "first/study/best.csv");
  check_refused("run study --output first", {"first/study/study.h5"});
  answer("run study --output first --force");
}

TEST_CASE_FIXTURE(Session, "run: a killed study leaves a readable table") {
  file("study/study.toml", replaced(small_study, "\"0,1\"", "\"0,1e-3:1e3:300000\""));
  file("study/mine.toml", small_case);
  const auto partial = folder / "results/study/radius.csv.partial";
  CHECK(run("run study", {.signal_at = SignalAt{"radius.csv.partial", 20'000}}).exit_code == 128 + 9);
  CHECK(read_table(read_file(partial)).rows.size() > 10);
  check_refused("run study", {"radius.csv.partial", "interrupted"});
}

TEST_CASE_FIXTURE(Session, "run: a malformed study is refused with file and line") {
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    file("study/study.toml", text);
    check_refused("run study", parts);
  };
  const std::string table = "[[table]]\nname = \"a\"\ncases = [\"disks4\"]\n";
  refused("title = \n", {"study/study.toml:1"});
  refused("title = \"nothing\"\n", {"study/study.toml", "[[table]]"});
  refused(table + "bogus = 1\n", {"study/study.toml:4", "bogus"});
  refused(table + "epsilon = -1\n", {"study/study.toml:4", "epsilon"});
  refused(table + "epsilon = \"a:b\"\n", {"study/study.toml:4", "epsilon"});
  refused(table + "eta = [0.3, 0]\n", {"study/study.toml:4", "eta"});
  refused(table + "eta = []\n", {"study/study.toml:4", "eta"});
  refused(table + "relaxation = -1\n", {"study/study.toml:4", "relaxation"});
  refused(table + "gauss_seidel_sweeps = 1.5\n", {"study/study.toml:4", "gauss_seidel_sweeps"});
  refused(table + "contacts = \"some\"\n", {"study/study.toml:4", "contacts"});
  refused(table + "solver = \"guess\"\n", {"study/study.toml:4", "solver"});
  refused(table + "observable = \"mood\"\n", {"study/study.toml:4", "observable", "links"});
  refused(table + "seed = -1\n", {"study/study.toml:4", "seed"});
  refused(table + "vary = { \"packing.bogus\" = [1] }\n", {"study/study.toml:4", "packing.bogus"});
  refused(table + "vary = { \"packing.grains\" = [4, 0] }\n", {"study/study.toml:4", "packing.grains"});
  refused("[[table]]\nname = \"a\"\n", {"study/study.toml", "cases"});
  refused("[[table]]\nname = \"a/b\"\ncases = [\"disks4\"]\n", {"study/study.toml:2", "name"});
  refused("[[table]]\nname = \"a\"\ncases = [\"disks5\"]\n", {"study/study.toml:3", "disks5", "disks4"});
  refused(table + table, {"study/study.toml", "'a'"});
  refused(replaced(table, "\"a\"", "\"provenance\""), {"study/study.toml:2", "provenance"});
}

TEST_CASE_FIXTURE(Session, "run: an unknown study is refused with the names of the known ones") {
  check_refused("run figure-99", {"figure-99", "figure-5"});
  check_refused("run .", {"study.toml"});
}
