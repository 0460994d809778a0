// SPDX-License-Identifier: GPL-3.0-or-later
// What runs leave behind: equal bytes, nothing replaced unasked, nothing half-written.
#include "session.hpp"

#include <filesystem>

using namespace nscdd::testing;

namespace {

// Long enough to be killed in the middle: some hundred thousand rows.
const std::string long_sweep = "sweep disks4 --epsilon 1e-3:1e3:1000000 --csv long.csv";

// Kills a long sweep once it has written some rows.
Outcome killed_sweep(const Session& session) {
  return session.run(long_sweep, {.signal_at = SignalAt{"long.csv.partial", 20'000}});
}

}  // namespace

TEST_CASE_FIXTURE(Session, "output: only the answer on standard output") {
  const std::string printed = answer("sweep disks4 --epsilon 0,1 --csv -");
  CHECK(answer("sweep disks4 --epsilon 0,1 --csv out.csv") == "");
  CHECK(read("out.csv") == printed);
  CHECK(printed.rfind("case,", 0) == 0);
  CHECK(printed.back() == '\n');
  CHECK(content_of(folder.path()).size() == 1);  // no .partial either
}

TEST_CASE_FIXTURE(Session, "output: a progress bar on standard error where that is a terminal") {
  const std::string line = "sweep disks4 --epsilon 1e-3:1e3:2000 --csv -";
  const Outcome outcome = ended(0, line, {"sweep ["}, {.on_terminal = true});
  CHECK(outcome.standard_error.find('%') != std::string::npos);
  CHECK(outcome.standard_output == answer(line));  // no bar without a terminal, and none in the answer
}

TEST_CASE_FIXTURE(Session, "output: bytes of CSV are equal from run to run") {
  for (const std::string& line : Texts{"sweep disks12 --epsilon 0,1e-4:1e4:33 --eta 0.1,inf --csv -",
                                       "sweep disks8 --epsilon 1 --gauss-seidel-sweeps 1,3,inf --csv -",
                                       "sweep hexagonal --epsilon 0.1 --eta 1,inf --solver arpack --csv -",
                                       "sweep hexagonal --epsilon 1 --subdomains metis:4 --csv -", "network hexagonal",
                                       "optimum disks8 --csv -"}) {
    CAPTURE(line);
    CHECK(answer(line) == answer(line));
  }
}

TEST_CASE("output: bytes of HDF5 are equal for one command in two folders") {
  const Session first, second;
  const std::string line = "sweep disks12 --epsilon 0,1e-2:1e2:9 --eta 0.3,inf --csv a.csv --hdf5 a.h5";
  first.answer(line);
  second.answer(line);
  const std::string bytes = first.read("a.h5");
  CHECK(bytes.substr(1, 3) == "HDF");
  CHECK(bytes == second.read("a.h5"));
  CHECK(first.read("a.csv") == second.read("a.csv"));
}

TEST_CASE_FIXTURE(Session, "output: HDF5 says where it comes from") {
  answer("sweep disks4 --epsilon 1 --csv a.csv --hdf5 a.h5");
  const std::string bytes = read("a.h5");
  for (const std::string& text :
       Texts{"nscdd sweep disks4 --epsilon 1 --csv a.csv --hdf5 a.h5", "generator = \"strip\"", "grid = [2, 1]", "1/kg",
             "Eigen ", "ARPACK-NG ", "HDF5 "}) {
    CAPTURE(text);
    CHECK(bytes.find(text) != std::string::npos);
  }
}

TEST_CASE_FIXTURE(Session, "output: an existing file is refused and left as it was") {
  file("old", "precious");
  check_refused("sweep disks4 --epsilon 1 --csv old", {"old: exists already", "--force"});
  check_refused("sweep disks4 --epsilon 1 --csv - --hdf5 old", {"old: exists already", "--force"});
  check_refused("network disks4 --csv old", {"old: exists already"});
  check_refused("network disks4 --csv new --grains old", {"old: exists already"});
  check_refused("optimum disks4 --csv old", {"old: exists already"});
  std::filesystem::create_symlink("missing/old", folder / "link");
  check_refused("optimum disks4 --csv link", {"link: exists already"});
}

TEST_CASE_FIXTURE(Session, "output: --force replaces an existing file") {
  file("old", "precious");
  file("old.h5", "precious");
  answer("sweep disks4 --epsilon 1 --csv old --hdf5 old.h5 --force");
  CHECK(read("old").rfind("case,", 0) == 0);
  CHECK(read("old.h5").substr(1, 3) == "HDF");
  CHECK(content_of(folder.path()).size() == 2);
}

TEST_CASE_FIXTURE(Session, "output: --force replaces no file that the work is made from") {
  file("in.csv", row_of_three());
  file("grid.toml", case_text("in.csv", "2, 1"));
  file("study/study.toml", "[[table]]\nname = \"baseline\"\ncases = \"disks4\"\nepsilon = \"1\"\n");
  file("study/baseline.csv", "precious");
  file("slow-impulses.csv", row_of_three());
  answer("generate in.csv -o in.h5");
  std::filesystem::create_hard_link(folder / "in.csv", folder / "linked.csv");
  for (const std::string line :
       {"sweep in.csv --epsilon 1 --csv ./in.csv", "sweep in.csv --epsilon 1 --csv linked.csv",
        "sweep in.h5 --epsilon 1 --csv - --hdf5 in.h5", "sweep grid.toml --epsilon 1 --csv grid.toml",
        "sweep grid.toml --epsilon 1 --csv in.csv", "network in.csv --csv in.csv", "network in.csv --grains in.csv",
        "optimum in.csv --contacts all --csv in.csv", "inspect in.csv --histogram in.csv", "generate in.csv -o in.csv",
        "generate grid.toml -o in.csv", "modes slow-impulses.csv --epsilon 1 --output slow", "run study --output ."}) {
    CAPTURE(line);
    check_refused(line + " --force", {"expected another file than the input", "would be lost"});
  }
}

TEST_CASE_FIXTURE(Session, "output: --force replaces no file of a case that is settled from, at any depth") {
  file("grains.csv", row_of_three());
  file("first.toml", case_text("grains.csv"));
  file("second.toml", "[packing]\nsettled = \"first.toml\"\n[partition]\ngrid = [1, 1]\n");
  file("third.toml", "[packing]\nsettled = \"second.toml\"\n[partition]\ngrid = [1, 1]\n");
  for (const std::string input : {"grains.csv", "first.toml", "second.toml", "third.toml"})
    check_refused("sweep third.toml --epsilon 1 --force --csv " + input, {input, "would be lost"});
}

TEST_CASE_FIXTURE(Session, "output: what was there survives a run with --force that fails") {
  file("old", "precious");
  check_refused("sweep disks4 --epsilon -1 --csv old --force", {"epsilon"});
  file("lone.csv", row_of_three());
  check_refused("sweep lone.csv --epsilon 1 --contacts active --csv old --force", {"prescribed"});
}

TEST_CASE_FIXTURE(Session, "output: the partial file of another run is refused") {
  file("a.csv.partial", "rows of another run\n");
  check_refused("sweep disks4 --epsilon 1 --csv a.csv", {"a.csv.partial", "interrupted", "--force"});
  file("a.h5.partial", "bytes of another run");
  check_refused("sweep disks4 --epsilon 1 --csv - --hdf5 a.h5", {"a.h5.partial", "interrupted"});
  answer("sweep disks4 --epsilon 1 --csv a.csv --hdf5 a.h5 --force");
  CHECK(content_of(folder.path()).size() == 2);
}

TEST_CASE_FIXTURE(Session, "output: a killed run leaves a readable partial file") {
  CHECK(killed_sweep(*this).exit_code == 128 + 9);
  CHECK(!has("long.csv"));
  const std::string partial = read("long.csv.partial");
  REQUIRE(partial.back() == '\n');  // whole lines only
  const CsvTable table = read_table(partial);
  REQUIRE(table.rows.size() > 10);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const double radius = table.number(row, "spectral_radius");
    CHECK((radius > 0 && radius < 0.66));
  }
}

TEST_CASE_FIXTURE(Session, "output: a killed run with --force destroys nothing") {
  file("long.csv", "precious");
  const std::string line = long_sweep + " --force";
  CHECK(run(line, {.signal_at = SignalAt{"long.csv.partial"}}).exit_code == 128 + 9);
  CHECK(read("long.csv") == "precious");
}

TEST_CASE_FIXTURE(Session, "output: two outputs under one name are refused") {
  check_refused("sweep disks4 --epsilon 1 --csv same --hdf5 same", {"same", "each output"});
  check_refused("sweep disks4 --epsilon 1 --csv same --hdf5 ./same --force", {"same", "each output"});
  check_refused("network disks4 --csv same --grains same --force", {"same", "each output"});
}

TEST_CASE_FIXTURE(Session, "output: an unwritable place is refused") {
  for (const std::string& place : Texts{"missing/out", "missing/deep/out", "/proc/out", "."}) {
    const std::string name(place);
    check_refused("sweep disks4 --epsilon 1 --csv " + name, {name});
    check_refused("sweep disks4 --epsilon 1 --csv out.csv --hdf5 " + name, {name});
    check_refused("network disks4 --csv " + name, {name});
    check_refused("network disks4 --csv out.csv --grains " + name, {name});
    check_refused("optimum disks4 --csv " + name, {name});
  }
  check_refused(std::vector<std::string>{"sweep", "disks4", "--epsilon", "1", "--csv", ""}, {"--csv", "empty text"});
  check_refused("run figures-2-3-4 --output /proc/out", {"/proc/out"});
  file("file", "no folder");
  check_refused("run figures-2-3-4 --output file", {"file"});
  check_refused("sweep disks4 --epsilon 1 --csv file/out", {"file/out"});
}

TEST_CASE_FIXTURE(Session, "output: a folder without permission is refused") {
  fs::create_directory(folder / "locked");
  fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
  const RunOptions options{.obey_permissions = true};
  check_refused("sweep disks4 --epsilon 1 --csv locked/out", {"locked/out", "Permission denied"}, options);
  check_refused("sweep disks4 --epsilon 1 --csv out.csv --hdf5 locked/out", {"locked/out"}, options);
  check_refused("run figures-2-3-4 --output locked", {"locked"}, options);
  fs::permissions(folder / "locked", fs::perms::owner_all);
}

TEST_CASE_FIXTURE(Session, "output: a pipe is written to and stays a pipe") {
  // A link stands for the device: were the program to replace what it writes to, only the link would be lost.
  fs::create_symlink("/dev/null", folder / "sink");
  answer("sweep disks4 --epsilon 1 --csv sink --hdf5 out.h5");
  answer("network disks4 --csv sink --grains sink");
  CHECK(fs::is_symlink(folder / "sink"));
  const Outcome outcome = run("sweep disks4 --epsilon 1 --csv out.csv --hdf5 sink");
  CHECK(fs::is_symlink(folder / "sink"));
  CHECK(fs::is_character_file(folder / "sink"));
  CHECK((outcome.exit_code == 0 || outcome.exit_code == 2));  // written to, or refused as no place for HDF5
}
