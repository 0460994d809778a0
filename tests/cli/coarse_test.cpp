// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd coarse: numbers of an independent program (SciPy), refusals, and tables that go on.
#include "session.hpp"

#include <cmath>
#include <map>

using namespace nscdd::testing;

TEST_CASE_FIXTURE(Session, "coarse: vectors of GenEO, ranks and bounds are those of an independent program") {
  const std::map<std::string, std::string> networks{
      {"deposit", "deposit --set packing.grains=2000 --set packing.seed=3"},
      {"lattice", "hexagonal --set packing.columns=50 --set packing.rows=40"},
      {"vacant",
       "hexagonal --set packing.columns=50 --set packing.rows=50 --set packing.vacancies=0.2 --set packing.seed=1"}};
  const CsvTable references = read_table(read_file(source_folder() / "tests/oracle/coarse_modes.csv"));
  REQUIRE(references.rows.size() == 24);
  for (std::size_t k = 0; k < references.rows.size(); k += 4) {
    const std::string network = references.text(k, "network"), scaling = references.text(k, "scaling");
    const CsvTable found =
        table("coarse " + networks.at(network) + " --subdomains 4x4 --coarse-space geneo --scaling " + scaling +
              " --epsilon 1e-6W,1e-4W,1e-3W,1e-2W");
    for (std::size_t row = 0; row < 4; ++row) {
      INFO(network, " ", scaling, " ", row);
      CHECK(found.number(row, "epsilon_relative") == doctest::Approx(references.number(k + row, "epsilon_over_w")));
      for (const char* column : {"rank_x0", "modes_30", "modes_100", "any_30", "any_100"})
        CHECK(found.number(row, column) == references.number(k + row, column));
      const double primal = found.number(row, "primal_dofs");  // below the threshold may be more vectors, dependent
      CHECK(found.number(row, "modes") == std::min(references.number(k + row, "safe"), primal));
      CHECK(found.number(row, "rank_x0") + found.number(row, "self_stresses") == found.number(row, "interface_dofs"));
      CHECK((found.number(row, "kappa") <= found.number(row, "bound") && found.text(row, "certified") == "true"));
      CHECK(std::abs(found.number(row, "predicted") - found.number(row, "iterations")) <= 2);
    }
  }
}

TEST_CASE_FIXTURE(Session, "coarse: rigid motions cure a lattice, in the plane, in a periodic cell and in space") {
  const std::string lattice = "coarse hexagonal --set packing.columns=24 --set packing.rows=24 ",
                    periodic = lattice + "--set contacts.period_x=24 ";
  for (const std::string& one : Texts{lattice + "--subdomains 4x4", periodic + "--subdomains 4x4", "coarse fcc.toml"}) {
    CAPTURE(one);
    file("fcc.toml",
         "[packing]\ngenerator = \"fcc\"\ncolumns = 6\nrows = 6\nlayers = 6\nradius = 0.5\n[masses]\nmodel = "
         "\"unit\"\n[partition]\ngrid = [2, 2, 2]\n");
    const CsvTable table =
        read_table(answer(one + " --coarse-space none,rigid --scaling deluxe --epsilon 1e-8W --csv -"));
    CHECK(table.number(0, "kappa") > 1e5);
    CHECK((table.number(1, "kappa") < 10 && table.number(1, "iterations") < 40));
    CHECK(table.text(0, "certified") == "true");
  }
  const std::string all =
      "coarse deposit --set packing.grains=1000 --subdomains 3x3 --epsilon 1e-8W --coarse-space geneo ";
  CHECK(read_table(answer(all + "--scaling multiplicity --csv -")).text(0, "certified") == "true");
  // Layers touch their own images and do not turn: 8 translations, which two relations make dependent.
  CHECK(read_table(answer(periodic + "--subdomains 1x4 --coarse-space rigid --csv -")).number(0, "modes") == 6);
}

TEST_CASE_FIXTURE(Session, "coarse: X and X_eta are those of the sweep, and counts are those of the network") {
  const std::string line =
      "coarse hexagonal --epsilon 0.01,1 --preconditioner X,X_eta,lumped,dirichlet --scaling multiplicity ";
  answer(line + "--csv whole.csv");
  const CsvTable table = csv("whole.csv");
  REQUIRE(table.rows.size() == 10);
  const CsvTable sweep = read_table(answer("sweep hexagonal --epsilon 0.01 --eta 0.1,inf --csv -"));
  for (const auto& [row, of_sweep] : {std::pair{0, 1}, {1, 0}}) {
    const auto at = [&](const CsvTable& t, int r, const char* name) { return t.number(std::size_t(r), name); };
    CHECK(std::abs(1 - at(table, row, "eigenvalue_low") - at(sweep, of_sweep, "eigenvalue_max")) < 1e-9);
    CHECK(std::abs(1 - at(table, row, "eigenvalue_high") - at(sweep, of_sweep, "eigenvalue_min")) < 1e-9);
  }
  CHECK(contains(answer("coarse disks4 --counts"), "rank of X_0         4"));
  // Factors of few disks are dense: those of 5, 5 and 8.
  const CsvTable counts = this->table("coarse disks8 --counts --epsilon 1");
  CHECK((counts.number(0, "local_entries") == 2 * 55 && counts.number(0, "undivided_entries") == 136));
  CHECK(counts.number(0, "local_flops") == doctest::Approx(2 * 1000. / 3));
  CHECK(counts.number(0, "undivided_flops") == doctest::Approx(4096. / 3));
  ended(2, line + "--csv whole.csv", {"whole.csv", "--force"});
}

