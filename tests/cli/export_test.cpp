// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd export: trajectories for ParaView, steps as contact problems that solve to what the run found.
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

struct BoxSession : Session {
  BoxSession() { file("box.toml", small_moving_case()); }
};

// So far that what the run found is the solution to rounding.
const std::string tightly = " --criterion natural_map --tolerance 1e-13 --iterations 200000";

double residual_of_run(const std::string& report) {
  std::istringstream lines(report);
  for (std::string line; std::getline(lines, line);)
    if (line.rfind("residual of the run ", 0) == 0) return std::stod(line.substr(20));
  FAIL("no residual in the report:\n" << report);
  return 1;
}

FclibFile fclib(const Session& session, const std::string& name) { return read_fclib(session.path(name)); }

// Exports, solves, and gives both: the solution of the run and the one found.
std::pair<FclibFile, FclibFile> solved_again(const Session& session, const std::string& options) {
  const std::string report = session.answer("export run.h5 --force -o p.hdf5 " + options);
  CHECK(residual_of_run(report) < 1e-11);
  session.answer("solve p.hdf5 --tolerance 1e-12 --force -o s.hdf5");
  std::pair<FclibFile, FclibFile> both{fclib(session, "p.hdf5"), fclib(session, "s.hdf5")};
  REQUIRE(both.first.solution);
  REQUIRE(both.second.solution);
  return both;
}

const GlobalFrictionProblem& global(const FclibFile& file) { return std::get<GlobalFrictionProblem>(file.problem); }

using Arrays = std::map<std::string, std::vector<double>>;

// What VTK reads, by picture (see tests/unit/read_vtk.py): "file NAME TIME", then a line per array.
std::map<std::string, Arrays> read_by_vtk(const std::filesystem::path& collection) {
  const std::string out = collection.string() + ".txt";
  REQUIRE_MESSAGE(run_script("unit/read_vtk.py", {collection}, out) == 0,
                  "VTK (Debian package python3-vtk9) does not read the collection");
  std::map<std::string, Arrays> pictures;
  std::istringstream lines(read_file(out));
  std::string picture;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, word;
    words >> name;
    if (name == "file") words >> picture, name = "time";
    std::vector<double>& values = pictures[picture][name];
    while (words >> word) values.push_back(std::strtod(word.c_str(), nullptr));
  }
  return pictures;
}

}  // namespace

TEST_CASE_FIXTURE(BoxSession, "export --fclib: solved again, a step gives the velocities of the run") {
  answer("simulate box.toml --algorithm nlgs -o run.h5" + tightly);
  std::filesystem::remove(folder / "box.toml");  // the trajectory alone is enough
  for (const int step : {3, 12}) {               // in the first two all grains fall: impulses are rounding
    CAPTURE(step);
    const auto [run, solved] = solved_again(*this, "--fclib " + std::to_string(step));
    CHECK(*run.info.title == "box, step " + std::to_string(step));
    const TrajectoryStep kept = read_trajectory_step(path("run.h5"), step);
    REQUIRE(global(run).contacts() == count(kept.contacts));
    REQUIRE(global(run).mass.rows() == 3 * 30);
    CHECK(run.solution->v[4] == kept.state.velocity_y[1]);
    CHECK(run.solution->v[5] == kept.state.spin[1]);
    CHECK(run.solution->r[0] == kept.contacts[0].impulse.n);
    CHECK(run.solution->v.norm() > 1e-3);
    CHECK((run.solution->v - solved.solution->v).norm() < 1e-9 * run.solution->v.norm());
    // M v = H r + f holds for the run with its own impulses and the spins it has.
    CHECK((body_velocities(global(run), run.solution->r) - run.solution->v).norm() < 1e-12 * run.solution->v.norm());
  }
  const TrajectoryHeader header = read_trajectory_header(path("run.h5"));
  const Vector mass = global(fclib(*this, "p.hdf5")).mass.diagonal();
  CHECK(mass[3] == doctest::Approx(header.system.mass[1]));
  CHECK(mass[5] == doctest::Approx(header.system.mass[1] * std::pow(header.system.radius[1], 2) / 2));
}

