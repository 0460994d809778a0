// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that fills up: an error and an exit code, and nothing half-written.
#include "session.hpp"

#include <filesystem>
#include <sstream>

using namespace nscdd::testing;

namespace {

// Links, so that a program that replaced what it writes to would cost the link and not the device.
struct DeviceSession : Session {
  DeviceSession() {
    std::filesystem::create_symlink("/dev/full", folder / "full");
    std::filesystem::create_symlink("/dev/null", folder / "sink");
  }
};

RunOptions limited_to(std::size_t bytes) { return {.largest_file = bytes}; }

}  // namespace

TEST_CASE_FIXTURE(DeviceSession, "full disk: CSV and HDF5 to a full device") {
  check_refused("sweep disks4 --epsilon 1 --csv full", {"full", "No space left"});
  check_refused("network disks4 --csv full", {"full", "No space left"});
  check_refused("network disks4 --csv out.csv --grains full --force", {"full", "No space left"});
  check_refused("optimum disks4 --csv full", {"full", "No space left"});
  check_refused("sweep disks4 --epsilon 1 --csv sink --hdf5 full", {"full"});
}

TEST_CASE_FIXTURE(DeviceSession, "full disk: standard output to a full device") {
  const RunOptions options = {.standard_output = folder / "full"};
  for (const std::string& line :
       Texts{"sweep disks4 --epsilon 1 --csv -", "sweep disks4 --epsilon 1e-3:1e3:5000 --csv -", "network disks4",
             "inspect disks4", "optimum disks4", "list", "run figures-2-3-4 --force", "--help", "sweep --help",
             "--version"}) {
    CAPTURE(line);
    const Outcome outcome = ended(2, line, {"No space left"}, options);
    CHECK(outcome.standard_error.rfind("nscdd: error: ", 0) == 0);
  }
}

TEST_CASE_FIXTURE(DeviceSession, "full disk: errors keep their exit code where standard error is full too") {
  const RunOptions options{.standard_error = folder / "full"};
  CHECK(run("sweep disks4 --epsilon -1 --csv -", options).exit_code == 2);
  CHECK(run("sweep nothing --epsilon 1 --csv -", options).exit_code == 2);
  CHECK(run("nonsense", options).exit_code == 2);
  CHECK(run("sweep disks4 --epsilon 1 --csv -", options).exit_code == 0);
}

TEST_CASE_FIXTURE(Session, "full disk: a CSV file that outgrows the disk") {
  for (const std::size_t bytes : {0U, 100U, 4096U}) {
    CAPTURE(bytes);
    check_refused("sweep disks4 --epsilon 1e-3:1e3:100 --csv out.csv", {"out.csv", "File too large"},
                  limited_to(bytes));
  }
}

TEST_CASE_FIXTURE(DeviceSession, "full disk: an HDF5 file that outgrows the disk") {
  // Small, and just short of the whole file: the library writes some of it on closing only.
  for (const std::size_t bytes : {0U, 512U, 4096U, 8192U, 12288U, 15000U}) {
    CAPTURE(bytes);
    check_refused("sweep disks4 --epsilon 1 --csv sink --hdf5 out.h5", {"out.h5"}, limited_to(bytes));
  }
  // One that exists already survives.
  file("out.h5", "precious");
  check_refused("sweep disks4 --epsilon 1 --csv sink --hdf5 out.h5 --force", {"out.h5"}, limited_to(8192));
}

TEST_CASE_FIXTURE(Session, "full disk: a study that outgrows the disk leaves no part of a file") {
  for (const std::size_t bytes : {1000U, 20'000U, 80'000U}) {
    CAPTURE(bytes);
    const Outcome outcome = ended(2, "run figure-7 --force", {}, limited_to(bytes));
    CHECK(outcome.standard_output == "");
    CHECK(outcome.standard_error.rfind("nscdd: error: ", 0) == 0);
    CHECK(!has("results/figure-7/figure-7.h5"));
    for (const auto& [name, content] : content_of(folder.path())) CHECK(!contains(name, ".partial"));
  }
}

TEST_CASE_FIXTURE(Session, "full disk: a run that goes on keeps no step whose rows the table could not take") {
  const std::string run =
      "simulate settle-1k --algorithm generic --subdomains 2x1 --criterion none --iterations 4000 "
      "--convergence-every 1 --save-every 100 --convergence run.csv -o run.h5 --steps ";
  answer(run + "2");
  const auto begun = std::filesystem::file_size(folder / "run.csv");
  REQUIRE(begun > std::filesystem::file_size(folder / "run.h5"));
  ended(2, run + "9 --restart", {"run.csv"}, limited_to(begun + begun / 4));
  answer(run + "4 --restart");
  const std::string in_pieces = read("run.csv");
  answer(run + "4 --force");
  // Rows end with the seconds.
  const auto without_seconds = [](const std::string& table) {
    std::istringstream lines(table);
    std::string kept;
    for (std::string line; std::getline(lines, line);) kept += line.substr(0, line.rfind(',')) + "\n";
    return kept;
  };
  CHECK(without_seconds(in_pieces) == without_seconds(read("run.csv")));
}
