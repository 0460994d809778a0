// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd run: a study becomes tables, and is compared with its baseline.
#include "session.hpp"

#include <doctest/doctest.h>

#include <filesystem>

using namespace nscdd::testing;

namespace {

const std::string small_study =
    "title = \"a small study\"\n"
    "[[table]]\n"
    "name = \"radius\"\n"
    "cases = [\"disks4\", \"mine.toml\"]\n"
    "epsilon = \"0,1\"\n"
    "eta = [0.3, inf]\n"
    "[[table]]\n"
    "name = \"best\"\n"
    "observable = \"optimum\"\n"
    "cases = [\"strip\"]\n"
    "contacts = \"active\"\n"
    "epsilon = 0\n"
    "vary = { \"packing.grains\" = [4, 6] }\n";

const std::string small_case = case_text("strip\ngrains = 5", "2, 1");

// A study folder with the baseline that its own run gives.
void write_study(const Session& session) {
  session.file("study/study.toml", small_study);
  session.file("study/mine.toml", small_case);
  answer(session, "run study --output first");
  session.file("study/baseline.csv", session.read("first/study/radius.csv"));
  session.file("study/baseline-best.csv", session.read("first/study/best.csv"));
}

}  // namespace

TEST_CASE("run: tables and HDF5 with their names on standard output") {
  const Session session;
  session.file("study/study.toml", small_study);
  session.file("study/mine.toml", small_case);
  CHECK(answer(session, "run study") == "results/study/radius.csv\nresults/study/best.csv\nresults/study/study.h5\n");
  const CsvTable radius = read_table(session.read("results/study/radius.csv"));
  REQUIRE(radius.rows.size() == 8);
  CHECK(radius.text(0, "case") == "disks4");
  CHECK(radius.text(7, "case") == "mine");
  CHECK(radius.number(7, "grains") == 5);
  const CsvTable best = read_table(session.read("results/study/best.csv"));
  REQUIRE(best.rows.size() == 2);
  CHECK(best.number(0, "packing.grains") == 4);
  CHECK(best.number(1, "packing.grains") == 6);
  const std::string hdf5 = session.read("results/study/study.h5");
  CHECK(hdf5.find("nscdd run study") != std::string::npos);
  CHECK(hdf5.find("title = \"a small study\"") != std::string::npos);
}

TEST_CASE("run: equal runs give equal bytes") {
  const Session first, second;
  for (const Session* session : {&first, &second}) answer(*session, "run figure-7");
  const auto content = content_of((first.folder / "results"));
  CHECK(content.size() == 3);  // folder, table, HDF5
  CHECK(content == content_of((second.folder / "results")));
}

TEST_CASE("run: a study by its folder or its file or from within") {
  const Session session;
  write_study(session);
  answer(session, "run study/ --output slash");
  answer(session, "run study/study.toml --output file");
  answer(session, "run ./study/../study --output dots");
  CHECK(session.has("slash/study/study.h5"));
  CHECK(session.has("file/study/study.h5"));
  CHECK(session.has("dots/study/study.h5"));
  CHECK(run_program(session.folder / "study", words("run . --output ../within")).exit_code == 0);
  CHECK(session.has("within/study/study.h5"));
}

TEST_CASE(
    "run: what a switched step of grains that fly together differs by is rounding, and without contacts nothing") {
  const Session session;
  session.file("row.csv", "x,y,radius,mass\n0,0,0.5,1\n0.6,0.8,0.5,1\n1.2,1.6,0.5,1\n1.8,2.4,0.5,1\n");
  session.file("apart.csv", "x,y,radius,mass\n0,0,0.5,1\n3,0,0.5,1\n6,0,0.5,1\n9,0,0.5,1\n");
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
  session.file("study/row.toml", flying("../row.csv"));
  session.file("study/apart.toml", flying("../apart.csv"));
  session.file("study/study.toml",
               "title = \"flying\"\n[[table]]\nname = \"switch\"\nobservable = \"switching\"\n"
               "cases = [\"row.toml\", \"apart.toml\"]\nsteps = [1, 2, 3]\n");
  answer(session, "run study");
  const CsvTable rows = read_table(session.read("results/study/switch.csv"));
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

TEST_CASE("run --check: exit code 0 where the baseline is met") {
  const Session session;
  write_study(session);
  const Outcome outcome = session.run(words("run study --check --output second"));
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.standard_error.find("agrees") != std::string::npos);
}

TEST_CASE("run --check: exit code 1 where the baseline differs") {
  const Session session;
  write_study(session);
  const std::string baseline = session.read("study/baseline.csv");
  const CsvTable table = read_table(baseline);
  const std::string radius = table.text(1, "spectral_radius");
  // a radius that is off, a text that is off, a row too few, a column too few
  const std::string off = radius.substr(0, 5) + (radius[5] == '9' ? '8' : '9') + radius.substr(6);
  const std::vector<std::string> perturbed{replaced(baseline, radius, off), replaced(baseline, "mine,", "yours,"),
                                           baseline.substr(0, baseline.rfind('\n', baseline.size() - 2) + 1),
                                           replaced(baseline, "subdomains,", "parts,")};
  for (const std::string& text : perturbed) {
    CAPTURE(text);
    session.file("study/baseline.csv", text);
    const Outcome outcome = session.run(words("run study --check --force --output second"));
    CHECK(outcome.exit_code == 1);
    CHECK(outcome.standard_error.find("study/radius differs from study/baseline.csv") != std::string::npos);
    CHECK(session.has("second/study/radius.csv"));  // for the user to look into
  }
}

