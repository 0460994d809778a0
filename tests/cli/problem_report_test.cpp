// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd report of contact problems: the data of its pages against other verbs, the run that they come from, refusals.
#include "formats/trajectory/trajectory.hpp"
#include "page_data.hpp"

using namespace nscdd::testing;

namespace {

// A step of 30 disks that fall into a box, in the files of LMGC90.
struct NetworkSession : Session {
  NetworkSession() {
    file("box.toml", case_text("deposit\ngrains = 30\nwidth = 3.0\nradius_max = 0.198", "1, 1",
                               "[masses]\ndensity = 2500\n[interaction]\nfriction = 0.25\n[dynamics]\nsteps = 12\n") +
                         line_text("floor", "[0, 0]", "[1, 0]") + line_text("right", "[3, 0]", "[3, 1]") +
                         line_text("left", "[0, 1]", "[0, 0]"));
    answer("simulate box.toml -o run.h5");
    answer("export run.h5 --lmgc90 box");
    answer("export run.h5 --fclib 12 -o step.hdf5");
  }
};

}  // namespace

TEST_CASE_FIXTURE(NetworkSession,
                  "report: of a contact network of LMGC90 the numbers of other verbs, places and forces") {
  const std::string network = "box/OUTBOX/Vloc_Rloc.OUT.12 --subdomains 2x1";
  CHECK(contains(answer("report " + network + " --epsilon 0,1 --eta 1,inf --no-optimum -o page.html"),
                 "30 bodies, 4 radii"));
  const Json data = data_of(read("page.html")), &problem = data["problem"];
  const CsvTable sweep = table("sweep " + network + " --epsilon 0,1 --eta 1,inf");
  for (std::size_t row = 0; row < 4; ++row)
    CHECK(data["grids"][0]["points"][row]["subdominant"] == sweep.number(row, "subdominant_radius"));
  CHECK(data["grids"].size() == 1);  // active contacts are those of frictionless problems
  const std::vector<std::string> whole = words(value(answer("inspect " + network), "unit eigenvalues of B_0"));
  CHECK(std::to_string(problem["ranks"]["unit"].get<int>()) == whole.at(0));
  CHECK(problem["friction"] == Json({0.25, 0.25}));
  const double least = problem["normal_delassus"][0], largest = problem["normal_delassus"][1], mean = data["scale"];
  CHECK(least < mean);
  CHECK(mean < largest);
  // The guess is the solution of the step before to its last digits, and the forces are those of the run.
  REQUIRE(problem["impulses"].size() == 1);
  CHECK(problem["impulses"][0]["name"] == "guess 1");
  const nscdd::TrajectoryStep last = nscdd::read_last_step(folder / "run.h5");
  double forces = 0, drawn = 0;
  for (const nscdd::TrajectoryContact& c : last.contacts) forces += c.impulse.n;
  for (const float impulse : unpacked<float>(data["contacts"]["impulse"])) drawn += static_cast<double>(impulse);
  CHECK(drawn == doctest::Approx(forces).epsilon(1e-5));
  // A body is at the mean of the points of its contacts, which touch its disk.
  const auto a = unpacked<std::uint32_t>(data["contacts"]["a"]), b = unpacked<std::uint32_t>(data["contacts"]["b"]);
  const auto point = unpacked<float>(data["contacts"]["point"]), x = unpacked<float>(data["grains"]["x"]);
  REQUIRE(point.size() == 2 * a.size());
  const CsvTable links = table("network " + network);
  REQUIRE(links.rows.size() == a.size());
  std::vector<double> sum(30, 0), contacts(30, 0);
  for (std::size_t c = 0; c < a.size(); ++c) {
    CHECK(a[c] == links.number(c, "body_a"));
    const bool support = links.number(c, "body_b") < 0;
    CHECK(b[c] == (support ? 4294967295.0 : links.number(c, "body_b")));
    for (const std::uint32_t body : {a[c], b[c]}) {
      if (body > 29) continue;
      sum[body] += static_cast<double>(point[2 * c]);
      ++contacts[body];
      const double dx = static_cast<double>(point[2 * c]) - last.state.x[body];
      CHECK(std::abs(dx) < 0.2);
    }
  }
  for (std::size_t i = 0; i < 30; ++i)
    if (contacts[i] > 0) CHECK(static_cast<double>(x[i]) == doctest::Approx(sum[i] / contacts[i]).epsilon(1e-5));
  for (const Json& mode : data["grids"][0]["modes"])
    CHECK(unpacked<std::int16_t>(mode["velocities"]).size() ==
          2 * unpacked<std::uint32_t>(data["copies"]["subdomain"]).size());
}

TEST_CASE_FIXTURE(NetworkSession, "modes: of a contact problem, with the radius of the sweep and without places") {
  const std::string line = "step.hdf5 --subdomains metis:3 --epsilon 0.1W ";
  answer("modes " + line + "--output slow");
  const CsvTable impulses = csv("slow-impulses.csv"), velocities = csv("slow-velocities.csv"),
                 radius = table("sweep " + line);
  CHECK(impulses.number(0, "eigenvalue") == doctest::Approx(radius.number(0, "spectral_radius")).epsilon(1e-9));
  CHECK(velocities.text(0, "x") == "nan");
  for (std::size_t k = 0; k < impulses.rows.size(); ++k) {
    double jump = impulses.number(k, "jump_x");
    for (std::size_t i = 0; i < velocities.rows.size(); ++i)
      for (const auto& [side, sign] : {std::pair("subdomain_first", 1), {"subdomain_second", -1}})
        if (velocities.text(i, "grain") == impulses.text(k, "grain") &&
            velocities.text(i, "subdomain") == impulses.text(k, side))
          jump -= sign * velocities.number(i, "velocity_x");
    CHECK(std::abs(jump) < 1e-9);
  }
}

TEST_CASE_FIXTURE(NetworkSession,
                  "report: a contact problem without points has no places; one without bodies is refused") {
  answer("report step.hdf5 --subdomains metis:2 --epsilon 1 --eta inf --no-optimum -o page.html");
  const Json data = data_of(read("page.html"));
  CHECK(data["counts"]["grains"] == 30);
  CHECK(unpacked<float>(data["grains"]["x"]).empty());
  CHECK(unpacked<float>(data["contacts"]["point"]).empty());
  const Json& impulses = data["problem"]["impulses"];
  REQUIRE(impulses.size() == 1);
  CHECK(impulses[0]["name"] == "solution");
  CHECK(impulses[0]["residual"] < 1e-7);
  check_refused("report step.hdf5 --subdomains 2x1 -o new.html", {"step.hdf5", "metis:N", "no geometry"});
  check_refused("report step.hdf5 --contacts active -o new.html", {"--contacts all", "friction", "active"});
  file("local.dat", "2\n1\n0\n2\n2\n2 2\n2 1\n1 2\n-1 0.5\n0.3\n");
  check_refused("report local.dat -o new.html", {"local.dat", "expected a global problem"});
}
