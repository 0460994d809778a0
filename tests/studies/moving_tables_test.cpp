// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of cases that move: how they get to the step they look at, whole runs, and what a comparison sees.
#include "../support/moving_case.hpp"
#include "../support/spoilt.hpp"
#include "../support/studies.hpp"
#include "files/csv.hpp"
#include "formats/case/case_file.hpp"
#include "formats/contact_problem/step_fclib.hpp"
#include "simulation/simulation.hpp"
#include "study/tables/study.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

StudyTable moving_table(const std::string& observable, const std::string& more,
                        const std::string& text = moving_case()) {
  const auto read = [&](const std::string&) { return parse_case(text, "small.toml"); };
  return parse_study("[[table]]\nname = \"t\"\nobservable = \"" + observable + "\"\ncases = [\"small\"]\n" + more,
                     "s/study.toml", read)
      .tables[0];
}

// With another [solver], whose tolerance Algorithm 1 would not come to.
std::string solved_by(const std::string& algorithm) {
  std::string text = moving_case();
  const auto solver = text.find("[solver]");
  return text.replace(solver, text.find("[[boundary]]") - solver,
                      "[solver]\nalgorithm = \"" + algorithm +
                          "\"\nwarm_start = false\ntolerance = 1e-8\nmaximum_iterations = 20000\n");
}

struct Run {
  Simulation simulation;
  Index iterations = 0, converged = 0;
  double natural_map = 0, gluing = 0, kinetic = 0;
};

Run run_of(const Case& one, Index steps) {
  Run result{simulation_of(one)};
  result.simulation.dynamics.time.steps = steps;
  RunSinks sinks;
  sinks.step = [&](const Simulation&, const AnySolvedStep&, const StepReport& report) {
    result.iterations += report.last.iteration;
    result.converged += report.status == SolverStatus::converged;
    result.natural_map = std::max(result.natural_map, report.residual.relative_natural_map());
    result.gluing = std::max(result.gluing, report.last.gluing);
    result.kinetic = report.energy.kinetic;
  };
  run_simulation(result.simulation, sinks);
  return result;
}

double number(const Table& table, std::size_t row, const std::string& column) {
  return std::get<double>(table.rows[row][table.column(column)]);
}
std::int64_t integer(const Table& table, std::size_t row, const std::string& column) {
  return std::get<std::int64_t>(table.rows[row][table.column(column)]);
}

}  // namespace

TEST_CASE("runs: a row tells of the run that the solver of the case makes, plain Gauss-Seidel apart") {
  const StudyTable work = moving_table("runs", "steps = [3, 6]\n");
  const Table table = run(work);
  REQUIRE(table.rows.size() == 2);
  for (std::size_t row = 0; row < 2; ++row) {
    const Index steps = row == 0 ? 3 : 6;
    const Run expected = run_of(work.cases[0], steps);
    CHECK(integer(table, row, "steps") == steps);
    CHECK(integer(table, row, "iterations") == expected.iterations);
    CHECK(integer(table, row, "converged_steps") == expected.converged);
    CHECK(number(table, row, "natural_map") == expected.natural_map);
    CHECK(number(table, row, "gluing") == expected.gluing);
    CHECK(number(table, row, "kinetic") == expected.kinetic);
  }
  // Forty iterations are not enough for one solution, so the runs part.
  CHECK(number(table, 1, "distance_maximum") > number(table, 0, "distance_maximum"));
  CHECK(number(table, 0, "distance_mean") > 0);
  CHECK(number(table, 0, "distance_mean") < number(table, 0, "distance_maximum"));
}

TEST_CASE("lead_in: with its own solver a configuration is that of a simulation, else that of Gauss-Seidel") {
  const StudyTable plain = moving_table("configuration", "steps = [0, 4]\n");
  const StudyTable own = moving_table("configuration", "steps = [0, 4]\nlead_in = \"own\"\n");
  const Table with_plain = run(plain), with_own = run(own);
  const Run expected = run_of(own.cases[0], 4);
  const auto disks = expected.simulation.state.x.size();
  REQUIRE(with_own.rows.size() == 2 * disks);
  double apart = 0;
  for (std::size_t i = 0; i < disks; ++i) {
    CHECK(number(with_own, i, "x") == number(with_plain, i, "x"));  // at the start
    CHECK(number(with_own, disks + i, "x") == expected.simulation.state.x[i]);
    CHECK(number(with_own, disks + i, "y") == expected.simulation.state.y[i]);
    apart = std::max(apart, std::abs(number(with_plain, disks + i, "y") - expected.simulation.state.y[i]));
  }
  CHECK(apart > 0);
}

