// SPDX-License-Identifier: GPL-3.0-or-later
// What is written for ParaView, read back by VTK itself (tests/unit/read_vtk.py).
#include "formats/vtk/vtk.hpp"

#include "../support/granular.hpp"
#include "../support/run_program.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

using Arrays = std::map<std::string, std::vector<double>>;

// Every array of a file as VTK has it; a test fails where VTK does not read it.
std::string read_by_vtk(const std::filesystem::path& file) {
  const std::filesystem::path out = file.string() + ".txt";
  const std::string command = "/usr/bin/python3 '" + (source_folder() / "tests/unit/read_vtk.py").string() + "' '" +
                              file.string() + "' > '" + out.string() + "'";
  REQUIRE_MESSAGE(std::system(command.c_str()) == 0, "VTK (Debian package python3-vtk9) does not read the file");
  return read_file(out);
}

Arrays arrays_of(const std::string& text) {
  Arrays result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, word;
    words >> name;
    std::vector<double>& values = result[name];
    while (words >> word) values.push_back(std::strtod(word.c_str(), nullptr));
  }
  return result;
}

Arrays arrays_of_picture(const std::string& picture) {
  const TemporaryFolder folder;
  write_file(folder / "frame.vtp", picture);
  return arrays_of(read_by_vtk(folder / "frame.vtp"));
}

using Values = std::vector<double>;

struct Shown {
  GranularSystem system;
  TrajectoryStep step;

  std::string text() const { return vtp_text(system, step); }
};

Shown two_grains_and_a_wall() {
  Shown shown;
  shown.system.radius = {0.5, 0.125};
  shown.system.driven_by = {-1, 3};
  GranularState& state = shown.step.state;
  state.time = 0.1;
  state.x = {0.25, 1.0 / 3};
  state.y = {-2, 1e-300};
  state.angle = {0.1, -7};
  state.velocity_x = {1, 2};
  state.velocity_y = {3, -4};
  const auto contact = [](Index a, Index b, std::array<double, 2> foot, double gap) {
    StepContact one;
    one.a = a;
    one.b = b;
    one.point = {foot[0], foot[1]};
    one.gap = gap;
    return one;
  };
  shown.step.contacts = {{contact(1, 2, {9, 0.5}, -1e-5), {4, -0.4}, ContactStatus{1}, 1},
                         {contact(0, 1, {7, 7}, 2e-5), {5, 0.5}, ContactStatus{3}, 0},
                         {contact(0, 3, {8, 0.75}, 0), {6, 0}, ContactStatus{0}, 1}};
  shown.step.contacts[1].self_stress = 0.25;
  return shown;
}

}  // namespace

TEST_CASE("vtp: VTK reads every number as it was, grains before contacts, feet after grains") {
  Arrays a = arrays_of_picture(two_grains_and_a_wall().text());
  CHECK(a["counts"] == Values{4, 2, 3, 5});
  CHECK(a["types"] == Values{1, 1, 3, 3, 3});  // VTK_VERTEX, VTK_LINE
  CHECK(a["points"] == Values{0.25, -2, 0, 1.0 / 3, 1e-300, 0, 9, 0.5, 0, 8, 0.75, 0});
  CHECK(a["verts/connectivity"] == Values{0, 1});
  CHECK(a["verts/offsets"] == Values{0, 1, 2});
  CHECK(a["lines/connectivity"] == Values{1, 2, 0, 1, 0, 3});
  CHECK(a["lines/offsets"] == Values{0, 2, 4, 6});
  CHECK(a["field/TimeValue"] == Values{0.1});
  CHECK(a["point/radius"] == Values{0.5, 0.125, 0, 0});
  CHECK(a["point/id"] == Values{0, 1, -1, -1});
  CHECK(a["point/boundary"] == Values{-1, 3, -1, -1});
  CHECK(a["point/subdomain"] == Values{0, 0, -1, -1});
  CHECK(a["point/multiplicity"] == Values{2, 2, 0, 0});
  CHECK(a["point/angle"] == Values{0.1, -7, 0, 0});
  CHECK(a["point/velocity"] == Values{1, 3, 0, 2, -4, 0, 0, 0, 0, 0, 0, 0});
  CHECK(a["cell/kind"] == Values{0, 0, 1, 1, 1});
  CHECK(a["cell/subdomain"] == Values{0, 0, 1, 0, 1});
  CHECK(a["cell/impulse_n"] == Values{0, 0, 4, 5, 6});
  CHECK(a["cell/impulse_t"] == Values{0, 0, -0.4, 0.5, 0});
  CHECK(a["cell/status"] == Values{-1, -1, 1, 3, 0});
  CHECK(a["cell/gap"] == Values{0, 0, -1e-5, 2e-5, 0});
  CHECK(a["cell/self_stress"] == Values{0, 0, 0, 0.25, 0});
  CHECK(a.size() == 22);
}

