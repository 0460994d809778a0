// SPDX-License-Identifier: GPL-3.0-or-later
// nscdd simulate: what is refused, when, by which name; files of others; what a restart leaves to be read.
#include "formats/trajectory/trajectory.hpp"
#include "session.hpp"
#include <nscdd/core/table.hpp>

#include <csignal>
#include <cstdlib>

using namespace nscdd::testing;

namespace {

const std::string generator = "generator = \"deposit\"\ngrains = 120\nwidth = 3.0\nradius_max = 0.198\n";

std::string provenance_of(const Session& session, const std::string& file, const std::string& key) {
  for (const auto& [name, text] : nscdd::read_trajectory_header(session.path(file)).provenance)
    if (name == key) return text;
  return "";
}

}  // namespace

TEST_CASE_FIXTURE(MovingSession, "simulate: a value without effect is refused, not passed over") {
  const auto refused = [&](const std::string& options, std::initializer_list<std::string> parts) {
    check_refused("simulate shear.toml -o run.h5 " + options, parts);
  };
  refused("--set solver.eta=2", {"--set solver.eta: expected solver.algorithm enriched", "met generic"});
  refused("--set solver.interface_relaxation=0.5 --algorithm nlgs",
          {"--set solver.interface_relaxation: expected solver.algorithm generic, enriched or schwarz", "met nlgs"});
  for (const std::string key : {"eta=30W", "network=active", "enrichment=first_iteration", "switch=linear",
                                "interface_method=conjugate_gradient", "coarse_kappa=10"})
    refused("--algorithm schwarz --set solver." + key,
            {"--set solver." + key.substr(0, key.find('=')) + ": expected solver.algorithm ", "met schwarz"});
  for (const std::string omega : {"0", "-0.5"})
    refused("--algorithm schwarz --set solver.interface_relaxation=" + omega,
            {"solver.interface_relaxation: expected a finite number > 0 and <= 1000, met " + omega});
  refused("--set partition.grid=2,2 --algorithm nlgs", {"--set partition.grid", "met nlgs"});
  refused("--set interaction.law=frictionless --set interaction.tangential_restitution=0.5",
          {"--set interaction.tangential_restitution: expected interaction.law", "met frictionless"});
  refused("--set interaction.restitution=0.5 --set dynamics.penetration_correction=0.5",
          {"--set dynamics.penetration_correction: expected interaction.restitution 0 with it, met 0.5"});
  refused("--criterion none --tolerance 1e-3", {"--tolerance: expected solver.criterion zeta", "met none"});
  refused("--set solver.interface_method=conjugate_gradient --set solver.interface_relaxation=0.5",
          {"--set solver.interface_relaxation: expected solver.interface_method richardson"});
  refused("--algorithm enriched --set solver.enrichment=semi_implicit --set solver.network=all",
          {"--set solver.network: expected solver.enrichment every_iteration or first_iteration"});
  refused("--subdomains 2x1 --algorithm nlgs", {"--subdomains", "met nlgs"});
  refused("--set interaction.restitution=0.5 --set dynamics.maximum_push_speed=0.5",
          {"--set dynamics.maximum_push_speed: expected interaction.restitution 0 with it, met 0.5"});
  refused("--set dynamics.penetration_correction=0 --set dynamics.maximum_push_speed=0.5",
          {"--set dynamics.maximum_push_speed: expected dynamics.penetration_correction > 0 with it, met 0"});
  refused("--set contacts.tolerance=1e-3", {"--set contacts.tolerance", "linear study"});
  refused("--steps 5 --set dynamics.steps=3", {"--set dynamics.steps: expected dynamics.steps once, met --steps too"});
  refused("--subdomains 1x2 --set partition.grid=3,1", {"--set partition.grid", "met --subdomains too"});
  refused("--set solver.tolerance=1e-3 --set solver.tolerance=1e-2", {"--set solver.tolerance", "once"});
  // in any order, and beside what gives it an effect
  answer("simulate shear.toml --steps 1 -o eta.h5 --set solver.eta=40 --algorithm enriched");
  answer(
      "simulate shear.toml --steps 1 -o cohesive.h5 --set interaction.cohesion=5 --set "
      "interaction.law=cohesive --set interaction.boundary_friction=-1");
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a loop over numbers of subdomains may begin with one") {
  const auto steps_with = [&](const std::string& options) {
    const Outcome outcome = ended(0, "simulate shear.toml --steps 2 --force --subdomains 1x1 -o run.h5 " + options);
    return outcome.standard_error;
  };
  CHECK_FALSE(contains(steps_with("--algorithm nlgs"), "without effect"));
  const auto plain = nscdd::read_last_step(path("run.h5")).state.x;
  CHECK(contains(steps_with("--algorithm enriched --eta 2 --set solver.redecompose=2"),
                 "--eta: without effect on one subdomain"));
  CHECK(nscdd::read_last_step(path("run.h5")).state.x == plain);
  CHECK(contains(steps_with("--set solver.interface_relaxation=0.5"), "--set solver.interface_relaxation"));
  steps_with("--criterion gluing");
}