TEST_CASE_FIXTURE(BoxSession, "network of a contact problem: contacts with their bodies and subdomains") {
  answer("simulate box.toml --algorithm nlgs -o run.h5");
  answer("export run.h5 --fclib 12 -o p.hdf5");
  const CsvTable contacts = table("network p.hdf5 --subdomains metis:3");
  const FclibFile file = fclib(*this, "p.hdf5");
  REQUIRE(count(contacts.rows) == global(file).contacts());
  std::map<std::string, std::set<std::string>> subdomains_of;
  std::set<std::string> all;
  for (std::size_t row = 0; row < contacts.rows.size(); ++row) {
    CHECK(contacts.text(row, "contact") == std::to_string(row));
    all.insert(contacts.text(row, "subdomain"));
    for (const char* body : {"body_a", "body_b"})
      if (contacts.text(row, body) != "-1")
        subdomains_of[contacts.text(row, body)].insert(contacts.text(row, "subdomain"));
  }
  CHECK(all == std::set<std::string>{"0", "1", "2"});
  // Each further copy of a body is glued by three unknowns: the partition is the one that a sweep works with.
  std::size_t copies = 0;
  for (const auto& [body, subdomains] : subdomains_of) copies += subdomains.size() - 1;
  const CsvTable swept = table("sweep p.hdf5 --subdomains metis:3 --epsilon 1");
  CHECK(copies > 0);
  CHECK(swept.number(0, "interface_dofs") == static_cast<double>(3 * copies));
  check_refused("network p.hdf5 --subdomains metis:3 --grains g.csv --csv c.csv", {"--grains", "expected a packing"});
}

TEST_CASE_FIXTURE(Session, "export --fclib: impulses agree where they are unique") {
  std::string text = replaced(small_moving_case(), "friction = 0.3", "law = \"frictionless\"");
  file("box.toml", text);
  answer("simulate box.toml --algorithm nlgs --steps 4 -o run.h5" + tightly);
  const auto [run, solved] = solved_again(*this, "--fclib 4");
  CHECK(global(run).friction.maxCoeff() == 0);
  CHECK((run.solution->r - solved.solution->r).norm() < 1e-8 * run.solution->r.norm());
  CHECK((run.solution->v - solved.solution->v).norm() < 1e-9 * run.solution->v.norm());
}

TEST_CASE_FIXTURE(Session, "export --fclib: restitution and friction of boundaries are in the problem") {
  file("box.toml", replaced(small_moving_case(), "friction = 0.3",
                            "friction = 0.3\nboundary_friction = 0.1\nrestitution = 0.5\n"
                            "tangential_restitution = 0.2"));
  answer("simulate box.toml --algorithm nlgs -o run.h5" + tightly);
  const auto [run, solved] = solved_again(*this, "--fclib 10");
  const Vector& friction = global(run).friction;
  CHECK(std::set<double>(friction.begin(), friction.end()) == std::set<double>{0.1, 0.3});
  CHECK((run.solution->v - solved.solution->v).norm() < 1e-9 * run.solution->v.norm());
}

TEST_CASE_FIXTURE(BoxSession, "export --local: the same problem, reduced") {
  answer("simulate box.toml --algorithm nlgs --steps 3 -o run.h5" + tightly);
  answer("export run.h5 --fclib 3 -o global.hdf5");
  answer("export run.h5 --fclib 3 --local -o local.hdf5");
  const FclibFile whole = fclib(*this, "global.hdf5"), reduced = fclib(*this, "local.hdf5");
  const LocalFrictionProblem expected = reduce(global(whole));
  const auto& local = std::get<LocalFrictionProblem>(reduced.problem);
  CHECK((local.w - expected.w).norm() == 0);
  CHECK(local.q == expected.q);
  CHECK(local.friction == expected.friction);
  REQUIRE(reduced.solution);
  CHECK(reduced.solution->v.size() == 0);
  CHECK(reduced.solution->r == whole.solution->r);
  CHECK((local.w * reduced.solution->r + local.q - reduced.solution->u).norm() < 1e-12);
}

