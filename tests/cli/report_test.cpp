// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd report: the data of its pages against the tables of other verbs, refusals, and that a page stands alone.
// What a browser makes of the pages is tested in tests/report/.
#include "formats/report/run_report.hpp"
#include "page_data.hpp"

#include <cmath>

using namespace nscdd::testing;

namespace {

const Json& column(const Json& table, const std::string& name) {
  for (const Json& one : table)
    if (one["name"] == name) return one["values"];
  throw std::runtime_error("no column " + name);
}

}  // namespace

TEST_CASE_FIXTURE(Session, "report: radii and residuals are those of the sweep, the best eta of the optimum") {
  // the lattice has self-stresses across the interface: rho(B_0) = 1, and another radius without them
  for (const std::string& name : Texts{"disks8", "hexagonal --set loads.compression=1,0.2"}) {
    CAPTURE(name);
    answer("report " + name + " --epsilon 0,0.1,1 --eta inf,0.3,2 -o page.html --force --certify");
    const Json data = data_of(read("page.html"));
    CHECK(data["epsilon"] == Json({0, 0.1, 1}));
    CHECK(data["eta"] == Json({0.3, 2, "inf"}));
    REQUIRE(data["grids"].size() == 2);
    for (const Json& grid : data["grids"]) {
      const std::string contacts = grid["contacts"];
      CAPTURE(contacts);
      const CsvTable sweep =
          table("sweep " + name + " --epsilon 0,0.1,1 --eta 0.3,2,inf --certify --contacts " + contacts);
      REQUIRE(grid["points"].size() == sweep.rows.size());
      for (std::size_t row = 0; row < sweep.rows.size(); ++row) {
        const Json& point = grid["points"][row];
        CHECK(point["radius"] == sweep.number(row, "spectral_radius"));
        CHECK(point["subdominant"] == sweep.number(row, "subdominant_radius"));
        CHECK(point["residual"] == sweep.number(row, "residual"));
        CHECK(point["unit"] == sweep.number(row, "unit_multiplicity"));
        CHECK(point["certified"]["high"][0] == sweep.number(row, "high_from"));
        CHECK(point["certified"]["low"][1] == sweep.number(row, "low_to"));
      }
      const CsvTable best = table("optimum " + name + " --epsilon 0,0.1,1 --contacts " + contacts);
      for (std::size_t row = 0; row < 3; ++row) {
        CHECK(grid["best"][row]["status"] == best.text(row, "status"));
        if (best.text(row, "status") == "interior") CHECK(grid["best"][row]["eta"] == best.number(row, "best_eta"));
      }
    }
  }
}

TEST_CASE("report: equal commands give equal bytes, and a page asks for nothing outside of itself") {
  const Session first, second;
  const std::string line = "report disks12 --epsilon 0,1 --eta 1,inf -o page.html";
  CHECK(contains(first.answer(line), "page.html: 12 grains, 8 radii"));
  second.answer(line);
  const std::string page = first.read("page.html");
  CHECK((page == second.read("page.html")));
  CHECK(content_of(first.folder.path()).size() == 1);
  for (const std::string& asking : Texts{"src=", "@import", "url(", "fetch(", "XMLHttpRequest", "import(", "<link"}) {
    CAPTURE(asking);
    CHECK(!contains(page, asking));
  }
  CHECK(times(page, "://") == times(page, "http://www.w3.org/2000/svg"));  // a name, not an address that is asked
  CHECK(contains(page, "nscdd report disks12 --epsilon 0,1 --eta 1,inf -o page.html"));
}

TEST_CASE_FIXTURE(Session, "report: names with signs of HTML do not leave their places") {
  file("<b>&.csv", row_of_three());
  file("evil.toml",
       "title = \"</script><script>alert(1)</script><!--\"\n[packing]\nfile = \"<b>&.csv\"\n[partition]\ngrid "
       "= [2, 1]\n");
  const std::vector<std::string> sweep{"--epsilon", "1", "--eta", "inf", "--subdomains", "2x1"};
  for (const std::string& name : Texts{"evil.toml", "<b>&.csv"}) {
    std::vector<std::string> line{"report", name, "-o", "page.html", "--force"};
    line.insert(line.end(), sweep.begin(), sweep.end());
    CHECK(run(line).exit_code == 0);  // three in a row have no grain to share, which is said
    const std::string page = read("page.html");
    CHECK(times(page, "</script>") == 2);
    CHECK(times(page, "<script") == 2);
    CHECK(!contains(page, "<b>"));
    CHECK(!contains(page, "<!--\""));
    CHECK(data_of(page)["origin"]["name"] == (name == "evil.toml" ? "evil" : "<b>&"));
  }
  CHECK(contains(read("page.html"), "<title>&lt;b&gt;&amp;: nscdd report</title>"));
}