TEST_CASE("lead_in: whatever led to a state, what comes next is solved as the case says") {
  const Case one = moving_table("configuration", "steps = [2]\n").cases[0];
  for (const LeadInSolver solver : {LeadInSolver::plain, LeadInSolver::own}) {
    const Arrival arrival = LeadIn().at(one, 2, solver);
    CHECK(arrival.simulation.state.step == 2);
    CHECK(to_toml(arrival.simulation.dynamics) == to_toml(*one.spec.dynamics));
  }
}

TEST_CASE("lead_in: tables that share the way get the rows of tables that do not") {
  const StudyTable chains = moving_table("force_chains", "steps = [4, 2]\nlead_in = \"own\"\n");
  LeadIn lead_in;
  Table shared{study_columns(chains), {}};
  run_table(
      moving_table("runs", "steps = [4]\n"), [](const Row&) {}, {}, 0, &lead_in);
  run_table(
      chains, [&](const Row& row) { shared.rows.push_back(row); }, {}, 0, &lead_in);
  const Table alone = run(chains);
  REQUIRE(alone.rows.size() > 100);
  CHECK(shared.rows == alone.rows);
}

TEST_CASE("lead_in: refused where it is none, and where a run has no other") {
  CHECK_THROWS_WITH_AS(moving_table("indicators", "lead_in = \"mine\"\n"),
                       doctest::Contains("lead_in: expected one of \"plain\", \"own\""), Error);
  check_error([] { moving_table("runs", "lead_in = \"plain\"\n"); }, {"lead_in: expected \"own\""});
}

TEST_CASE("resume: other steps or another lead-in are other work") {
  const auto record = [](const std::string& more) { return work_identity(moving_table("configuration", more)); };
  const WorkIdentity one = record("steps = [3]\n");
  CHECK(difference(one, record("steps = [3]\n")) == "");
  CHECK(difference(one, record("steps = [4]\n")) != "");
  CHECK(difference(one, record("steps = [3]\nlead_in = \"own\"\n")) != "");
}

TEST_CASE("a relative comparison sees small numbers that an absolute one lets pass") {
  const Table table{{{"z", "", ""}}, {{2e-5}, {0.0}}};
  const CsvText same = parse_csv("z\n2.00001e-5\n0\n", "t"), other = parse_csv("z\n3e-5\n0\n", "t");
  CHECK(compare(table, other, 1e-3) == "");
  CHECK(compare(table, other, 1e-3, {}, true) != "");
  CHECK(compare(table, same, 1e-3, {}, true) == "");
  CHECK(compare(table, same, 1e-3, {{"z", 1e-6}}, true) != "");
}

TEST_CASE("a wrong rate does not pass: predicted and observed are compared within parts of 1 - rho") {
  const Study study = read_study("predicted-observed");
  for (std::size_t i = 0; i < study.tables.size(); ++i) {
    const StudyTable& work = study.tables[i];
    if (!work.baseline) continue;
    const std::string path = baseline_path(study, i);
    const CsvText baseline = parse_csv(read_text(path), path);
    const Table right = untyped_table(baseline);
    REQUIRE(compare(right, baseline, work.check_tolerance, work.column_tolerance) == "");
    for (const char* column : {"predicted", "predicted_exact", "observed"})
      for (std::size_t row = 0; row < right.rows.size(); ++row) {
        Table wrong = right;
        double& rate = std::get<double>(wrong.rows[row][wrong.column(column)]);
        if (std::isnan(rate)) continue;
        rate = 1 - 1.01 * (1 - rate);
        CHECK(compare(wrong, baseline, work.check_tolerance, work.column_tolerance) != "");
      }
  }
}