TEST_CASE_FIXTURE(Session, "export --subdomain: with its interface impulses a part moves as in the whole") {
  file("box.toml", moving_case());
  answer("simulate box.toml --algorithm generic --subdomains 2x2 --steps 4 -o run.h5" + tightly);
  const TrajectoryHeader header = read_trajectory_header(path("run.h5"));
  const TrajectoryStep kept = read_trajectory_step(path("run.h5"), 4);
  std::map<Index, double> mass;
  std::map<Index, int> copies;
  Index contacts = 0;
  for (const Index subdomain : {0, 1, 2, 3}) {
    CAPTURE(subdomain);
    const auto [run, solved] = solved_again(*this, "--fclib 4 --subdomain " + std::to_string(subdomain));
    std::set<Index> grains;
    for (const TrajectoryContact& c : kept.contacts)
      for (const Index body : {c.geometry.a, c.geometry.b})
        if (c.subdomain == subdomain && body < header.system.grains() && header.system.free(body)) grains.insert(body);
    REQUIRE(global(run).mass.rows() == 3 * static_cast<Index>(grains.size()));
    contacts += global(run).contacts();
    CHECK((run.solution->v - solved.solution->v).norm() < 1e-9 * run.solution->v.norm());
    Index row = 0;
    for (const Index i : grains) {
      CHECK(std::abs(run.solution->v[row] - kept.state.velocity_x[at(i)]) < 1e-9);
      CHECK(std::abs(run.solution->v[row + 1] - kept.state.velocity_y[at(i)]) < 1e-9);
      CHECK(std::abs(run.solution->v[row + 2] - kept.state.spin[at(i)]) < 1e-8);
      mass[i] += global(run).mass.coeff(row, row);
      ++copies[i];
      row += 3;
    }
  }
  CHECK(contacts == count(kept.contacts));
  int most = 0;
  for (const auto& [grain, sum] : mass) {
    CHECK(sum == doctest::Approx(header.system.mass[at(grain)]));
    most = std::max(most, copies[grain]);
  }
  CHECK(most > 2);  // a cross point
}

TEST_CASE_FIXTURE(BoxSession, "export --fclib: a step without the state before it, or that is not kept itself") {
  answer("simulate box.toml --save-every 5 -o run.h5");
  CHECK(trajectory_steps(path("run.h5")) == std::vector<Index>{0, 5, 10, 12});
  CHECK(answer("export run.h5 --fclib 6 -o six.hdf5").find("step 6 is not kept") != std::string::npos);
  CHECK_FALSE(fclib(*this, "six.hdf5").solution);
  check_refused("export run.h5 --fclib 5 -o five.hdf5",
                {"run.h5", "one of 1:11:5, 13, met step 5", "0:10:5, 12", "--save-every"});
  check_refused("export run.h5 --fclib 6 --subdomain 0 -o part.hdf5",
                {"--subdomain", "a step that is kept", "met step 6"});
  // The step after the last: what a run that broke down could not solve.
  answer("export run.h5 --fclib 13 -o next.hdf5");
  check_refused("export run.h5 --fclib 14 -o later.hdf5", {"met step 14"});
  check_refused("export run.h5 --fclib 0 -o zero.hdf5", {"met step 0"});
}

