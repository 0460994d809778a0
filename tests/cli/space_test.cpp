// SPDX-License-Identifier: GPL-3.0-or-later
// The linear study of spheres as users run it: the verbs that take a packing in the plane take one in space.
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"

#include <cmath>
#include <sstream>

using namespace nscdd::testing;

namespace {

// 27 spheres of a face-centred cubic lattice: 3 layers of 12 contacts, and 2 x 25 between them.
const std::string fcc_case = case_text("fcc\ncolumns = 3\nrows = 3\nlayers = 3", "2, 2, 2",
                                       "[loads]\ncompression = [1.0, 0.5, 0.25]\n"
                                       "[[prescribed]]\ngrain = -1\nvelocity = [-1.0, 0.0, 0.5]\n");

struct LatticeSession : Session {
  LatticeSession() { file("fcc.toml", fcc_case); }
};

const std::string drum = drum_case();

// The numbers of the row of `nscdd inspect` that begins with a word.
std::vector<double> row_of(const std::string& report, const std::string& first) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::string word;
    std::vector<double> numbers;
    if (!(cells >> word) || word != first) continue;
    for (double number = 0; cells >> number;) numbers.push_back(number);
    if (numbers.size() == 5) return numbers;
  }
  return {};
}

}  // namespace

TEST_CASE_FIXTURE(LatticeSession, "space: inspect counts ranks, six rigid motions and self-stresses") {
  const std::string report = answer("inspect fcc.toml");
  // grains, contacts, rank, rigid modes, hyperstaticity
  CHECK(row_of(report, "whole") == std::vector<double>{27, 86, 75, 6, 11});
  // 27 spheres of radius 0.5 in a box of 3.5 x 3.5 x (1 + sqrt 2)
  CHECK(contains(report, "solid fraction       0.478025 (grain volume over the box around all grains)"));
  CHECK(contains(report, "(fewer than 3 contacts, without other rattlers)"));
  answer("inspect fcc.toml --histogram sizes.csv");
  CHECK(contains(read("sizes.csv"), "volume_fraction"));
  const auto dense = row_of(answer("inspect fcc.toml --set packing.columns=4 --subdomains 1x1x1"), "whole");
  REQUIRE(dense.size() == 5);
  CHECK(dense[3] == 6);
  CHECK(dense[1] == 3 * (3 * 3 + 4 * 2) + 2 * 7 * 5);
}

TEST_CASE_FIXTURE(LatticeSession, "space: sweeps agree by every solver, with all contacts and with some") {
  for (const std::string cut : {"", " --subdomains metis:5", " --subdomains 1x1x3"})
    for (const std::string contacts : {"all", "active", "unilateral"}) {
      const std::string line = "sweep fcc.toml --epsilon 1e-2,1 --eta 0.3,inf --contacts " + contacts + cut;
      CAPTURE(line);
      const CsvTable dense = table(line + " --solver dense");
      const CsvTable proved = table(line + " --solver shift-invert --certify");
      REQUIRE(dense.rows.size() == 4);
      REQUIRE(proved.rows.size() == 4);
      for (std::size_t row = 0; row < 4; ++row) {
        const double radius = dense.number(row, "spectral_radius");
        CHECK(radius > 0.01);
        CHECK(std::abs(proved.number(row, "spectral_radius") - radius) < 1e-8 * std::max(1.0, radius));
        CHECK(proved.text(row, "certified") == "true");
        CHECK(dense.number(row, "contacts") == 86);
        CHECK((contacts == "all") == (dense.number(row, "active_contacts") == 86));
      }
    }
  const CsvTable best = table("optimum fcc.toml");
  CHECK(best.number(0, "best_radius") < 1);
}