TEST_CASE("run --check: the last decimals of a radius are rounding") {
  const Session session;
  write_study(session);
  const std::string baseline = session.read("study/baseline.csv");
  const std::string radius = read_table(baseline).text(1, "spectral_radius");
  session.file("study/baseline.csv", replaced(baseline, radius, radius.substr(0, 14)));
  CHECK(session.run(words("run study --check --output second")).exit_code == 0);
}

TEST_CASE("run --check: tolerances of the study, for all columns or for one") {
  const Session session;
  write_study(session);
  const std::string baseline = session.read("study/baseline.csv");
  const std::string radius = read_table(baseline).text(1, "spectral_radius");
  session.file("study/baseline.csv", replaced(baseline, radius, radius.substr(0, 7)));
  const auto checked = [&](const std::string& line) {
    session.file("study/study.toml", replaced(small_study, "eta = [0.3, inf]\n", "eta = [0.3, inf]\n" + line));
    return session.run(words("run study --check --force --output second")).exit_code;
  };
  CHECK(checked("") == 1);
  CHECK(checked("check_tolerance = 1e-4\n") == 0);
  CHECK(checked("column_tolerance = { eta = 1e-4 }\n") == 1);
  CHECK(checked("column_tolerance = { spectral_radius = 1e-4 }\n") == 0);
  CHECK(checked("check_tolerance = 1e-4\ncolumn_tolerance = { spectral_radius = 1e-9 }\n") == 1);
}

TEST_CASE("run --large: adds the tables that are marked so, with or without a baseline") {
  const Session session;
  write_study(session);
  session.file("study/study.toml", small_study + "large = true\n");
  std::filesystem::remove(session.folder / "study/baseline-best.csv");
  const Outcome small = session.run(words("run study --check --output second"));
  CHECK(small.exit_code == 0);
  CHECK(small.standard_error.find("without best, which --large adds") != std::string::npos);
  CHECK(small.standard_output == "second/study/radius.csv\nsecond/study/study.h5\n");
  CHECK_FALSE(session.has("second/study/best.csv"));
  const Outcome large = session.run(words("run study --check --large --output third"));
  CHECK(large.exit_code == 0);
  CHECK(session.read("third/study/best.csv") == session.read("first/study/best.csv"));
  session.file("study/baseline-best.csv", replaced(session.read("first/study/best.csv"), "interior", "none"));
  CHECK(session.run(words("run study --check --large --output third --force")).exit_code == 1);
}

TEST_CASE("run --check: exit code 1 where a later table differs") {
  const Session session;
  write_study(session);
  const std::string baseline = session.read("study/baseline-best.csv");
  session.file("study/baseline-best.csv", replaced(baseline, "interior", "elsewhere"));
  const Outcome outcome = session.run(words("run study --check --output second"));
  CHECK(outcome.exit_code == 1);
  CHECK(outcome.standard_error.find("baseline-best.csv") != std::string::npos);
}

TEST_CASE("run --check: exit code 2 where a baseline is missing or unreadable") {
  const Session session;
  write_study(session);
  for (const std::string& name : Texts{"study/baseline.csv", "study/baseline-best.csv"}) {
    const std::string kept = session.read(name);
    std::filesystem::remove(session.folder / name);
    const Outcome missing = session.run(words("run study --check --force --output second"));
    CHECK(missing.exit_code == 2);
    CHECK(missing.standard_error.find(std::string("nscdd: error: ") + name) == 0);
    session.file(name, "a,b\n1\n");
    const Outcome malformed = session.run(words("run study --check --force --output second"));
    CHECK(malformed.exit_code == 2);
    CHECK(malformed.standard_error.find(std::string("nscdd: error: ") + name + ":2") == 0);
    session.file(name, kept);
  }
  CHECK_FALSE(session.has("second"));  // said before any work is done
}

TEST_CASE("run: existing results are refused without --force") {
  const Session session;
  write_study(session);
  check_refused(session, "run study --output first", {"first/study/radius.csv", "--force"});
  std::filesystem::remove(session.folder / "first/study/radius.csv");
  check_refused(session, "run study --output first", {"first/study/best.csv"});
  std::filesystem::remove(session.folder / "first/study/best.csv");
  check_refused(session, "run study --output first", {"first/study/study.h5"});
  answer(session, "run study --output first --force");
}

TEST_CASE("run: a killed study leaves a readable table") {
  const Session session;
  session.file("study/study.toml", replaced(small_study, "\"0,1\"", "\"0,1e-3:1e3:300000\""));
  session.file("study/mine.toml", small_case);
  const auto partial = session.folder / "results/study/radius.csv.partial";
  const RunOptions options{.signal_at = SignalAt{"radius.csv.partial", 20'000}};
  CHECK(session.run(words("run study"), options).exit_code == 128 + 9);
  CHECK(read_table(read_file(partial)).rows.size() > 10);
  check_refused(session, "run study", {"radius.csv.partial", "interrupted"});
}

TEST_CASE("run: a malformed study is refused with file and line") {
  const Session session;
  const auto refused = [&](const std::string& text, std::initializer_list<std::string> parts) {
    session.file("study/study.toml", text);
    check_refused(session, "run study", parts);
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

TEST_CASE("run: an unknown study is refused with the names of the known ones") {
  const Session session;
  check_refused(session, "run figure-99", {"figure-99", "figure-5"});
  check_refused(session, "run .", {"study.toml"});
}