TEST_CASE("contact_solvers: a row per step and solver, of the contact problem that an export of the step holds") {
  const StudyTable work = moving_table("contact_solvers", "steps = [1, 5]\ncontact_solvers = [\"nlgs\", \"auto\"]\n");
  const Table table = run(work);
  REQUIRE(table.rows.size() == 4);
  CHECK(row_count(work) == 4);
  LeadIn lead_in;
  for (std::size_t row = 0; row < 4; ++row) {
    CAPTURE(row);
    const Simulation before = lead_in.at(work.cases[0], row < 2 ? 0 : 4).simulation;
    const auto problem = std::get<LocalFrictionProblem>(local_form(fclib_of_step(before, nullptr)).problem);
    const FrictionSolution found =
        solve_friction(problem, {.algorithm = row % 2 == 0 ? FrictionAlgorithm::nlgs : FrictionAlgorithm::automatic});
    CHECK(integer(table, row, "step") == (row < 2 ? 1 : 5));
    CHECK(integer(table, row, "contacts") == problem.contacts());
    CHECK(std::get<std::string>(table.rows[row][table.column("solver")]) == (row % 2 == 0 ? "nlgs" : "auto"));
    CHECK(integer(table, row, "sweeps") == found.sweeps);
    CHECK(number(table, row, "residual") == found.state.residual);
    for (const auto& [column, cell] : known_cells(work, static_cast<Index>(row)))
      CHECK(to_text(table.rows[row][table.column(column)]) == to_text(cell));
  }
  // Rows that are there already are not computed again.
  Table rest;
  run_table(
      work, [&](const Row& row) { rest.rows.push_back(row); }, {}, 3);
  REQUIRE(rest.rows.size() == 1);
  CHECK(to_text(rest.rows[0][table.column("step")]) == "5");
  CHECK(to_text(rest.rows[0][table.column("solver")]) == "auto");
}

TEST_CASE("contact_solvers: names that there are, each once, and a law whose contacts open") {
  const auto refused = [](const std::string& observable, const std::string& more, const std::string& part) {
    CAPTURE(more);
    check_error([&] { moving_table(observable, more); }, {part});
  };
  refused("contact_solvers", "contact_solvers = [\"newtn\"]\n", "study.toml:5: contact_solvers: expected one of");
  refused("contact_solvers", "contact_solvers = [\"auto\", \"auto\"]\n", "expected each solver once, met 'auto' again");
  refused("runs", "contact_solvers = [\"auto\"]\n", "an observable that uses this key (contact_solvers)");
  refused("contact_solvers", "vary = { \"interaction.law\" = [\"linear_viscous\"], \"interaction.epsilon\" = [1] }\n",
          "interaction.law: expected a law with open contacts, met linear_viscous");
}

TEST_CASE("interface_iterations: a row has the step as its solver takes it, and what its spectrum predicts") {
  const std::string more = "steps = [2]\n[table.vary]\n\"partition.grid\" = [\"2,1\", \"3,2\"]\n";
  const auto study = [&](const std::string& algorithm) {
    return moving_table("interface_iterations", more, solved_by(algorithm));
  };
  CHECK_THROWS_WITH_AS(study("auto"), doctest::Contains("expected two_stage_newton, met auto"), Error);
  const StudyTable work = study("two_stage_newton");
  const Table table = run(work);
  REQUIRE(table.rows.size() == 2);
  for (std::size_t row = 0; row < 2; ++row) {
    LeadIn lead_in;
    const VariedCase varied = varied_case(work, static_cast<Index>(row));
    const GranularStep<2> step = solve_step(lead_in.at(varied.one, 1).simulation);
    CHECK(integer(table, row, "subdomains") == (row == 0 ? 2 : 6));
    CHECK(integer(table, row, "outer_steps") == step.report.factorisations);
    CHECK(integer(table, row, "outer_steps") == integer(table, row, "outer_steps_undivided"));
    CHECK(number(table, row, "iterations_per_system") * static_cast<double>(integer(table, row, "systems")) ==
          doctest::Approx(static_cast<double>(step.report.interface_iterations)));
    CHECK(number(table, row, "natural_map") <= 1e-7);
    Simulation rival = lead_in.at(varied.one, 1).simulation;
    rival.dynamics.solver.algorithm = "admm";
    CHECK(integer(table, row, "admm_iterations") == solve_step(rival).report.last.sweeps);
    for (const std::string name : {"generic", "enriched", "admm"}) {
      CAPTURE(name);
      CHECK(std::get<bool>(table.rows[row][table.column(name + "_converged")]));
      CHECK(integer(table, row, name + "_iterations") > 0);
    }
    for (const std::string network : {"none", "all", "active"}) {
      const auto measured = static_cast<double>(integer(table, row, "iterations_" + network));
      CHECK(std::abs(measured - number(table, row, "predicted_" + network)) <= 3 + 0.2 * measured);
    }
    CHECK(integer(table, row, "iterations_active") < integer(table, row, "iterations_none"));
  }
}

