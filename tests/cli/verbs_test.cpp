// SPDX-License-Identifier: GPL-3.0-or-later
// The verbs beside sweep and run: network, inspect, optimum, generate, list, and the help of all.
#include "../support/fclib_files.hpp"
#include "session.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>

using namespace nscdd::testing;

namespace {

const std::vector<std::string> verbs{"sweep", "run",      "network",  "inspect", "optimum", "coarse", "modes",
                                     "list",  "generate", "simulate", "export",  "solve",   "report", "manual"};

// What follows a name at the start of a line of a report.
std::string entry(const std::string& report, const std::string& name) {
  std::istringstream stream(report);
  for (std::string line; std::getline(stream, line);)
    if (line.rfind(name, 0) == 0) {
      const auto start = line.find_first_not_of(' ', name.size());
      return start == std::string::npos ? "" : line.substr(start);
    }
  return "(no such line)";
}

// The examples in a help text, without "nscdd" and without the remark that follows blanks.
std::vector<std::string> examples(const std::string& help) {
  std::vector<std::string> all;
  std::istringstream stream(help.substr(std::min(help.find("Examples:"), help.size())));
  for (std::string line; std::getline(stream, line);)
    if (line.rfind("  nscdd ", 0) == 0) all.push_back(line.substr(8, line.find("   ", 8) - 8));
  return all;
}

}  // namespace

TEST_CASE_FIXTURE(Session, "--version names the program and its version") {
  const std::string text = answer("--version");
  CHECK(text.rfind("nscdd ", 0) == 0);
  CHECK(contains(text, "."));
}

TEST_CASE_FIXTURE(Session, "--help names every verb and the exit codes and gives examples") {
  const std::string text = answer("--help");
  for (const std::string& verb : verbs) CHECK(contains(text, "\n  " + verb + " "));
  CHECK(contains(text, "Exit codes"));
  CHECK(!examples(text).empty());
}

TEST_CASE_FIXTURE(Session, "the program alone, help and help VERB are --help") {
  CHECK(answer(Texts{}) == answer("--help"));
  CHECK(answer("help") == answer("--help"));
  CHECK(answer("help sweep") == answer("sweep --help"));
  check_refused("help sweeep", {"did you mean sweep?"});
  CHECK(contains(answer("help sweep"), "--csv FILE"));
}

TEST_CASE_FIXTURE(Session, "VERB --help gives examples and fits on a screen") {
  for (const std::string& verb : verbs) {
    CAPTURE(verb);
    const std::string text = answer({verb, "--help"});
    CHECK(contains(text, "Usage: nscdd " + verb));
    CHECK(!examples(text).empty());
    std::istringstream help(text);
    int lines = 0;
    for (std::string line; std::getline(help, line); ++lines) CHECK(line.size() <= 110);
    CHECK(lines <= 40);
  }
}

TEST_CASE_FIXTURE(Session, "manual pages and the completion name every option of every verb") {
  answer("manual pages");
  const std::string completion = read("pages/bash-completion/nscdd");
  for (const std::string& verb : verbs) {
    CAPTURE(verb);
    const std::string page = read("pages/man1/nscdd-" + verb + ".1");
    CHECK(page.rfind(".TH", 0) == 0);
    std::istringstream help(answer({verb, "--help"}));
    int named = 0;
    for (std::string line; std::getline(help, line);) {
      const auto start = line.find("--");
      if (line.rfind("  -", 0) != 0 || start == std::string::npos) continue;
      const std::string name = line.substr(start, line.find_first_of(" \n", start) - start);
      CAPTURE(name);
      CHECK(contains(completion, name));
      std::string in_troff;
      for (const char c : name) in_troff += c == '-' ? std::string("\\-") : std::string(1, c);
      if (name != "--help") CHECK(contains(page, in_troff));
      ++named;
    }
    CHECK(named > 0);
  }
}

TEST_CASE_FIXTURE(Session, "the examples of the help work") {
  // Eight disks of a lattice, for the examples that speak of a packing of the user's.
  std::string packing = "x,y,radius\n";
  for (const std::string& y : Texts{"0", "1"})
    for (const std::string& x : Texts{"0", "1", "2", "3"}) packing += x + "," + y + ",0.5\n";
  file("mine.csv", packing);
  file("problems/mine.hdf5", raw_global(random_bodies_problem(4, 12, 20)).bytes());
  std::filesystem::create_directory(folder / "cases");
  file("cases/shear-1k.toml", moving_case());  // found before the one of the paper, which takes long
  std::string help = answer("--help");
  for (const std::string& verb : verbs) help += answer({verb, "--help"});
  std::istringstream stream(help);
  int tried = 0;
  for (const std::string& example : examples(help)) {
    if (example.rfind("run ", 0) == 0) continue;  // studies have tests of their own
    CAPTURE(example);
    const Outcome outcome = ended(0, example);
    CHECK(outcome.standard_error == "");
    ++tried;
  }
  CHECK(tried >= 20);
}