TEST_CASE_FIXTURE(Session, "report: an empty interface is said and shown") {
  ended(0, "report disks4 --subdomains 1x1 --epsilon 1 --eta inf -o page.html", {"the interface is empty"});
  CHECK(data_of(read("page.html"))["grids"][0]["points"][0]["radius"] == 0);
}

TEST_CASE_FIXTURE(Session, "report: spheres have their z, radii of the sweep, and modes of three components") {
  file("fcc.toml",
       case_text("fcc\ncolumns = 3\nrows = 3\nlayers = 3", "2, 2, 2", "[loads]\ncompression = [1.0, 0.5, 0.25]\n"));
  answer("report fcc.toml --epsilon 0.1,1 --eta 0.3,inf --no-optimum -o page.html");
  const Json data = data_of(read("page.html"));
  CHECK(data["dimension"] == 3);
  const std::string packing = answer("generate fcc.toml -o -");
  const CsvTable grains = read_table(packing.substr(packing.find("\nx,y,z,radius") + 1));
  const std::vector<float> z = unpacked<float>(data["grains"]["z"]);
  REQUIRE(z.size() == grains.rows.size());
  for (std::size_t i = 0; i < z.size(); ++i) CHECK(z[i] == doctest::Approx(grains.number(i, "z")).epsilon(1e-6));
  const std::size_t copies = unpacked<std::uint32_t>(data["copies"]["subdomain"]).size();
  for (const Json& grid : data["grids"]) {
    const CsvTable sweep =
        table("sweep fcc.toml --epsilon 0.1,1 --eta 0.3,inf --contacts " + grid["contacts"].get<std::string>());
    for (std::size_t row = 0; row < sweep.rows.size(); ++row)
      CHECK(grid["points"][row]["radius"] == sweep.number(row, "spectral_radius"));
    REQUIRE(!grid["modes"].empty());
    for (const Json& mode : grid["modes"]) {
      const std::vector<std::int16_t> v = unpacked<std::int16_t>(mode["velocities"]);
      REQUIRE(v.size() == 3 * copies);
      double fastest = 0, along_z = 0;
      for (std::size_t k = 0; k < copies; ++k) {
        fastest = std::max(fastest, std::hypot(1.0 * v[3 * k], 1.0 * v[3 * k + 1], 1.0 * v[3 * k + 2]));
        along_z = std::max(along_z, std::abs(1.0 * v[3 * k + 2]));
      }
      CHECK(fastest == doctest::Approx(32767).epsilon(1e-4));
      CHECK(along_z > 1000);
    }
  }
  answer("report disks4 --epsilon 1 --eta inf --no-optimum -o plane.html");
  CHECK(data_of(read("plane.html"))["dimension"] == 2);
  CHECK(!data_of(read("plane.html"))["grains"].contains("z"));
}

TEST_CASE_FIXTURE(Session, "report: a run of spheres has heights, cylinders and contact points in space") {
  file("drum.toml", drum_case());
  answer("simulate drum.toml --save-every 40 -o drum.h5");
  CHECK(contains(answer("report drum.h5 -o drum.html"), "3 of 81 steps drawn, 27 spheres"));
  const Json data = data_of(read("drum.html"));
  CHECK(data["dimension"] == 3);
  REQUIRE(data["steps"].size() == 3);
  const nscdd::TrajectoryStep last = nscdd::read_last_step(folder / "drum.h5");
  const Json& step = data["steps"][2];
  CHECK((step["walls"] == Json::parse("[[1, 0, 1, 0, 1, 0, 2.2], [0, -0.6, 0, 0, 1, 0, 0]]")));
  const std::vector<float> z = unpacked<float>(step["z"]);
  REQUIRE(z.size() == 27);
  for (std::size_t i = 0; i < z.size(); ++i) CHECK(z[i] == static_cast<float>(last.state.z[i]));
  const std::vector<float> point = unpacked<float>(step["contacts"]["point"]);
  const std::vector<float> tangential = unpacked<float>(step["contacts"]["tangential"]);
  std::size_t carrying = 0;
  for (const nscdd::TrajectoryContact& c : last.contacts) {
    if (!c.carries()) continue;
    REQUIRE(point.size() >= 3 * (carrying + 1));
    for (std::size_t k = 0; k < 3; ++k) CHECK(point[3 * carrying + k] == static_cast<float>(c.geometry.point[k]));
    CHECK(tangential[carrying] == static_cast<float>(std::hypot(c.impulse.t, c.second_tangential)));
    ++carrying;
  }
  CHECK(carrying > 10);
  CHECK(3 * carrying == point.size());
}

