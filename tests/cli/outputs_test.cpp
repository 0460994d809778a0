// SPDX-License-Identifier: GPL-3.0-or-later
// What runs leave behind: equal bytes, nothing replaced unasked, nothing half-written.
#include "session.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

using namespace nscdd::testing;

namespace {

namespace fs = std::filesystem;

// Long enough to be killed in the middle: some hundred thousand rows.
const std::string long_sweep = "sweep disks4 --epsilon 1e-3:1e3:1000000 --csv long.csv";

// Kills a long sweep once it has written some rows.
Outcome killed_sweep(const Session& session) {
  return session.run(words(long_sweep), {.signal_at = SignalAt{"long.csv.partial", 20'000}});
}

}  // namespace

TEST_CASE("output: only the answer on standard output") {
  const Session session;
  const std::string printed = answer(session, "sweep disks4 --epsilon 0,1 --csv -");
  CHECK(answer(session, "sweep disks4 --epsilon 0,1 --csv out.csv") == "");
  CHECK(session.read("out.csv") == printed);
  CHECK(printed.rfind("case,", 0) == 0);
  CHECK(printed.back() == '\n');
  CHECK(content_of(session.folder.path()).size() == 1);  // no .partial either
}

TEST_CASE("output: a progress bar on standard error where that is a terminal") {
  const Session session;
  const std::string line = "sweep disks4 --epsilon 1e-3:1e3:2000 --csv -";
  RunOptions options;
  options.on_terminal = true;
  const Outcome outcome = session.run(words(line), options);
  CHECK(outcome.exit_code == 0);
  CHECK(outcome.standard_error.find("sweep [") != std::string::npos);
  CHECK(outcome.standard_error.find('%') != std::string::npos);
  CHECK(outcome.standard_output == answer(session, line));  // no bar without a terminal, and none in the answer
}

TEST_CASE("output: bytes of CSV are equal from run to run") {
  const Session session;
  for (const std::string& line : Texts{"sweep disks12 --epsilon 0,1e-4:1e4:33 --eta 0.1,inf --csv -",
                                       "sweep disks8 --epsilon 1 --gauss-seidel-sweeps 1,3,inf --csv -",
                                       "sweep hexagonal --epsilon 0.1 --eta 1,inf --solver arpack --csv -",
                                       "sweep hexagonal --epsilon 1 --subdomains metis:4 --csv -", "network hexagonal",
                                       "optimum disks8 --csv -"}) {
    CAPTURE(line);
    CHECK(answer(session, line) == answer(session, line));
  }
}

TEST_CASE("output: bytes of HDF5 are equal for one command in two folders") {
  const Session first, second;
  const std::string line = "sweep disks12 --epsilon 0,1e-2:1e2:9 --eta 0.3,inf --csv a.csv --hdf5 a.h5";
  answer(first, line);
  answer(second, line);
  const std::string bytes = first.read("a.h5");
  CHECK(bytes.substr(1, 3) == "HDF");
  CHECK(bytes == second.read("a.h5"));
  CHECK(first.read("a.csv") == second.read("a.csv"));
}

TEST_CASE("output: HDF5 says where it comes from") {
  const Session session;
  answer(session, "sweep disks4 --epsilon 1 --csv a.csv --hdf5 a.h5");
  const std::string bytes = session.read("a.h5");
  for (const std::string& text :
       Texts{"nscdd sweep disks4 --epsilon 1 --csv a.csv --hdf5 a.h5", "generator = \"strip\"", "grid = [2, 1]", "1/kg",
             "Eigen ", "ARPACK-NG ", "HDF5 "}) {
    CAPTURE(text);
    CHECK(bytes.find(text) != std::string::npos);
  }
}

TEST_CASE("output: an existing file is refused and left as it was") {
  const Session session;
  session.file("old", "precious");
  check_refused(session, "sweep disks4 --epsilon 1 --csv old", {"old: exists already", "--force"});
  check_refused(session, "sweep disks4 --epsilon 1 --csv - --hdf5 old", {"old: exists already", "--force"});
  check_refused(session, "network disks4 --csv old", {"old: exists already"});
  check_refused(session, "network disks4 --csv new --grains old", {"old: exists already"});
  check_refused(session, "optimum disks4 --csv old", {"old: exists already"});
}

TEST_CASE("output: --force replaces an existing file") {
  const Session session;
  session.file("old", "precious");
  session.file("old.h5", "precious");
  answer(session, "sweep disks4 --epsilon 1 --csv old --hdf5 old.h5 --force");
  CHECK(session.read("old").rfind("case,", 0) == 0);
  CHECK(session.read("old.h5").substr(1, 3) == "HDF");
  CHECK(content_of(session.folder.path()).size() == 2);
}

TEST_CASE("output: --force replaces no file that the work is made from") {
  const Session session;
  session.file("in.csv", row_of_three());
  session.file("grid.toml", case_text("in.csv", "2, 1"));
  session.file("study/study.toml", "[[table]]\nname = \"baseline\"\ncases = \"disks4\"\nepsilon = \"1\"\n");
  session.file("study/baseline.csv", "precious");
  session.file("slow-impulses.csv", row_of_three());
  answer(session, "generate in.csv -o in.h5");
  std::filesystem::create_hard_link(session.folder / "in.csv", session.folder / "linked.csv");
  for (const std::string line :
       {"sweep in.csv --epsilon 1 --csv ./in.csv", "sweep in.csv --epsilon 1 --csv linked.csv",
        "sweep in.h5 --epsilon 1 --csv - --hdf5 in.h5", "sweep grid.toml --epsilon 1 --csv grid.toml",
        "sweep grid.toml --epsilon 1 --csv in.csv", "network in.csv --csv in.csv", "network in.csv --grains in.csv",
        "optimum in.csv --contacts all --csv in.csv", "inspect in.csv --histogram in.csv", "generate in.csv -o in.csv",
        "generate grid.toml -o in.csv", "modes slow-impulses.csv --epsilon 1 --output slow", "run study --output ."}) {
    CAPTURE(line);
    check_refused(session, line + " --force", {"expected another file than the input", "would be lost"});
  }
}

TEST_CASE("output: --force replaces no file of the case that a packing is settled from, at any depth") {
  const Session session;
  session.file("grains.csv", row_of_three());
  session.file("first.toml", case_text("grains.csv"));
  session.file("second.toml", "[packing]\nsettled = \"first.toml\"\n[partition]\ngrid = [1, 1]\n");
  session.file("third.toml", "[packing]\nsettled = \"second.toml\"\n[partition]\ngrid = [1, 1]\n");
  for (const std::string input : {"grains.csv", "first.toml", "second.toml", "third.toml"})
    check_refused(session, "sweep third.toml --epsilon 1 --force --csv " + input, {input, "would be lost"});
}

TEST_CASE("output: what was there survives a run with --force that fails") {
  const Session session;
  session.file("old", "precious");
  check_refused(session, "sweep disks4 --epsilon -1 --csv old --force", {"epsilon"});
  session.file("lone.csv", row_of_three());
  check_refused(session, "sweep lone.csv --epsilon 1 --contacts active --csv old --force", {"prescribed"});
}

TEST_CASE("output: the partial file of another run is refused") {
  const Session session;
  session.file("a.csv.partial", "rows of another run\n");
  check_refused(session, "sweep disks4 --epsilon 1 --csv a.csv", {"a.csv.partial", "interrupted", "--force"});
  session.file("a.h5.partial", "bytes of another run");
  check_refused(session, "sweep disks4 --epsilon 1 --csv - --hdf5 a.h5", {"a.h5.partial", "interrupted"});
  answer(session, "sweep disks4 --epsilon 1 --csv a.csv --hdf5 a.h5 --force");
  CHECK(content_of(session.folder.path()).size() == 2);
}

TEST_CASE("output: a killed run leaves a readable partial file") {
  const Session session;
  CHECK(killed_sweep(session).exit_code == 128 + 9);
  CHECK(!session.has("long.csv"));
  const std::string partial = session.read("long.csv.partial");
  REQUIRE(partial.back() == '\n');  // whole lines only
  const CsvTable table = read_table(partial);
  REQUIRE(table.rows.size() > 10);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const double radius = table.number(row, "spectral_radius");
    CHECK((radius > 0 && radius < 0.66));
  }
}

TEST_CASE("output: a killed run with --force destroys nothing") {
  const Session session;
  session.file("long.csv", "precious");
  const std::string line = long_sweep + " --force";
  CHECK(session.run(words(line), {.signal_at = SignalAt{"long.csv.partial"}}).exit_code == 128 + 9);
  CHECK(session.read("long.csv") == "precious");
}

TEST_CASE("output: two outputs under one name are refused") {
  const Session session;
  check_refused(session, "sweep disks4 --epsilon 1 --csv same --hdf5 same", {"same", "each output"});
  check_refused(session, "sweep disks4 --epsilon 1 --csv same --hdf5 ./same --force", {"same", "each output"});
  check_refused(session, "network disks4 --csv same --grains same --force", {"same", "each output"});
}

TEST_CASE("output: an unwritable place is refused") {
  const Session session;
  for (const std::string& place : Texts{"missing/out", "missing/deep/out", "/proc/out", "."}) {
    const std::string name(place);
    check_refused(session, "sweep disks4 --epsilon 1 --csv " + name, {name});
    check_refused(session, "sweep disks4 --epsilon 1 --csv out.csv --hdf5 " + name, {name});
    check_refused(session, "network disks4 --csv " + name, {name});
    check_refused(session, "network disks4 --csv out.csv --grains " + name, {name});
    check_refused(session, "optimum disks4 --csv " + name, {name});
  }
  check_refused(session, std::vector<std::string>{"sweep", "disks4", "--epsilon", "1", "--csv", ""}, {"output"});
  check_refused(session, "run figures-2-3-4 --output /proc/out", {"/proc/out"});
  session.file("file", "no folder");
  check_refused(session, "run figures-2-3-4 --output file", {"file"});
  check_refused(session, "sweep disks4 --epsilon 1 --csv file/out", {"file/out"});
}

TEST_CASE("output: a folder without permission is refused") {
  const Session session;
  fs::create_directory(session.folder / "locked");
  fs::permissions(session.folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  RunOptions options;
  options.obey_permissions = true;
  check_refused(session, "sweep disks4 --epsilon 1 --csv locked/out", {"locked/out", "Permission denied"}, options);
  check_refused(session, "sweep disks4 --epsilon 1 --csv out.csv --hdf5 locked/out", {"locked/out"}, options);
  check_refused(session, "run figures-2-3-4 --output locked", {"locked"}, options);
  fs::permissions(session.folder / "locked", fs::perms::owner_all);
}

TEST_CASE("output: a pipe is written to and stays a pipe") {
  const Session session;
  // A link stands for the device: were the program to replace what it writes to, only the link would be lost.
  fs::create_symlink("/dev/null", session.folder / "sink");
  answer(session, "sweep disks4 --epsilon 1 --csv sink --hdf5 out.h5");
  answer(session, "network disks4 --csv sink --grains sink");
  CHECK(fs::is_symlink(session.folder / "sink"));
  const Outcome outcome = session.run(words("sweep disks4 --epsilon 1 --csv out.csv --hdf5 sink"));
  CHECK(fs::is_symlink(session.folder / "sink"));
  CHECK(fs::is_character_file(session.folder / "sink"));
  CHECK((outcome.exit_code == 0 || outcome.exit_code == 2));  // written to, or refused as no place for HDF5
}
