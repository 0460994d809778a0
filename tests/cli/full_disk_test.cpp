// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that fills up: an error and an exit code, and nothing half-written.
#include "session.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <sstream>

using namespace nscdd::testing;

namespace {

// Links, so that a program that replaced what it writes to would cost the link and not the device.
void link_devices(const Session& session) {
  std::filesystem::create_symlink("/dev/full", session.folder / "full");
  std::filesystem::create_symlink("/dev/null", session.folder / "sink");
}

RunOptions limited_to(std::size_t bytes) {
  RunOptions options;
  options.largest_file = bytes;
  return options;
}

RunOptions printing_to_full_device(const Session& session) {
  RunOptions options;
  options.standard_output = session.folder / "full";
  return options;
}

}  // namespace

TEST_CASE("full disk: CSV to a full device") {
  const Session session;
  link_devices(session);
  check_refused(session, "sweep disks4 --epsilon 1 --csv full", {"full", "No space left"});
  check_refused(session, "network disks4 --csv full", {"full", "No space left"});
  check_refused(session, "network disks4 --csv out.csv --grains full --force", {"full", "No space left"});
  check_refused(session, "optimum disks4 --csv full", {"full", "No space left"});
}

TEST_CASE("full disk: HDF5 to a full device") {
  const Session session;
  link_devices(session);
  check_refused(session, "sweep disks4 --epsilon 1 --csv sink --hdf5 full", {"full"});
}

TEST_CASE("full disk: standard output to a full device") {
  const Session session;
  link_devices(session);
  const RunOptions options = printing_to_full_device(session);
  for (const std::string& line :
       Texts{"sweep disks4 --epsilon 1 --csv -", "sweep disks4 --epsilon 1e-3:1e3:5000 --csv -", "network disks4",
             "inspect disks4", "optimum disks4", "list", "run figures-2-3-4 --force", "--help", "sweep --help",
             "--version"}) {
    CAPTURE(line);
    const Outcome outcome = session.run(words(line), options);
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.standard_error.rfind("nscdd: error: ", 0) == 0);
    CHECK(outcome.standard_error.find("No space left") != std::string::npos);
  }
}

TEST_CASE("full disk: errors keep their exit code where standard error is full too") {
  const Session session;
  link_devices(session);
  RunOptions options;
  options.standard_error = session.folder / "full";
  CHECK(session.run(words("sweep disks4 --epsilon -1 --csv -"), options).exit_code == 2);
  CHECK(session.run(words("sweep nothing --epsilon 1 --csv -"), options).exit_code == 2);
  CHECK(session.run(words("nonsense"), options).exit_code == 2);
  CHECK(session.run(words("sweep disks4 --epsilon 1 --csv -"), options).exit_code == 0);
}

TEST_CASE("full disk: a CSV file that outgrows the disk") {
  const Session session;
  for (const std::size_t bytes : {0, 100, 4096}) {
    CAPTURE(bytes);
    check_refused(session, "sweep disks4 --epsilon 1e-3:1e3:100 --csv out.csv", {"out.csv", "File too large"},
                  limited_to(bytes));
  }
}

TEST_CASE("full disk: an HDF5 file that outgrows the disk") {
  const Session session;
  link_devices(session);
  // Small, and just short of the whole file: the library writes some of it on closing only.
  for (const std::size_t bytes : {0, 512, 4096, 8192, 12288, 15000}) {
    CAPTURE(bytes);
    check_refused(session, "sweep disks4 --epsilon 1 --csv sink --hdf5 out.h5", {"out.h5"}, limited_to(bytes));
  }
}

TEST_CASE("full disk: an existing HDF5 file survives") {
  const Session session;
  link_devices(session);
  session.file("out.h5", "precious");
  check_refused(session, "sweep disks4 --epsilon 1 --csv sink --hdf5 out.h5 --force", {"out.h5"}, limited_to(8192));
}

TEST_CASE("full disk: a study that outgrows the disk leaves no part of a file") {
  const Session session;
  for (const std::size_t bytes : {1000, 20'000, 80'000}) {
    CAPTURE(bytes);
    const Outcome outcome = session.run(words("run figure-7 --force"), limited_to(bytes));
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.standard_output == "");
    CHECK(outcome.standard_error.rfind("nscdd: error: ", 0) == 0);
    CHECK(!session.has("results/figure-7/figure-7.h5"));
    for (const auto& [name, content] : content_of(session.folder.path()))
      CHECK(name.find(".partial") == std::string::npos);
  }
}

TEST_CASE("full disk: a run that goes on keeps no step whose rows the table could not take") {
  const Session session;
  const std::string run =
      "simulate settle-1k --algorithm generic --subdomains 2x1 --criterion none --iterations 4000 "
      "--convergence-every 1 --save-every 100 --convergence run.csv -o run.h5 --steps ";
  answer(session, run + "2");
  const auto begun = std::filesystem::file_size(session.folder / "run.csv");
  REQUIRE(begun > std::filesystem::file_size(session.folder / "run.h5"));
  const Outcome full = session.run(words(run + "9 --restart"), limited_to(begun + begun / 4));
  CHECK(full.exit_code == 2);
  CHECK(full.standard_error.find("run.csv") != std::string::npos);
  answer(session, run + "4 --restart");
  const std::string in_pieces = session.read("run.csv");
  answer(session, run + "4 --force");
  // Rows end with the seconds.
  const auto without_seconds = [](const std::string& table) {
    std::istringstream lines(table);
    std::string kept;
    for (std::string line; std::getline(lines, line);) kept += line.substr(0, line.rfind(',')) + "\n";
    return kept;
  };
  CHECK(without_seconds(in_pieces) == without_seconds(session.read("run.csv")));
}