TEST_CASE_FIXTURE(Session, "report: usage that makes no sense, of a packing") {
  file("mine.csv", row_of_three());
  file("page.html", "precious");
  check_refused("report disks4", {"-o"});
  check_refused("report disks5 -o new.html", {"disks5", "disks4"});
  check_refused("report disks4 -o page.html", {"page.html", "exists already", "--force"});
  check_refused("report disks4 -o page.pdf", {"page.pdf", ".html"});
  check_refused("report disks4 -o nowhere/page.html", {"nowhere"});
  check_refused("report disks4 -o new.html --steps 1:2", {"--steps", "trajectory"});
  check_refused("report disks4 -o new.html --convergence mine.csv", {"--convergence", "trajectory"});
  check_refused("report disks4 -o new.html --epsilon -1", {"epsilon", ">= 0"});
  check_refused("report disks4 -o new.html --contacts some", {"--contacts", "unilateral", "some"});
  check_refused("report mine.csv -o new.html --contacts active", {"prescribed"});
  check_refused("report hexagonal -o new.html --memory-limit 1e-9", {"--memory-limit"});
  check_refused("report hexagonal -o new.html --set packing.columns=600 --set packing.rows=600",
                {"300000 grains", "360000"});
}

TEST_CASE_FIXTURE(Session, "report: a run, its steps, its summary and its table of iterations") {
  file("box.toml", moving_case());
  answer("simulate box.toml --steps 6 --save-every 2 --convergence box.csv -o box.h5");
  CHECK(contains(answer("report box.h5 --convergence box.csv -o box.html"), "4 of 7 steps drawn"));
  const Json data = data_of(read("box.html"));
  const CsvTable iterations = csv("box.csv");
  CHECK(data["status"].size() == 6);
  CHECK(column(data["summary"], "step") == Json({1, 2, 3, 4, 5, 6}));
  REQUIRE(column(data["iterations"], "zeta").size() == iterations.rows.size());
  for (std::size_t row = 0; row < iterations.rows.size(); ++row) {
    const double zeta = iterations.number(row, "zeta");
    CHECK(std::abs(column(data["iterations"], "zeta")[row].get<double>() - zeta) <= 1e-6 * zeta);
    CHECK(column(data["iterations"], "iteration")[row] == iterations.number(row, "iteration"));
  }
  std::vector<int> drawn;
  for (const Json& step : data["steps"]) drawn.push_back(step["step"]);
  CHECK(drawn == std::vector<int>{0, 2, 4, 6});
  // The right wall turns about its foot.
  CHECK((data["steps"][0]["walls"] == Json::parse("[[3, 0, -1, 0]]")));
  CHECK(data["steps"][3]["walls"][0][3] > 0.001);
  CHECK(data["steps"][3]["walls"][0][0] == 3);
  // Where there is no room for all, both ends stay.
  using Steps = std::vector<nscdd::Index>;
  const std::string path = folder / "box.h5";
  CHECK(nscdd::steps_to_draw(path, {0, 2, 4, 6}, 1) == Steps{0, 6});
  CHECK(nscdd::steps_to_draw(path, {0, 2, 4, 6}, 1e9) == Steps{0, 2, 4, 6});
  CHECK(nscdd::steps_to_draw(path, {4}, 1) == Steps{4});
  answer("report box.h5 --steps 4:6:2 -o some.html");
  const Json some = data_of(read("some.html"));
  CHECK(some["steps"].size() == 2);
  CHECK((some["steps"][1] == data["steps"][3]));
  CHECK(some["kept"] == 4);
  const std::string before = read("some.html");
  std::filesystem::remove(folder / "some.html");
  answer("report box.h5 --steps 4:6:2 -o some.html");
  CHECK((read("some.html") == before));
}