TEST_CASE_FIXTURE(Session, "space: a grid, a velocity or rates of two numbers are refused with file, line and key") {
  const auto refused = [&](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
    file("bad.toml", replaced(fcc_case, from, to));
    check_refused("sweep bad.toml --epsilon 1 --csv -", parts);
  };
  refused("[2, 2, 2]", "[2, 2]", {"bad.toml:7: partition.grid", "three integers", "met [2, 2]"});
  refused("[1.0, 0.5, 0.25]", "[1.0, 0.5]", {"bad.toml:9: loads.compression", "three numbers", "met [1, 0.5]"});
  const std::string velocity = "prescribed[0].velocity";
  refused("[-1.0, 0.0, 0.5]", "[-1.0, 0.0]", {"bad.toml:12: " + velocity, "three numbers", "met [-1, 0]"});
  refused("[-1.0, 0.0, 0.5]", "[-1.0, 0.0, 0.5, 0]", {"bad.toml:12: " + velocity, "three in space", "an array of 4"});
  refused("generator = \"fcc\"\ncolumns = 3\nrows = 3\nlayers = 3", "generator = \"strip\"",
          {"bad.toml:9: " + velocity, "two numbers", "plane", "met [-1, 0, 0.5]"});
  file("fcc.toml", fcc_case);
  const std::string sweep = "sweep fcc.toml --epsilon 1 --csv - ";
  check_refused(sweep + "--subdomains 2x2", {"fcc.toml: partition.grid", "three integers", "met [2, 2]"});
  check_refused(sweep + "--set partition.grid=4,2", {"fcc.toml: partition.grid", "met [4, 2]"});
  check_refused(sweep + "--prescribed 3:1:0", {"fcc.toml: prescribed[0].velocity", "three numbers"});
  check_refused(sweep + "--set loads.compression=1,1", {"fcc.toml: loads.compression", "three numbers"});
  check_refused("sweep disks4 --epsilon 1 --csv - --subdomains 2x1x1", {"partition.grid", "two integers"});
  CHECK(contains(answer("inspect fcc.toml --subdomains 1x1"), "(empty interface: one subdomain;"));  // one cell is one
}

TEST_CASE_FIXTURE(LatticeSession, "space: tables of contacts, grains and modes have columns along z") {
  const CsvTable links = table("network fcc.toml --grains grains.csv");
  REQUIRE(links.rows.size() == 86);
  for (std::size_t row = 0; row < 86; ++row) {
    double square = 0;
    for (const char* axis : {"x", "y", "z"}) {
      const double n = links.number(row, std::string("normal_") + axis);
      square += n * n;
      const double distance = links.number(row, std::string(axis) + "_b") - links.number(row, std::string(axis) + "_a");
      CHECK(std::abs(distance - n) < 1e-12);  // of diameter 1 m
    }
    CHECK(std::abs(square - 1) < 1e-12);
  }
  const CsvTable grains = csv("grains.csv");
  REQUIRE(grains.rows.size() == 27);
  CHECK(grains.number(26, "velocity_z") == 0.5);
  CHECK(grains.number(26, "z") == doctest::Approx(std::sqrt(2.0)));
  double momentum = 0;  // of the load, but for the grain that has a velocity of its own
  for (std::size_t row = 0; row < 26; ++row) {
    momentum += grains.number(row, "velocity_z");
    CHECK(grains.number(row, "velocity_z") == doctest::Approx(-0.25 * (grains.number(row, "z") - std::sqrt(0.5))));
  }
  CHECK(momentum == doctest::Approx(0.25 * std::sqrt(0.5)));

  answer("modes fcc.toml --epsilon 0.1 --output slow");
  const CsvTable impulses = csv("slow-impulses.csv");
  const CsvTable velocities = csv("slow-velocities.csv");
  const CsvTable swept = table("sweep fcc.toml --epsilon 0.1");
  CHECK(3 * static_cast<double>(impulses.rows.size()) == swept.number(0, "interface_dofs"));
  double share = 0, along_z = 0;
  for (std::size_t row = 0; row < impulses.rows.size(); ++row) {
    share += impulses.number(row, "share");
    along_z = std::max(along_z, std::abs(impulses.number(row, "impulse_z")));
    CHECK(std::abs(impulses.number(row, "eigenvalue") - swept.number(0, "spectral_radius")) < 1e-12);
  }
  CHECK(share == doctest::Approx(1));
  CHECK(along_z > 1e-3);
  CHECK(velocities.number(0, "z") == 0);
  CHECK(std::abs(velocities.number(0, "velocity_z")) > 0);
}