TEST_CASE_FIXTURE(Session, "network: the links of 4 disks") {
  const CsvTable links = table("network disks4");
  REQUIRE(links.rows.size() == 5);
  const std::vector<std::string> pairs{"0 1", "0 2", "1 2", "1 3", "2 3"};
  const std::vector<double> impulses{3.0 / 16, 1.0 / 16, -4.0 / 16, 9.0 / 16, 3.0 / 16};
  for (std::size_t row = 0; row < 5; ++row) {
    CAPTURE(row);
    CHECK(links.text(row, "grain_a") + " " + links.text(row, "grain_b") == pairs[row]);
    CHECK(std::abs(std::hypot(links.number(row, "normal_x"), links.number(row, "normal_y")) - 1) < 1e-14);
    CHECK(std::abs(links.number(row, "impulse") - impulses[row]) < 1e-12);
    CHECK(links.text(row, "active") == (impulses[row] > 0 ? "true" : "false"));
    CHECK(links.text(row, "subdomain") == (row < 3 ? "0" : "1"));
    CHECK(links.text(row, "impulse_solution") == "unique");
  }
  CHECK(table("network hexagonal").text(0, "impulse_solution") == "least_norm");  // it is hyperstatic
}

TEST_CASE_FIXTURE(Session, "network: grains go to a file of their own") {
  answer("network disks4 --csv links.csv --grains grains.csv");
  CHECK(csv("links.csv").rows.size() == 5);
  const CsvTable grains = csv("grains.csv");
  REQUIRE(grains.rows.size() == 4);
  for (std::size_t row = 0; row < 4; ++row)
    CHECK(grains.text(row, "multiplicity") == (row == 1 || row == 2 ? "2" : "1"));
  CHECK(grains.number(3, "velocity_x") == -1);
}

TEST_CASE_FIXTURE(Session, "network: impulses of the unilateral problem of 4 disks") {
  const Outcome outcome = ended(0, "network disks4 --contacts unilateral", {"1 of 5 contacts are weakly active"});
  const CsvTable links = read_table(outcome.standard_output);
  REQUIRE(links.rows.size() == 5);
  // contact 1 2 opens, contact 0 2 is weakly active; the others carry what grain 3 brings
  double pushed = 0;
  for (std::size_t row = 0; row < 5; ++row) {
    CAPTURE(row);
    CHECK(links.number(row, "impulse") >= 0);
    CHECK(links.text(row, "active") == (links.number(row, "impulse") > 1e-7 ? "true" : "false"));
    CHECK(links.text(row, "impulse_solution") == "unilateral_unique");
    if (links.text(row, "grain_b") == "3") pushed += links.number(row, "impulse") * links.number(row, "normal_x");
  }
  CHECK(pushed > 0);
  CHECK(pushed < 1);  // grain 3 arrives with 1 kg m/s and goes on more slowly
  const CsvTable compressed = table("network hexagonal --contacts unilateral --set loads.compression=1,1");
  CHECK(compressed.text(0, "impulse_solution") == "unilateral_maximal");
  CHECK(table("network disks4").text(2, "active") == "false");
}

TEST_CASE_FIXTURE(Session, "sweep, optimum and run take the unilateral contacts") {
  const CsvTable swept = table("sweep disks4 --epsilon 0 --contacts unilateral");
  CHECK(swept.text(0, "contact_set") == "unilateral");
  CHECK(swept.text(0, "contact_rule") == "complementarity (unique)");
  CHECK(swept.number(0, "active_contacts") == 3);
  CHECK(swept.text(0, "converged") == "true");
  const CsvTable best = table("optimum disks4 --contacts unilateral");
  CHECK(best.text(0, "contact_set") == "unilateral");
  CHECK(
      table("sweep hexagonal --epsilon 0 --contacts unilateral --set loads.compression=1,1").text(0, "contact_rule") ==
      "complementarity (maximal)");
  file("mine/study.toml",
       "[[table]]\nname = \"radius\"\ncases = \"disks4\"\nepsilon = 0\ncontacts = \"unilateral\"\n"
       "[[table]]\nname = \"links\"\nobservable = \"links\"\ncases = \"disks4\"\n"
       "contacts = \"unilateral\"\n");
  answer("run mine");
  CHECK(csv("results/mine/radius.csv").number(0, "spectral_radius") == swept.number(0, "spectral_radius"));
  CHECK(csv("results/mine/links.csv").text(0, "impulse_solution") == "unilateral_unique");
}