TEST_CASE_FIXTURE(Session, "simulate: a case made for one algorithm can be run by another, and its trajectory read") {
  file("shear.toml", replaced(moving_case(), "algorithm = \"generic\"", "algorithm = \"enriched\"\neta = \"40\""));
  answer("simulate shear.toml --steps 1 --algorithm generic -o run.h5");
  answer("export run.h5 --vtk pictures");
  answer("simulate shear.toml --steps 2 --algorithm generic -o run.h5 --restart");
}

TEST_CASE_FIXTURE(Session, "simulate: a case without [solver] is solved by auto, and by Algorithm 1 if asked") {
  const std::string text = moving_case();
  const auto solver = text.find("[solver]");
  file("new.toml", text.substr(0, solver) + text.substr(text.find("[[boundary]]")));
  const std::string report = answer("simulate new.toml --steps 3 -o run.h5");
  CHECK(contains(report, " contacts, solved undivided by auto\nsteps: 3 converged\n"));
  answer("simulate new.toml --steps 4 --restart --criterion natural_map -o run.h5");
  const auto refused = [&](const std::string& options, const std::string& part) {
    check_refused("simulate new.toml -o none.h5 " + options, {part + " with it, met auto"});
  };
  refused("--criterion zeta", "--criterion: expected solver.algorithm nlgs, generic, enriched or schwarz");
  refused("--gauss-seidel-sweeps 1",
          "--gauss-seidel-sweeps: expected solver.algorithm nlgs, generic, enriched or schwarz");
  refused("--eta 30W", "--eta: expected solver.algorithm enriched");
  refused("--subdomains 2x1",
          "--subdomains: expected solver.algorithm generic, enriched, schwarz, accelerated, two_stage_newton or "
          "two_stage_admm");
  const std::string divided = answer(
      "simulate new.toml --steps 3 --algorithm generic --criterion zeta --tolerance "
      "1e-3 --iterations 100000 -o generic.h5");
  CHECK(contains(divided, "steps: 3 converged\n"));
  CHECK(contains(divided, "largest jump at the interface"));
  const std::string list = answer("list");
  for (const char* line : {"solver.algorithm = \"auto\"", "solver.criterion = \"natural_map\"",
                           "solver.tolerance = 1e-08", "solver.warm_start = true"})
    CHECK(contains(list, line));
}