TEST_CASE_FIXTURE(Session, "space: a study of links, and the radius from exported operators of a packing in space") {
  file("study/study.toml",
       "title = \"spheres\"\n"
       "[[table]]\nname = \"radius\"\ncases = [\"fcc.toml\"]\nepsilon = [0.1, 1]\n"
       "vary = { \"packing.columns\" = [3, 4] }\n"
       "[[table]]\nname = \"network\"\nobservable = \"links\"\ncases = [\"fcc.toml\"]\n");
  file("study/fcc.toml", fcc_case);
  answer("run study");
  const CsvTable radius = csv("results/study/radius.csv");
  REQUIRE(radius.rows.size() == 4);
  CHECK(radius.number(2, "packing.columns") == 4);
  file("fcc.toml", fcc_case);
  CHECK(radius.number(2, "spectral_radius") ==
        table("sweep fcc.toml --epsilon 0.1 --set packing.columns=4").number(0, "spectral_radius"));
  const CsvTable network = csv("results/study/network.csv");
  REQUIRE(network.rows.size() == 86);
  CHECK(std::abs(network.number(85, "normal_z")) <= 1);

  answer("export fcc.toml --operators all --epsilon 0.1");
  const std::string manifest = read("all/manifest.toml");
  CHECK(contains(manifest, "dofs_per_grain = 3"));
  CHECK(contains(manifest, "(v_x, v_y, v_z) of each in turn"));
  CHECK(contains(manifest, "rows = 81\ncolumns = 86"));
}

TEST_CASE_FIXTURE(Session, "space: a lattice with holes, as its generator and as a file with z, has the same radii") {
  answer("generate fcc --set packing.vacancies=0.1 -o bed.csv");
  CHECK(contains(read("bed.csv"), "x,y,z,radius"));
  file("bed.toml", case_text("fcc\nvacancies = 0.1", "2, 2, 2"));
  const std::string options = " --epsilon 0.1,1 --eta 0.5 --solver ";
  const CsvTable dense = table("sweep bed.toml" + options + "dense");
  const CsvTable file = table("sweep bed.csv --subdomains 2x2x2" + options + "dense");
  const CsvTable shifted = table("sweep bed.toml" + options + "shift-invert");
  REQUIRE(dense.rows.size() == 2);
  for (std::size_t row = 0; row < 2; ++row) {
    const double radius = dense.number(row, "spectral_radius");
    CHECK(radius > 0.01);
    CHECK(file.number(row, "spectral_radius") == radius);
    CHECK(std::abs(shifted.number(row, "spectral_radius") - radius) < 1e-9);
  }
}