TEST_CASE_FIXTURE(Session, "inspect: counts and interface and ranks of 12 disks") {
  const std::string report = answer("inspect disks12");
  CHECK(entry(report, "grains ") == "12");
  CHECK(entry(report, "contacts ") == "21");
  CHECK(entry(report, "coordination number") == "3.5");
  CHECK(entry(report, "connected pieces") == "1");
  CHECK(entry(report, "interface unknowns") == "4");
  CHECK(entry(report, "  grains shared by 2") == "2");
  // grains, contacts, rank W, rigid modes, hyperstaticity
  CHECK(words(entry(report, "whole")) == words("12 21 21 3 0"));
  CHECK(words(entry(report, "0 ")).size() == 5);
  CHECK(words(entry(report, "1 ")).size() == 5);
}

TEST_CASE_FIXTURE(Session, "inspect: a chain is made of rattlers, and no number is given without them") {
  file("chain.csv", row_of_three());
  CHECK(contains(answer("inspect chain.csv"), "coordination number without them  - (every grain is one)"));
}

TEST_CASE_FIXTURE(Session, "inspect: hyperstaticity of a lattice") {
  const std::string report = answer("inspect hexagonal");
  // 8 x 8 disks: 7 x 8 + 7 x 15 = 161 contacts, 128 unknowns, 3 rigid modes
  CHECK(words(entry(report, "whole")) == words("64 161 125 3 36"));
  CHECK(contains(report, "grains shared by 4"));
}

TEST_CASE_FIXTURE(Session, "inspect and network: a case that moves may overlap as its simulation accepts") {
  file("pair.csv", "x,y,radius,mass\n0,0,1,1\n1.93,0,1,1\n");
  file("pair.toml", case_text("pair.csv", "1, 1", "[dynamics]\nsteps = 1\n"));
  answer("simulate pair.toml -o run.h5");
  CHECK(std::stod(entry(answer("inspect pair.toml"), "largest overlap")) == doctest::Approx(0.07));
  CHECK(table("network pair.toml --prescribed 0:1:0").number(0, "gap") == doctest::Approx(-0.07));
  check_refused("inspect pair.csv", {"overlap by 0.07", "overlap_tolerance"});  // nothing moves it
  check_refused("inspect pair.toml --overlap-tolerance 0.01", {"overlap by 0.07"});
  CHECK(!contains(answer("inspect disks12"), "overlap"));
}

TEST_CASE_FIXTURE(Session, "sweep, optimum, modes and inspect say why an interface is empty") {
  std::string pairs = "x,y,radius\n";  // six pairs of disks, far from each other
  for (int x = 0; x < 60; x += 10) pairs += std::to_string(x) + ",0,0.5\n" + std::to_string(x + 1) + ",0,0.5\n";
  file("pairs.csv", pairs);
  const std::string why =
      "3 subdomains, no shared grain; the network has 6 separate pieces, and the partition cuts none of them";
  CHECK(contains(answer("inspect pairs.csv --subdomains metis:3"), why));
  for (const std::string line : {"sweep pairs.csv --subdomains metis:3 --epsilon 1 --csv -",
                                 "modes pairs.csv --subdomains metis:3 --epsilon 1 --output slow",
                                 "optimum pairs.csv --subdomains metis:3 --contacts all --csv -"}) {
    ended(0, line, {why});
  }
  CHECK(contains(answer("inspect disks12 --subdomains 1x1"), "(empty interface: one subdomain; --subdomains metis:2,"));
}

TEST_CASE_FIXTURE(Session, "optimum: report and table, with a row per epsilon, agree") {
  const std::string report = answer("optimum disks4");
  const CsvTable row = table("optimum disks4");
  REQUIRE(row.rows.size() == 1);
  CHECK(entry(report, "best_eta").rfind(row.text(0, "best_eta"), 0) == 0);
  CHECK(std::abs(row.number(0, "generic_radius") - 0.6) < 1e-12);
  CHECK(row.number(0, "best_radius") < 0.6);
  // the table of the sweep at that eta says the same, and its ends are equal and opposite
  const CsvTable swept = table("sweep disks4 --contacts active --epsilon 0 --eta " + row.text(0, "best_eta"));
  CHECK(std::abs(swept.number(0, "spectral_radius") - row.number(0, "best_radius")) < 1e-9);
  CHECK(std::abs(swept.number(0, "eigenvalue_min") + swept.number(0, "eigenvalue_max")) < 1e-9);
  CHECK(table("optimum disks8 --epsilon 0,1 --contacts all").rows.size() == 2);
}

TEST_CASE_FIXTURE(Session, "list: cases and studies and generators and partitioners and observables, or names alone") {
  CHECK(contains("\n" + answer("list --names cases"), "\ndisks4\n"));
  CHECK(contains("\n" + answer("list --names studies"), "\nfigure-5\n"));
  const std::string text = answer("list");
  for (const std::string& name : Texts{"disks4", "disks8", "disks12", "figure-5", "figure-6", "figure-7", "strip",
                                       "hexagonal", "grid", "metis", "deposit", "packing.fraction_large = 0.5",
                                       "packing.vacancies = 0", "spectral_radius", "contacts.tolerance"}) {
    CAPTURE(name);
    CHECK(contains(text, name));
  }
}
