// SPDX-License-Identifier: GPL-3.0-or-later
// --scheme schwarz of the verbs of the linear study.
#include "session.hpp"

#include <algorithm>
#include <cmath>

using namespace nscdd::testing;

TEST_CASE_FIXTURE(Session, "schwarz: 4 disks have 1/sqrt 5, and with sweeps what the prototype has") {
  const CsvTable result = read_table(
      run("sweep disks4 --scheme schwarz --epsilon 0 --gauss-seidel-sweeps 1,10,inf --csv -").standard_output);
  CHECK(std::abs(result.number(0, "spectral_radius") - 0.453217) < 1e-6);
  CHECK(std::abs(result.number(1, "spectral_radius") - 0.447214) < 1e-6);
  CHECK(std::abs(result.number(2, "spectral_radius") - 1 / std::sqrt(5.0)) < 1e-12);
  CHECK((result.columns.back() == "scheme" && result.text(2, "scheme") == "schwarz"));
  const CsvTable plain = table("sweep disks4 --epsilon 0");
  CHECK(std::count(plain.columns.begin(), plain.columns.end(), "scheme") == 0);
  CHECK(read_table(answer("sweep disks4 --scheme nscdd --epsilon 0 --csv -")).columns == plain.columns);
}

TEST_CASE_FIXTURE(Session,
                  "schwarz: a divergent row is a result with a note, and optimum has the relaxation that repairs it") {
  const std::string deposit = "deposit --set packing.grains=500 --set packing.seed=3 --subdomains 2x2 --scheme schwarz";
  const Outcome met = ended(0, "sweep " + deposit + " --epsilon 0,0.01W --certify --csv radii.csv",
                            {"schwarz diverges with the relaxation 1"});
  const std::string warning =
      "3 subdomains share a body, and schwarz may not converge with a relaxation of 0.667 or more";
  CHECK(contains(met.standard_error, warning + ", met 1\n"));
  CHECK_FALSE(contains(run("sweep " + deposit + " --epsilon 0 --relaxation 0.66 --csv -").standard_error, warning));
  const std::string two_copies = "sweep disks8 --scheme schwarz --csv - --epsilon ";
  CHECK(contains(run(two_copies + "0").standard_error, "2 subdomains share a body"));
  answer(two_copies + "0.1");  // without a note
  const std::string study = "\"\ncases = \"disks8\"\nscheme = \"schwarz\"\nepsilon = \"0\"\n";
  file("study/study.toml", "[[table]]\nname = \"one" + study + "[[table]]\nname = \"two" + study);
  const std::string told = run("run study").standard_error;
  CHECK((contains(told, "2 subdomains share a body") && told.find("share") == told.rfind("share")));
  const CsvTable radii = csv("radii.csv");
  CHECK(std::abs(radii.number(0, "spectral_radius") - 1.477011) < 1e-6);
  CHECK(std::abs(radii.number(1, "spectral_radius") - 1.383058) < 1e-6);
  CHECK(radii.text(0, "certified") == "true");
  const CsvTable best = table("optimum " + deposit + " --epsilon 0 --contacts all");
  const double low = 1 - radii.number(0, "eigenvalue_max"), high = 1 - radii.number(0, "eigenvalue_min");
  CHECK(std::abs(best.number(0, "best_relaxation") - 2 / (low + high)) < 1e-9);
  CHECK(std::abs(best.number(0, "convergent_below") - 2 / high) < 1e-9);
  CHECK(std::abs(best.number(0, "best_radius") - (high - low) / (high + low)) < 1e-9);
  CHECK(best.text(0, "status") == "interior");
}

TEST_CASE_FIXTURE(Session, "schwarz: a mode is a vector of resultants, whose shares add up to 1") {
  const std::string report = answer("modes hexagonal --scheme schwarz --epsilon 0.1 --output slow");
  CHECK(contains(report, "scheme               schwarz"));
  const CsvTable impulses = csv("slow-impulses.csv"),
                 radii = read_table(run("sweep hexagonal --scheme schwarz --epsilon 0.1 --csv -").standard_output);
  double share = 0;
  for (std::size_t row = 0; row < impulses.rows.size(); ++row) {
    share += impulses.number(row, "share");
    CHECK(impulses.number(row, "subdomain_second") == -1);
  }
  CHECK(std::abs(share - 1) < 1e-12);
  CHECK(std::abs(std::abs(impulses.number(0, "eigenvalue")) - radii.number(0, "spectral_radius")) < 1e-12);
  answer("report disks8 --scheme schwarz -o page.html");
  CHECK(contains(read("page.html"), "\"scheme\":\"schwarz\""));
}

TEST_CASE_FIXTURE(Session, "schwarz: what has no meaning with it is refused by name") {
  const auto refused = [&](const std::string& line, const std::string& words) {
    CAPTURE(line);
    ended(2, line, {words});
  };
  const std::string sweep = "sweep disks8 --scheme schwarz --csv - --epsilon ";
  refused(sweep + "1 --eta 0.3", "--eta: expected none with --scheme schwarz, which has no Stage 2, met 0.3");
  refused(sweep + "-1", "epsilon");
  refused(sweep + "1 --solver arpack", "--solver: expected auto, dense or shift-invert with --scheme schwarz");
  refused(sweep + "1 --eta 1e-3:1e3 --curve 1e-3", "--eta: expected none with --scheme schwarz");
  refused("modes disks8 --scheme schwarz --epsilon 1 --eta 2 --output a", "--eta: expected none");
  refused("report disks8 --scheme schwarz --eta 2 -o page.html", "--eta: expected none");
  refused("sweep disks8 --scheme additive --epsilon 1 --csv -", "schwarz");
  const Outcome empty = run("sweep disks8 --subdomains 1x1 --scheme schwarz --epsilon 1 --csv -");
  CHECK((empty.exit_code == 0 && contains(empty.standard_output, ",0,nan,nan,0,0,")));
}

TEST_CASE_FIXTURE(Session, "schwarz: a run that does not converge warns of a relaxation that may diverge") {
  const std::string run =
      "simulate shear-1k --scheme schwarz --subdomains 2x2 --steps 1 --iterations 2 --force -o run.h5 ";
  const std::string words =
      "3 subdomains share a body, and schwarz may diverge with an interface_relaxation of 0.667 or more, met ";
  CHECK(contains(answer(run), words + "1\n"));
  CHECK(contains(answer(run + "--set solver.interface_relaxation=0.7"), words + "0.7\n"));
  CHECK_FALSE(contains(answer(run + "--set solver.interface_relaxation=0.66"), "subdomains share a body"));
  ended(1, "simulate shear-1k --algorithm schwarz --subdomains 4x4 --set solver.gauss_seidel_sweeps=20 -o b.h5",
        {"interface_relaxation of 2 / q or more"});
}