TEST_CASE_FIXTURE(Session, "space: a deposit is made, looked at and studied like any other packing") {
  const std::string keys =
      "grains = 60\nwidth = 1.2\ndepth = 0.9\nradius_min = 0.1\nradius_max = 0.2\ndistribution = \"uniform_volume\"\n";
  file("bed.toml", "[packing]\ngenerator = \"sphere_deposit\"\n" + keys + "[partition]\ngrid = [2, 2, 2]\n" +
                       "[loads]\ncompression = [0.0, 0.0, 1.0]\n");
  const auto grains_of = [&](const std::string& name) {  // without the remarks, which name the file
    const std::string text = read(name);
    return text.substr(text.find("\nx,y,z,radius") + 1);
  };
  answer("generate bed.toml -o bed.csv");
  const CsvTable bed = read_table(grains_of("bed.csv"));
  REQUIRE(bed.rows.size() == 60);
  for (std::size_t row = 0; row < 60; ++row) {
    const double radius = bed.number(row, "radius");
    for (const char* axis : {"x", "y", "z"}) CHECK(bed.number(row, axis) >= radius);
    CHECK(bed.number(row, "x") <= 1.2 - radius);
    CHECK(bed.number(row, "y") <= 0.9 - radius);
  }
  answer("generate bed.toml -o again.csv");
  CHECK(grains_of("again.csv") == grains_of("bed.csv"));

  const auto whole = row_of(answer("inspect bed.toml"), "whole");
  REQUIRE(whole.size() == 5);
  CHECK(whole[0] == 60);
  CHECK(whole[1] > 90);
  CHECK(whole[1] <= 180);       // three contacts per grain at most
  CHECK(whole[2] == whole[1]);  // each grain on three before it: no contact depends on others
  CHECK(whole[4] == 0);

  const std::string options = " --subdomains 2x2x2 --epsilon 1 --solver ";
  const CsvTable dense = table("sweep bed.toml" + options + "dense");
  const CsvTable read_back = table("sweep bed.csv --set loads.compression=0,0,1" + options + "dense");
  const CsvTable shifted = table("sweep bed.toml --certify" + options + "shift-invert");
  const double radius = dense.number(0, "spectral_radius");
  CHECK(radius > 0.01);
  CHECK(radius < 1);
  CHECK(read_back.number(0, "spectral_radius") == radius);
  CHECK(std::abs(shifted.number(0, "spectral_radius") - radius) < 1e-9);
  CHECK(dense.number(0, "contacts") == whole[1]);

  const auto refused = [&](const std::string& from, const std::string& to, std::initializer_list<std::string> parts) {
    file("bad.toml", replaced(read("bed.toml"), from, to));
    check_refused("generate bad.toml -o bad.csv", parts);
  };
  refused("grains = 60", "grains = 0", {"bad.toml:3", "packing.grains"});
  refused("width = 1.2", "width = 0.3", {"packing.width", "at least 2 radius_max = 0.4 m, met 0.3"});
  refused("depth = 0.9", "depth = 0.39", {"packing.depth", "at least 2 radius_max = 0.4 m, met 0.39"});
  refused("radius_min = 0.1", "radius_min = 0.3", {"packing.radius_min", "at most radius_max = 0.2, met 0.3"});
  refused("depth = 0.9", "layers = 3", {"bad.toml:5", "layers"});
}

TEST_CASE_FIXTURE(Session, "space: a study of a file with z takes tolerances of its columns along z") {
  file("study/bed.toml", case_text("bed.csv", "2, 2, 2"));
  file("study/fcc.toml", fcc_case);
  answer("generate study/fcc.toml -o study/bed.csv");
  file("study/study.toml",
       "title = \"spheres\"\n[[table]]\nname = \"network\"\nobservable = \"links\"\n"
       "cases = [\"bed.toml\", \"fcc.toml\"]\n[table.column_tolerance]\nz_a = 1e-9\n");
  answer("run study");
  const CsvTable network = csv("results/study/network.csv");
  CHECK(network.rows.size() == 86 + 86);
  CHECK(network.number(0, "z_a") == 0);
}

TEST_CASE_FIXTURE(Session, "space: spheres fall into a drum that turns; a run that is cut short goes on bit by bit") {
  file("drum.toml", drum);
  answer("simulate drum.toml -o whole.h5");
  answer("simulate drum.toml --steps 40 -o parts.h5");
  answer("simulate drum.toml --restart -o parts.h5");
  const nscdd::TrajectoryStep whole = nscdd::read_last_step(folder / "whole.h5");
  const nscdd::TrajectoryStep parts = nscdd::read_last_step(folder / "parts.h5");
  CHECK(whole.state.step == 80);
  for (const auto values : nscdd::numbers_of_grains(3)) CHECK(whole.state.*values == parts.state.*values);
  CHECK(whole.state.poses[0].turn.coeffs() == parts.state.poses[0].turn.coeffs());
  CHECK(whole.state.impulses.size() > 5);
  answer("export whole.h5 --vtk pictures");
  check_refused("simulate drum.toml -o a.h5 --set dynamics.gravity=0,-9", {"dynamics.gravity", "three"});
  file("flat.toml", std::string(drum).replace(drum.find("[1, 0, 1]"), 9, "[1, 0]"));
  check_refused("simulate flat.toml -o a.h5", {"flat.toml", "numbers for the plane", "space"});
}