TEST_CASE("interface_iterations of spheres: what the spectrum predicts, with directions that turn") {
  const std::string folder = (source_folder() / "studies/newton-scalability-in-space").string();
  const auto read = [&](const std::string& name) { return parse_case(read_text(folder + "/" + name), name); };
  const StudyTable work = parse_study(
                              "[[table]]\nname = \"t\"\nobservable = \"interface_iterations\"\n"
                              "cases = [\"deposit.toml\"]\nsteps = [3]\n[table.vary]\n"
                              "\"packing.grains\" = [96]\n\"partition.grid\" = [\"2,1,1\", \"2,2,1\"]\n",
                              "s/study.toml", read)
                              .tables[0];
  const Table table = run(work);
  REQUIRE(table.rows.size() == 2);
  for (std::size_t row = 0; row < 2; ++row) {
    CHECK(integer(table, row, "slide") > 0);
    CHECK(integer(table, row, "outer_steps") == integer(table, row, "outer_steps_undivided"));
    for (const std::string network : {"none", "all", "active"}) {
      CAPTURE(network);
      const auto measured = static_cast<double>(integer(table, row, "iterations_" + network));
      CHECK(measured > 5);
      CHECK(std::abs(measured - number(table, row, "predicted_" + network)) <= 3 + 0.2 * measured);
    }
    CHECK(integer(table, row, "iterations_active") < integer(table, row, "iterations_none"));
  }
}

TEST_CASE("interface_iterations: contacts that pull are not open") {
  std::string text = solved_by("two_stage_newton");
  text.replace(text.find("[interaction]\n"), 14, "[interaction]\nlaw = \"cohesive\"\ncohesion = 1e7\n");
  const Table table = run(moving_table("interface_iterations", "steps = [2]\n", text));
  REQUIRE(table.rows.size() == 1);
  CHECK(integer(table, 0, "stick") > 100);
  // With all of them open S is that of loose grains, and one iteration is enough.
  CHECK(integer(table, 0, "iterations_none") > 5);
  CHECK(number(table, 0, "predicted_none") > 5);
}

TEST_CASE("solver_indicators: the checks of a contact solver, the last with what the step is known for") {
  const std::string more =
      "steps = [2]\n[table.vary]\n\"solver.algorithm\" = [\"two_stage_newton\", \"two_stage_admm\", \"newton\"]\n"
      "\"solver.tolerance\" = [1e-9]\n\"solver.maximum_iterations\" = [1000]\n";
  CHECK_THROWS_WITH_AS(
      moving_table("solver_indicators", "steps = [2]\n[table.vary]\n\"solver.algorithm\" = [\"generic\"]\n"),
      doctest::Contains("expected a contact solver, met generic"), Error);
  const StudyTable work = moving_table("solver_indicators", more);
  const Table table = run(work);
  LeadIn lead_in;
  std::size_t row = 0;
  for (Index k = 0; k < 3; ++k) {
    CAPTURE(k);
    const VariedCase varied = varied_case(work, k);
    const GranularStep<2> step = solve_step(lead_in.at(varied.one, 1).simulation);
    REQUIRE(step.report.status == SolverStatus::converged);
    const std::string algorithm(to_string(varied.one.spec.dynamics->solver.algorithm));
    const std::size_t first = row;
    while (row < table.rows.size() && std::get<std::string>(table.rows[row][table.column("algorithm")]) == algorithm)
      ++row;
    REQUIRE(row > first + 3);
    for (std::size_t i = first + 1; i < row; ++i)
      for (const char* column : {"iteration", "sweeps", "factorisations", "interface_iterations"})
        CHECK(integer(table, i, column) >= integer(table, i - 1, column));
    CHECK(integer(table, row - 1, "sweeps") == step.report.last.sweeps);
    CHECK(integer(table, row - 1, "factorisations") == step.report.factorisations);
    CHECK(integer(table, row - 1, "interface_iterations") == step.report.interface_iterations);
    CHECK((step.report.interface_iterations > 0) == (k < 2 && step.report.factorisations > 0));
    CHECK((k != 1 || step.report.factorisations > 0));
    CHECK(number(table, row - 1, "natural_map") == step.report.residual.relative_natural_map());
  }
  CHECK(row == table.rows.size());
}