TEST_CASE_FIXTURE(Session, "report: a run has the subdomains of its partition, though some hold no contact") {
  file("box.toml", moving_case());
  answer("simulate box.toml --steps 1 --subdomains 30x30 -o many.h5");
  answer("report many.h5 -o many.html");
  CHECK(data_of(read("many.html"))["subdomains"] == 900);
  answer("simulate box.toml --steps 1 --algorithm nlgs -o whole.h5");
  answer("report whole.h5 -o whole.html");
  CHECK(data_of(read("whole.html"))["subdomains"] == 1);
}

TEST_CASE_FIXTURE(Session, "report: a run of more disks than a page can show is refused") {
  file("large.toml",
       "[packing]\ngenerator = \"hexagonal\"\ncolumns = 601\nrows = 500\n[masses]\ndensity = 2500\n"
       "[partition]\ngrid = [1, 1]\n[dynamics]\nstep = 0.005\nsteps = 0\n[solver]\nalgorithm = \"nlgs\"\n");
  answer("simulate large.toml -o large.h5");
  check_refused("report large.h5 -o new.html", {"large.h5", "300000 disks", "300500"});
}

TEST_CASE_FIXTURE(Session, "report: usage that makes no sense, of a run") {
  file("box.toml", moving_case());
  file("other.csv", "step,iteration\n1,1\n");
  answer("simulate box.toml --steps 0 -o none.h5");
  check_refused("report none.h5 -o new.html", {"none.h5", "has taken a step"});
  answer("simulate box.toml --steps 2 --convergence box.csv -o box.h5");
  check_refused("report box.h5 -o new.html --epsilon 1", {"--epsilon", "packing"});
  for (const std::string& of_packing :
       Texts{"--subdomains 2x1", "--prescribed 0:1:0", "--set packing.grains=4", "--density 1", "--tolerance 1e-3",
             "--overlap-tolerance 1", "--eta 1", "--contacts all", "--solver dense", "--residual-tolerance 1e-5",
             "--certify", "--no-optimum", "--threads 1", "--memory-limit 1"})
    check_refused("report box.h5 -o new.html " + of_packing, {words(of_packing).front(), "packing", "box.h5"});
  check_refused("report box.h5 -o new.html --steps 7", {"--steps", "0:2"});
  check_refused("report box.h5 -o new.html --steps 2:1", {"--steps", "A:B:K"});
  check_refused("report box.h5 -o new.html --convergence other.csv", {"other.csv", "zeta"});
  check_refused("report box.h5 -o new.html --convergence missing.csv", {"missing.csv"});
  // A table of a run with fewer iterations, one of as many with another end, and one whose second step lacks its end.
  answer("simulate box.toml --steps 2 --iterations 30 --convergence loose.csv -o loose.h5");
  answer("simulate box.toml --steps 2 --set interaction.friction=0.1 --convergence smooth.csv -o smooth.h5");
  check_refused("report box.h5 -o new.html --convergence smooth.csv", {"smooth.csv", "box.h5", "zeta"});
  check_refused("report box.h5 -o new.html --convergence loose.csv", {"loose.csv", "box.h5", "step 1"});
  const std::string all = read("box.csv");
  file("cut.csv", all.substr(0, all.rfind("\n2,") + 1));
  check_refused("report box.h5 -o new.html --convergence cut.csv", {"cut.csv", "box.h5", "step 2"});
  // The table is read before the steps are looked for, and is no place for the page.
  check_refused("report box.h5 -o new.html --steps 7 --convergence loose.csv", {"loose.csv"});
  std::filesystem::copy_file(folder / "box.csv", folder / "box.html");
  check_refused("report box.h5 -o box.html --force --convergence box.html", {"box.html", "lost"});
  file("long.csv", replaced(read("box.csv"), "\n2,", "\n3,"));
  check_refused("report box.h5 -o new.html --convergence long.csv", {"long.csv:", "2 steps", "met 3"});
}

TEST_CASE_FIXTURE(Session, "report: the command line on a page is one that a shell takes") {
  file("it's.csv", "x,y,radius\n0,0,1\n2,0,1\n4,0,1\n");
  answer("report it's.csv --subdomains 2x1 --epsilon 1 --eta inf --no-optimum -o page.html");
  const std::string shown = data_of(read("page.html"))["origin"]["command_line"];
  CHECK(shown.find(R"( 'it'\''s.csv' )") != std::string::npos);
}