TEST_CASE_FIXTURE(Session, "space: a study has the spheres and the force chains of a case that moves, with z") {
  file("study/drum.toml", drum);
  file("study/study.toml",
       "title = \"drum\"\n"
       "[[table]]\nname = \"spheres\"\nobservable = \"configuration\"\ncases = [\"drum.toml\"]\nsteps = [0, 79]\n"
       "[[table]]\nname = \"chains\"\nobservable = \"force_chains\"\ncases = [\"drum.toml\"]\nsteps = [79]\n");
  answer("run study");
  const CsvTable spheres = csv("results/study/spheres.csv");
  REQUIRE(spheres.rows.size() == 54);
  double fallen = 0;
  int turned = 0;
  for (std::size_t i = 0; i < 27; ++i) {
    CHECK(spheres.number(i, "angle") == 0);
    fallen += spheres.number(i, "z") - spheres.number(i + 27, "z");
    turned += spheres.number(i + 27, "angle") > 0;
  }
  CHECK(fallen > 5);
  CHECK(turned > 13);
  const CsvTable chains = csv("results/study/chains.csv");
  REQUIRE(chains.rows.size() > 10);
  for (std::size_t i = 0; i < chains.rows.size(); ++i) {
    CHECK(chains.number(i, "impulse_n") > 0);
    CHECK(chains.number(i, "impulse_t") >= 0);
    const auto along = [&](const std::string& axis) {
      return chains.number(i, axis + "_b") - chains.number(i, axis + "_a");
    };
    // Two spheres, or a sphere and the foot on the drum or the wall.
    const double length = std::hypot(along("x"), along("y"), along("z"));
    CHECK(length > 0.4);
    CHECK(length < 1.001);
  }
}

TEST_CASE_FIXTURE(Session, "space: a step of spheres is a contact problem for solve, inspect, sweep, optimum and run") {
  file("drum.toml", drum);
  answer("simulate drum.toml -o run.h5");
  answer("export run.h5 --fclib 80 -o step.hdf5");
  CHECK(contains(answer("solve step.hdf5"), "converged"));

  const std::string contacts = value(answer("inspect step.hdf5 --subdomains metis:2"), "contacts");
  const CsvTable rows = table("sweep step.hdf5 --subdomains metis:2 --epsilon 0.001,0.01");
  REQUIRE(rows.rows.size() == 2);
  CHECK(rows.text(0, "contacts") == contacts);
  CHECK(rows.text(0, "grains") == "27");
  CHECK(rows.number(0, "spectral_radius") > rows.number(1, "spectral_radius"));
  CHECK(rows.number(0, "spectral_radius") < 1);
  CHECK(contains(answer("optimum step.hdf5 --subdomains metis:2 --contacts all --epsilon 0.001"), "best_eta"));

  file("study/step.toml", "[problem]\nfile = \"../step.hdf5\"\n[partition]\nmetis = 2\n");
  file("study/study.toml",
       "title = \"a step\"\n"
       "[[table]]\nname = \"radius\"\ncases = [\"step.toml\"]\nepsilon = [0.001, 0.01]\n"
       "[[table]]\nname = \"best\"\nobservable = \"optimum\"\ncases = [\"step.toml\"]\nepsilon = 0.001\n"
       "contacts = \"all\"\n");
  answer("run study");
  const CsvTable studied = csv("results/study/radius.csv");
  REQUIRE(studied.rows.size() == 2);
  CHECK(studied.text(0, "spectral_radius") == rows.text(0, "spectral_radius"));
  CHECK(csv("results/study/best.csv").number(0, "best_eta") > 0);
}