TEST_CASE_FIXTURE(MovingSession, "simulate: every indicator that can end the iterations is a criterion") {
  for (const std::string& name : Texts{"zeta", "interface_change", "gluing", "natural_map", "quad_dv", "quad_dvr",
                                       "mean_dv_over_r", "qm_16", "normal_change"}) {
    CAPTURE(name);
    answer(
        "simulate shear.toml --steps 3 --force -o run.h5 --convergence rows.csv --iterations "
        "20000 --convergence-every 1 --tolerance 1e-3 --set solver.gluing_tolerance=1 --criterion " +
        name);
    const CsvTable rows = csv("rows.csv");
    REQUIRE(rows.rows.size() > 3);
    for (std::size_t k = 0; k < rows.rows.size(); ++k) {
      const bool last = k + 1 == rows.rows.size() || rows.text(k + 1, "step") != rows.text(k, "step");
      const double value = rows.number(k, name);
      // What a subdomain has no part of yet (nothing jumps, F stays) says nothing.
      if (value != 0) CHECK((std::abs(value) <= 1e-3) == last);
    }
  }
  check_refused(
      "simulate shear.toml -o none.h5 --criterion gluing --algorithm enriched --set "
      "solver.enrichment=semi_implicit",
      {"solver.criterion", "met semi_implicit"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: what options and case say is judged before a packing is settled") {
  ::setenv("NSCDD_CACHE", (folder / "cache").c_str(), 1);
  const std::string text = replaced(moving_case(), generator, "settled = \"shear.toml\"\n");
  file("test.toml", text);
  file("wide.toml", replaced(text, "radius = 0.198\n[[", "radius = 1e-9\n[["));
  file("other.h5", "");
  file("study/study.toml",
       "[[table]]\nname = \"t\"\nobservable = \"runs\"\ncases = \"../test.toml\"\nsteps = 2\n"
       "vary = { \"solver.algorithm\" = [\"jacobi\"] }\n");
  const auto refused = [&](const std::string& line, std::initializer_list<std::string> parts) {
    check_refused(line, parts);
    CHECK_FALSE(has("cache"));
  };
  refused("simulate test.toml -o run.h5 --criterion speed", {"--criterion: expected one of \"zeta\"", "met \"speed\""});
  refused("simulate test.toml -o run.h5 --criterion gluing --algorithm nlgs", {"solver.criterion"});
  refused("simulate test.toml -o run.h5 --algorithm enriched --eta 10X",
          {"--eta: expected \"optimal\"", "30 W", "met \"10X\""});
  refused("simulate test.toml -o run.h5 --set solver.eta=2", {"--set solver.eta"});
  refused("simulate test.toml -o run.h5 --set solver.speed=2", {"solver.speed"});
  refused("simulate test.toml -o run.h5 --subdomains 100000x100000", {"partition.grid", "100000"});
  refused("simulate test.toml -o run.h5 --convergence nowhere/rows.csv", {"nowhere"});
  refused("simulate test.toml -o run.h5 --convergence shear.toml", {"shear.toml", "exists already"});
  refused("simulate test.toml -o other.h5 --restart", {"other.h5", "trajectory"});
  refused("simulate wide.toml -o run.h5", {"wide.toml:20: boundary 'floor': spacing: expected"});
  refused("inspect test.toml --set contacts.tolerence=1", {"contacts.tolerence"});
  refused("run study", {"study.toml:6", "solver.algorithm", "jacobi"});
  ::unsetenv("NSCDD_CACHE");
}

TEST_CASE_FIXTURE(MovingSession, "simulate: a trajectory keeps the command lines of its start and restarts") {
  answer("simulate shear.toml --steps 2 -o run.h5");
  CHECK(provenance_of(*this, "run.h5", "restarts") == "");
  const std::string first = provenance_of(*this, "run.h5", "command_line");
  answer("simulate shear.toml --steps 3 --restart -o run.h5 --threads 1");
  answer("simulate shear.toml --steps 5 --restart -o run.h5");
  CHECK(provenance_of(*this, "run.h5", "command_line") == first);
  const std::string restarts = provenance_of(*this, "run.h5", "restarts");
  const std::string program = "nscdd " + nscdd::version() + ": ";
  CHECK(std::count(restarts.begin(), restarts.end(), '\n') == 2);
  CHECK(restarts.find("from step 2: " + program) == 0);
  CHECK(restarts.find("--threads 1\nfrom step 3: " + program) != std::string::npos);
  CHECK(contains(restarts, "simulate shear.toml --steps 5 --restart -o run.h5\n"));
}

TEST_CASE_FIXTURE(MovingSession, "simulate: files of others beside the trajectory are neither replaced nor removed") {
  for (const std::string& name : Texts{"run.h5.next", "run.h5.previous", "run.h5.lock"}) {
    file(name, "mine");
    check_refused("simulate shear.toml --steps 2 -o run.h5", {name, "move it away"});
    std::filesystem::remove(folder / name);
  }
  answer("simulate shear.toml --steps 2 -o run.h5");
  file("run.h5.next", "mine");
  check_refused("simulate shear.toml --steps 3 -o run.h5 --restart", {"run.h5.next", "move it away"});
  check_refused("simulate shear.toml --steps 3 -o run.h5 --force", {"run.h5.next", "move it away"});
}

TEST_CASE_FIXTURE(MovingSession, "simulate: what a killed run leaves beside the trajectory is its own") {
  REQUIRE(
      run("simulate shear.toml --steps 4000 --save-every 1000 -o run.h5", {.signal_at = SignalAt{"run.h5*", 300'000}})
          .exit_code == 128 + SIGKILL);
  REQUIRE(has("run.h5.lock"));
  file("run.h5.next", "damaged");
  file("run.h5.previous", "damaged");
  answer("simulate shear.toml --steps 4 -o run.h5 --force");
  CHECK_FALSE(has("run.h5.lock"));
  CHECK_FALSE(has("run.h5.next"));
  CHECK_FALSE(has("run.h5.previous"));
}

TEST_CASE_FIXTURE(Session, "simulate: errors of disks and walls name the file, and the boundary or the key") {
  const std::string rest = "[masses]\nmodel = \"unit\"\n[partition]\ngrid = [1, 1]\n[dynamics]\nsteps = 1\n";
  file("two.csv", "x,y,radius\n0,0,1\n5,0,1\n");
  file("inside.csv", "x,y,radius\n0,0,1\n1.2,0,1\n");
  const auto refused = [&](const std::string& packing, const std::string& more,
                           std::initializer_list<std::string> parts) {
    file("c.toml", "[packing]\nfile = \"" + packing + "\"\n" + rest + more);
    check_refused("simulate c.toml -o run.h5", parts);
  };
  const std::string drum =
      "[[boundary]]\nname = \"drum\"\nshape = \"disks\"\nfrom = [5, 1.2]\nto = [9, 1.2]\nradius = 1\n";
  const std::string piston = "[[boundary]]\nname = \"piston\"\nshape = \"grains\"\nfirst = 1\nlast = ";
  refused("inside.csv", "", {"c.toml: disk 0 and disk 1: expected an overlap"});
  refused("two.csv", drum, {"c.toml: disk 1 and disk 2 of boundary 'drum': expected an overlap"});
  refused("two.csv", "[[boundary]]\nname = \"floor\"\nshape = \"wall\"\nfrom = [0, 0]\nto = [1, 0]\n",
          {"c.toml: disk 0 and the wall of boundary 'floor': expected an overlap"});
  refused("two.csv", piston + "2\n", {"c.toml:12: boundary[0].first: expected grains", "of boundary 'piston'"});
  refused("two.csv", piston + "1\n[[prescribed]]\ngrain = -1\nvelocity = [1, 0]\n",
          {"c.toml:15: prescribed[0].grain: expected a free grain, met disk 1 of boundary 'piston'"});
  refused("two.csv", "[[prescribed]]\ngrain = 7\nvelocity = [1, 0]\n",
          {"c.toml:10: prescribed[0].grain", "met grain 7"});
}

TEST_CASE_FIXTURE(Session, "simulate: a packing with clumps falls as it is, and goes on after a restart") {
  file("c.txt", "#format x_y_z_r_clumpId\n0\t0\t0\t0.5\t3\n5\t0\t0\t0.5\t-1\n0.3\t0\t0.7\t0.5\t3\n");
  const std::string options = " --set masses.density=1000 --set dynamics.step=0.01 -o ";
  CHECK(contains(answer("simulate c.txt --steps 10" + options + "whole.h5"), "spheres: 1 free, 2 in 1 body"));
  answer("simulate c.txt --steps 4" + options + "run.h5");
  answer("simulate c.txt --steps 10 --restart" + options + "run.h5");
  const nscdd::GranularState one = nscdd::read_last_step(path("whole.h5")).state,
                             other = nscdd::read_last_step(path("run.h5")).state;
  CHECK(one.z[1] == doctest::Approx(-9.81 * 0.01 / 2).epsilon(1e-13));
  CHECK(one.z[2] == doctest::Approx(0.7 - 9.81 * 0.01 / 2).epsilon(1e-13));
  CHECK(one.z == other.z);
  CHECK(one.x == other.x);
}