TEST_CASE_FIXTURE(BoxSession, "export --vtk: VTK reads the kept steps as the trajectory has them") {
  answer("simulate box.toml --subdomains 2x1 -o run.h5");
  const std::string text = answer("export run.h5 --vtk pictures/all --steps 0:12:4");
  CHECK(contains(text, "4 steps (0:12:4)"));
  auto pictures = read_by_vtk(folder / "pictures/all/run.pvd");
  REQUIRE(pictures.size() == 4);
  CHECK(pictures["step-000000.vtp"]["counts"][2] == 0);
  const TrajectoryStep kept = read_trajectory_step(path("run.h5"), 12);
  const GranularSystem system = read_trajectory_header(path("run.h5")).system;
  Arrays& a = pictures["step-000012.vtp"];
  CHECK(a["time"] == std::vector<double>{kept.state.time});
  CHECK(a["field/TimeValue"] == std::vector<double>{kept.state.time});
  const std::size_t disks = at(system.grains());
  REQUIRE(a["counts"][1] == static_cast<double>(disks));
  REQUIRE(a["counts"][2] == static_cast<double>(kept.contacts.size()));
  std::vector<std::set<Index>> held(disks);
  for (std::size_t k = 0; k < kept.contacts.size(); ++k) {
    const TrajectoryContact& c = kept.contacts[k];
    CHECK(a["cell/impulse_n"][disks + k] == c.impulse.n);
    CHECK(a["cell/impulse_t"][disks + k] == c.impulse.t);
    CHECK(a["cell/gap"][disks + k] == c.geometry.gap);
    CHECK(a["cell/status"][disks + k] == static_cast<double>(c.status));
    CHECK(a["cell/subdomain"][disks + k] == static_cast<double>(c.subdomain));
    CHECK(a["lines/connectivity"][2 * k] == static_cast<double>(c.geometry.a));
    for (const Index body : {c.geometry.a, c.geometry.b})
      if (body < system.grains()) held[at(body)].insert(c.subdomain);
  }
  bool shared = false;
  for (std::size_t i = 0; i < disks; ++i) {
    CHECK(a["points"][3 * i + 1] == kept.state.y[i]);
    CHECK(a["point/radius"][i] == system.radius[i]);
    CHECK(a["point/angle"][i] == kept.state.angle[i]);
    CHECK(a["point/velocity"][3 * i] == kept.state.velocity_x[i]);
    CHECK(a["point/multiplicity"][i] == static_cast<double>(held[i].size()));
    CHECK(a["point/subdomain"][i] == (held[i].empty() ? -1.0 : static_cast<double>(*held[i].begin())));
    shared = shared || held[i].size() > 1;
  }
  CHECK(shared);

  check_refused("export run.h5 --vtk pictures/all", {"pictures/all", "--force"});
  CHECK(answer("export run.h5 --vtk pictures/all --force").find("13 steps (0:12)") != std::string::npos);
  CHECK(answer("export run.h5 --vtk one --steps 3").find("1 steps (3)") != std::string::npos);
}

TEST_CASE_FIXTURE(BoxSession, "export: bad input is refused, and nothing is written") {
  file("sticky.toml", replaced(small_moving_case(), "friction = 0.3", "law = \"cohesive\"\ncohesion = 1"));
  file("old.hdf5", "precious");
  file("text.h5", "no trajectory\n");
  answer("simulate box.toml --steps 2 -o run.h5");
  answer("simulate sticky.toml --steps 2 -o sticky.h5");
  check_refused("export run.h5",
                {"expected one of --vtk FOLDER, --vtkhdf FILE, --lmgc90 FOLDER, --fclib STEP and --operators FOLDER"});
  check_refused("export run.h5 --vtk v --fclib 1 -o p.hdf5", {"--vtk"});
  check_refused("export run.h5 --fclib 1", {"-o FILE"});
  check_refused("export run.h5 --fclib 1 -o -", {"-: expected the name of a file that ends in .h5"});
  check_refused("export run.h5 --fclib 1 -o one.csv", {"one.csv", ".hdf5"});
  check_refused("export run.h5 --fclib 1 -o run.h5 --force", {"would be lost"});
  check_refused("export run.h5 --fclib 1 -o old.hdf5", {"old.hdf5", "exists already"});
  check_refused("export run.h5 --fclib 1 --subdomain 7 -o p.hdf5",
                {"step 1: expected a subdomain that has contacts (0, 1), met 7"});
  check_refused("export sticky.h5 --fclib 1 -o p.hdf5", {"interaction.law", "met cohesive"});
  check_refused("export none.h5 --vtk v", {"none.h5", "met no such file"});
  check_refused("export text.h5 --fclib 1 -o p.hdf5", {"text.h5", "trajectory"});
  check_refused("export box.toml --vtk v", {"box.toml", "trajectory"});
  check_refused("export run.h5 --vtk old.hdf5", {"expected a folder, met a file"});
  check_refused("export run.h5 --vtk v --steps 5:9", {"--steps", "keeps (0:2), met none"});
  for (const std::string range : {"2:1", "0:2:0", "a", "0:", "0:1:1:1", "-1:2"})
    check_refused({"export", "run.h5", "--vtk", "v", "--steps=" + range}, {"--steps"});
  check_refused("export run.h5 --local --vtk v", {"--local"});
  check_refused("export run.h5 --steps 1 --fclib 1 -o p.hdf5", {"--steps"});
}