TEST_CASE("vtp: a contact across the end of a periodic cell ends at the image of its grain") {
  Shown shown = two_grains_and_a_wall();
  shown.system.period.x = 4;
  shown.step.state.x = {0.25, 3.75};
  Arrays a = arrays_of_picture(shown.text());
  CHECK(a["points"] == Values{0.25, -2, 0, 3.75, 1e-300, 0, 9, 0.5, 0, -0.25, 1e-300, 0, 8, 0.75, 0});
  CHECK(a["lines/connectivity"] == Values{1, 2, 0, 3, 0, 4});
  CHECK(a["point/id"] == Values{0, 1, -1, -1, -1});
}

TEST_CASE("vtp: spheres have z, quaternions and spins, and their contacts the size of the tangential impulse") {
  Shown shown = two_grains_and_a_wall();
  shown.system.dimension = 3;
  GranularState& state = shown.step.state;
  state.angle.clear();
  state.z = {5, 6};
  state.velocity_z = {7, 8};
  state.spin_x = {0.5, 1};
  state.spin_y = {1.5, 2};
  state.spin = {2.5, 3};
  state.turn_w = {1, 0};
  state.turn_x = {0, 0.6};
  state.turn_y = {0, 0.8};
  state.turn_z = {0, 0};
  shown.step.contacts[0].second_tangential = 0.3;
  shown.step.contacts[0].geometry.point[2] = 4;
  Arrays a = arrays_of_picture(shown.text());
  CHECK(a["points"] == Values{0.25, -2, 5, 1.0 / 3, 1e-300, 6, 9, 0.5, 4, 8, 0.75, 0});
  CHECK(a["point/velocity"] == Values{1, 3, 7, 2, -4, 8, 0, 0, 0, 0, 0, 0});
  CHECK(a["point/turn"] == Values{1, 0, 0, 0, 0, 0.6, 0.8, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  CHECK(a["point/spin"] == Values{0.5, 1.5, 2.5, 1, 2, 3, 0, 0, 0, 0, 0, 0});
  CHECK(a["cell/impulse_t"] == Values{0, 0, 0.5, 0.5, 0});
  CHECK(a.count("point/angle") == 0);
  CHECK(a.size() == 23);
}

TEST_CASE("vtp: what became of the subdomain of each contact, in a run that switches models") {
  Shown shown = two_grains_and_a_wall();
  shown.step.state.models = {{.switched = 1, .switched_iterations = 7, .velocity_distance = 0.5},
                             {.standing = 3, .switch_backs = 2, .impulse_distance = 0.25}};
  Arrays a = arrays_of_picture(shown.text());
  CHECK(a["cell/switched"] == Values{-1, -1, 0, 1, 0});
  CHECK(a["cell/switched_iterations"] == Values{-1, -1, 0, 7, 0});
  CHECK(a["cell/switch_backs"] == Values{-1, -1, 2, 0, 2});
  CHECK(a["cell/velocity_distance"] == Values{-1, -1, 0, 0.5, 0});
  CHECK(a["cell/impulse_distance"] == Values{-1, -1, 0.25, 0, 0.25});
  CHECK(a.size() == 27);
}

TEST_CASE("vtp: grains without contacts, and nothing at all") {
  Shown shown = two_grains_and_a_wall();
  shown.step.contacts = {};
  Arrays a = arrays_of_picture(shown.text());
  CHECK(a["counts"] == Values{2, 2, 0, 2});
  CHECK(a["cell/kind"] == Values{0, 0});
  CHECK(arrays_of_picture(vtp_text({}, {}))["counts"] == Values{0, 0, 0, 0});
}

TEST_CASE("vtp: steps whose arrays do not fit are refused") {
  Shown shown = two_grains_and_a_wall();
  shown.step.state.angle.pop_back();
  CHECK_THROWS_WITH_AS(shown.text(), doctest::Contains("angle"), Error);
  shown = two_grains_and_a_wall();
  shown.system.driven_by.push_back(0);
  CHECK_THROWS_WITH_AS(shown.text(), doctest::Contains("driven_by"), Error);
  for (const auto& [a, b] : {std::pair(-1, 0), std::pair(2, 0), std::pair(0, -2)}) {
    shown = two_grains_and_a_wall();
    shown.step.contacts[1].geometry.a = a;
    shown.step.contacts[1].geometry.b = b;
    CHECK_THROWS_WITH_AS(shown.text(), doctest::Contains("contact 1"), Error);
  }
}

TEST_CASE("vtp: a step of a divided box as VTK reads it") {
  Dynamics dynamics = swept();
  dynamics.solver.algorithm = "generic";
  Simulation simulation = box_of_grains(60, dynamics, {2, 1});
  take_step(simulation, solve_step(simulation));
  const GranularStep<2> step = solve_step(simulation);
  take_step(simulation, step);
  Arrays a =
      arrays_of_picture(vtp_text(simulation.system, TrajectoryStep{simulation.state, trajectory_contacts(step)}));
  CHECK(a["field/TimeValue"] == Values{simulation.state.time});
  REQUIRE(a["counts"][1] == 60);
  REQUIRE(a["counts"][2] == static_cast<double>(step.contacts.size()));
  std::vector<std::vector<Index>> held(60);
  std::size_t feet = 0;
  bool same = true;
  for (std::size_t k = 0; k < step.contacts.size(); ++k) {
    const StepContact& c = step.problem.geometry[k];
    const Index e = step.partition.subdomain_of_contact[k];
    for (const Index i : {c.a, c.b})
      if (i < 60) held[at(i)].push_back(e);
    same = same && a["lines/connectivity"][2 * k] == static_cast<double>(c.a) &&
           a["cell/impulse_n"][60 + k] == step.contacts[k].impulse.n &&
           a["cell/impulse_t"][60 + k] == step.contacts[k].impulse.t && a["cell/gap"][60 + k] == c.gap &&
           a["cell/subdomain"][60 + k] == static_cast<double>(e);
    const double second = a["lines/connectivity"][2 * k + 1];
    if (c.b < 60) {
      same = same && second == static_cast<double>(c.b);
    } else {  // the foot lies on the wall, a gap and a radius away from the centre at q_m
      same = same && second == static_cast<double>(60 + feet++);
      const auto p = static_cast<std::size_t>(second);
      if (c.b == 60) CHECK(std::abs(a["points"][3 * p + 1]) < 1e-12);
    }
    // Open: no impulse; sliding: on the edge of the cone; sticking: inside.
    const double status = a["cell/status"][60 + k], n = step.contacts[k].impulse.n,
                 t = std::abs(step.contacts[k].impulse.t);
    CHECK((status == 0) == (n == 0));
    if (status == 1) CHECK(t < 0.3 * n);
    if (status >= 2) CHECK(t == doctest::Approx(0.3 * n));
  }
  CHECK(same);
  CHECK(a["counts"][0] == 60 + static_cast<double>(feet));
  int shared = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    const std::set<Index> own(held[i].begin(), held[i].end());
    CHECK(a["point/multiplicity"][i] == static_cast<double>(own.size()));
    CHECK(a["point/subdomain"][i] == (own.empty() ? -1.0 : static_cast<double>(*own.begin())));
    CHECK(a["point/radius"][i] == simulation.system.radius[i]);
    CHECK(a["points"][3 * i] == simulation.state.x[i]);
    CHECK(a["point/velocity"][3 * i + 1] == simulation.state.velocity_y[i]);
    shared += own.size() > 1;
  }
  CHECK(shared > 0);
}

TEST_CASE("pvd: times and names, whatever characters these have") {
  const TemporaryFolder folder;
  const std::string name = "a <b> & \"c\".vtp";
  const std::string picture = two_grains_and_a_wall().text();
  write_file(folder / "0.vtp", picture);
  write_file(folder / name, picture);
  write_file(folder / "run.pvd", pvd_text({{0, "0.vtp"}, {0.1 + 0.2, name}}));
  const std::string text = read_by_vtk(folder / "run.pvd");
  CHECK(text.find("file 0.vtp 0.0\n") == 0);
  CHECK(text.find("file " + name + " 0.30000000000000004\n") != std::string::npos);
  write_file(folder / "empty.pvd", pvd_text({}));
  CHECK(read_by_vtk(folder / "empty.pvd").empty());
}