TEST_CASE_FIXTURE(Session, "coarse: a threshold is that of a wanted condition number, and its vectors are coupled") {
  const std::string line = "coarse hexagonal --subdomains 3x3 --epsilon 1e-3W --scaling deluxe --coarse-space geneo ";
  const CsvTable wanted = table(line + "--kappa 10");
  const std::string threshold = wanted.text(0, "threshold");
  CHECK(table(line + "--threshold " + threshold).rows == wanted.rows);
  CHECK((wanted.number(0, "bound") == doctest::Approx(10) && wanted.number(0, "kappa") < 10));
  const double modes = wanted.number(0, "modes");
  CHECK((modes > 2 && wanted.number(0, "coarse_entries") == modes * (modes + 1) / 2));
  const CsvTable fewer = table(line + "--threshold 0.3");
  CHECK((fewer.number(0, "modes") < modes && fewer.number(0, "bound") > 10));
}

TEST_CASE_FIXTURE(Session, "coarse: active contacts, and subdomains in pieces") {
  const CsvTable active = read_table(answer(
      "coarse hexagonal --contacts active --epsilon 1e-4W --preconditioner X_eta,X_eta_active,dirichlet --csv -"));
  REQUIRE(active.rows.size() == 6);
  CHECK(active.number(0, "active_contacts") < active.number(0, "contacts"));
  CHECK((active.number(0, "kappa") > 10 && active.number(1, "kappa") <= 10 * (1 + 1e-9)));  // of all, of X_epsilon
  for (std::size_t row = 2; row < 6; ++row) CHECK(active.text(row, "certified") == "true");
  // Two rows of grains that do not touch: subdomains in two pieces.
  file("pieces.csv", "x,y,radius,mass\n0,0,0.5,1\n1,0,0.5,1\n2,0,0.5,1\n0,5,0.5,1\n1,5,0.5,1\n2,5,0.5,1\n");
  const CsvTable pieces = read_table(answer("coarse pieces.csv --subdomains 2x1 --coarse-space rigid,geneo --csv -"));
  for (std::size_t row = 0; row < pieces.rows.size(); ++row) CHECK(pieces.text(row, "converged") == "true");
  // W = [2 -1; -1 2] of each piece, D = 2: 1 +- 1/3 at epsilon = 1.
  const CsvTable halves =
      table("sweep pieces.csv --subdomains 2x1 --scheme schwarz --relaxation 0.9 --epsilon 1 --eigenvalues 2");
  CHECK((halves.number(0, "spectral_radius") == doctest::Approx(0.4) && halves.number(0, "low_multiplicity") == 2));
}

TEST_CASE_FIXTURE(MovingSession, "coarse: frozen contacts of a step with friction") {
  run("simulate shear.toml --steps 12 --algorithm nlgs -o run.h5");
  run("export run.h5 --fclib 12 -o step.hdf5");
  const std::string line =
      "coarse step.hdf5 --subdomains metis:3 --epsilon 1e-6W --coarse-space geneo --scaling deluxe";
  const CsvTable all = read_table(answer(line + " --csv -")),
                 frozen = read_table(answer(line + " --contacts frozen --csv -"));
  CHECK(frozen.text(0, "contact_set") == "frozen");
  CHECK(frozen.number(0, "active_contacts") < all.number(0, "active_contacts"));
  CHECK(frozen.number(0, "rank_x0") > all.number(0, "rank_x0"));  // less is held
  CHECK(frozen.text(0, "certified") == "true");
}

TEST_CASE_FIXTURE(Session, "coarse: bad input is refused by name") {
  ended(2, "coarse disks8 --kappa 1", {"--kappa: expected a number > 1, met 1"});
  ended(2, "coarse disks8 --threshold 0", {"--threshold: expected a number > 0, met 0"});
  ended(2, "coarse disks8 --epsilon 0", {"expected epsilon > 0", "met 0"});
  ended(2, "coarse disks8 --subdomains 1x1", {"expected subdomains that share grains, met an empty interface"});
  ended(2, "coarse disks8 --scaling best", {"--scaling: expected one of", "deluxe", "met \"best\""});
  ended(2, "coarse disks8 --preconditioner X,X", {"expected each name once, met 'X' again"});
  ended(2, "coarse disks8 --preconditioner X --scaling deluxe", {"--scaling: expected the preconditioner lumped or"});
  ended(2, "coarse disks8 --preconditioner lumped --coarse-space rigid",
        {"--coarse-space: expected the preconditioner"});
  ended(2, "coarse disks8 --coarse-space none --kappa 5", {"--kappa: expected the coarse space geneo with it"});
  ended(2, "coarse disks8 --threshold 0.1 --kappa 5", {"--threshold: expected either it or kappa, met both"});
  ended(2, "coarse disks8 --counts --scaling deluxe", {"--scaling: expected", "met counts, without spectra"});
  ended(2, "coarse disks8 --preconditioner bddc",
        {"--preconditioner: expected X, X_eta, X_eta_active, lumped or dirichlet with nscdd, met bddc, which nscdd-mpi "
         "has"});
  ended(2, "coarse disks8 --contacts frozen", {"expected a contact problem with --contacts frozen, met a packing"});
}
