// SPDX-License-Identifier: GPL-3.0-or-later
// `nscdd solve`, and contact problems in place of cases.
#include "../support/fclib_files.hpp"
#include "session.hpp"
#include <nscdd/contact_solvers/friction_solver.hpp>
#include <nscdd/formats/fclib.hpp>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

GlobalFrictionProblem box() { return random_bodies_problem(4, 12, 20); }

}  // namespace

TEST_CASE_FIXTURE(Session, "solve: a report, the convergence and the solution, of a global and a local problem") {
  file("global.hdf5", raw_global(box(), Storage::rows).bytes());
  file("local.hdf5", raw_local(reduce(box()), Storage::triplets).bytes());
  const std::string report = answer("solve global.hdf5 --tolerance 1e-10 --convergence c.csv -o solved.hdf5");
  CHECK(value(report, "status") == "converged");
  CHECK(value(report, "contacts") == "20");
  CHECK(value(report, "problem") == "global,");
  CHECK(std::stod(value(report, "residual")) <= 1e-10);
  const Index open = std::stol(value(report, "open contacts")), stick = std::stol(value(report, "sticking contacts")),
              slide = std::stol(value(report, "sliding contacts"));
  CHECK(open + stick + slide == 20);
  CHECK(open < 20);

  const CsvTable checks = csv("c.csv");
  REQUIRE(checks.rows.size() >= 2);
  CHECK(checks.number(0, "sweeps") == 0);
  CHECK(checks.text(checks.rows.size() - 1, "sweeps") == value(report, "sweeps"));
  CHECK(checks.number(checks.rows.size() - 1, "residual") <= 1e-10);
  CHECK(checks.number(checks.rows.size() - 1, "slide") == static_cast<double>(slide));

  const FclibFile solved = fclib_from_hdf5(read("solved.hdf5"), "solved.hdf5");
  REQUIRE(solved.solution);
  const FrictionState state = friction_state(reduce(box()), solved.solution->r);
  CHECK(state.residual <= 1e-10);
  CHECK((state.velocities - solved.solution->u).norm() < 1e-13);
  CHECK((box().h.transpose() * solved.solution->v + box().w - solved.solution->u).norm() < 1e-12);

  const std::string local = answer("solve local.hdf5 --tolerance 1e-10 -o local-solved.hdf5");
  CHECK(value(local, "problem") == "local");
  CHECK(value(local, "status") == value(report, "status"));
  const FclibFile also = fclib_from_hdf5(read("local-solved.hdf5"), "local-solved.hdf5");
  REQUIRE(also.solution);
  CHECK((also.solution->r - solved.solution->r).norm() < 1e-8);
}

TEST_CASE_FIXTURE(Session, "solve: not converged is exit code 1, and a guess to go on from") {
  file("p.hdf5", raw_global(box()).bytes());
  const Outcome short_run = ended(1, "solve p.hdf5 --solver nlgs --maximum-sweeps 3 -o some.hdf5 --tolerance 1e-12",
                                  {"written as guess 1, not as the solution"});
  CHECK(value(short_run.standard_output, "status") == "maximum_reached");
  CHECK(value(short_run.standard_output, "sweeps") == "3");
  CHECK(value(short_run.standard_output, "largest residuals") == "contacts");
  CHECK(std::stol(value(short_run.standard_output, "unsettled statuses")) > 0);
  const FclibFile some = fclib_from_hdf5(read("some.hdf5"), "some.hdf5");
  CHECK_FALSE(some.solution);
  CHECK(some.guesses.size() == 1);
  const std::string rest =
      answer("solve some.hdf5 --guess 1 --tolerance 1e-8 -o done.hdf5 --order reverse --relaxation 0.9");
  CHECK(value(rest, "status") == "converged");
  const Vector r = fclib_from_hdf5(read("done.hdf5"), "").solution->r, before = some.guesses[0].r;
  CHECK(std::stod(value(rest, "distance from guess")) ==
        doctest::Approx((r - before).norm() / before.norm()).epsilon(1e-3));
  for (const std::string& order : all_names<SweepOrder>())
    CHECK(value(answer("solve p.hdf5 --solver nlgs --threads 2 --order " + order), "status") == "converged");
  const std::string none = answer("solve some.hdf5 --guess 1 --tolerance 1");
  CHECK((value(none, "sweeps") == "0" && value(none, "distance from guess") == "0.000e+00"));
  const std::string curve = answer("solve p.hdf5 --solver continuation --tolerance 1e-10 --convergence p.csv");
  CHECK(value(curve, "status") == "converged");
  CHECK(value(curve, "sweeps") == "0");
  const CsvTable checks = csv("p.csv");
  CHECK(checks.text(checks.rows.size() - 1, "factorisations") == value(curve, "factorisations"));
  CHECK(checks.text(0, "step_length") == "nan");
  double newton = 0, along_curve = 0, changes = 0;
  for (std::size_t k = 1; k < checks.rows.size(); ++k) {
    const bool is_newton = checks.text(k, "proximal_weight") != "nan";
    ++(is_newton ? newton : along_curve);
    CHECK(checks.number(k, "step_length") > 0);
    if (is_newton) CHECK(checks.number(k, "step_length") <= 1);
    changes += checks.number(k, "status_changes");
    const double opened = std::abs(checks.number(k, "open") - checks.number(k - 1, "open"));
    CHECK(checks.number(k, "status_changes") >= opened);
  }
  CHECK(newton > 0);
  CHECK(along_curve > 3);
  CHECK(changes > 0);
  check_refused("solve p.hdf5 --solver lemke", {"--solver", "continuation"});
  check_refused("solve some.hdf5 --guess 2", {"--guess", "expected one of the 1 guesses", "met 2"});
  check_refused("solve some.hdf5 --guess -1", {"--guess", "or 0 for none, met -1\n"});
  RawFclib raw = raw_global(box());
  raw.integers["guesses/number_of_guesses"] = {-5};
  file("less.hdf5", raw.bytes());
  check_refused("solve less.hdf5", {"guesses/number_of_guesses", "expected a number from 0", "met -5"});
}

TEST_CASE_FIXTURE(Session, "solve: a verdict where no solution exists, and on request") {
  // A disk between two walls that close at 0.1 m/s.
  GlobalFrictionProblem walls;
  const Vector inertia = (Vector(3) << 1, 1, 0.125).finished();
  walls.mass = Matrix(inertia.asDiagonal()).sparseView();
  walls.h = (Matrix(3, 4) << 1, 0, -1, 0, 0, 1, 0, -1, 0, -0.5, 0, -0.5).finished().sparseView();
  walls.f = Vector::Zero(3);
  walls.w = (Vector(4) << 0, 0, -0.1, 0).finished();
  walls.friction = Vector::Constant(2, 0.3);
  file("walls.hdf5", raw_global(walls).bytes());
  const Outcome closing = ended(1, "solve walls.hdf5", {"contacts 0, 1, of bodies 0, close at 0.1 m/s"});
  CHECK(value(closing.standard_output, "status") == "impossible");
  CHECK(value(closing.standard_output, "verdict") == "impossible:");
  CHECK(value(closing.standard_output, "  largest margin") == "-0.05");
  file("local.hdf5", raw_local(reduce(walls)).bytes());
  ended(1, "solve local.hdf5 --tolerance 1 --verdict", {"contacts 0, 1 close at 0.1 m/s"});

  file("p.hdf5", raw_global(box()).bytes());
  const std::string report = answer("solve p.hdf5 --verdict");
  CHECK(value(report, "status") == "converged");
  CHECK(value(report, "verdict") == "exists:");
  CHECK(answer("solve p.hdf5").find("verdict") == std::string::npos);
  const Outcome failed = ended(1, "solve p.hdf5 --solver nlgs --maximum-sweeps 3 --tolerance 1e-12", {});
  CHECK(value(failed.standard_output, "status") == "maximum_reached");
  CHECK(value(failed.standard_output, "verdict") == "exists:");

  // Of a folder: one verdict for all solvers of a problem.
  file("folder/p.hdf5", raw_global(box()).bytes());
  file("folder/walls.hdf5", raw_global(walls).bytes());
  answer("solve folder --solver auto --solver nlgs --csv some.csv");
  const CsvTable some = csv("some.csv");
  REQUIRE(some.rows.size() == 4);
  for (const std::size_t row : {0U, 1U}) {
    CHECK(some.text(row, "verdict") == "none");
    CHECK(some.text(row, "margin") == "nan");
    CHECK(some.text(row + 2, "status") == "impossible");
    CHECK(some.text(row + 2, "verdict") == "impossible");
    CHECK(some.number(row + 2, "margin") == doctest::Approx(-0.05).epsilon(1e-6));
  }
  const CsvTable every = table("solve folder --solver auto --solver nlgs --verdict");
  for (const std::size_t row : {0U, 1U}) {
    CHECK(every.text(row, "verdict") == "exists");
    CHECK(every.number(row, "margin") > 0);
    CHECK(every.text(row, "status") == "converged");
    CHECK(every.text(row + 2, "verdict") == "impossible");
  }
}

TEST_CASE_FIXTURE(Session, "solve: bad input is refused, and nothing is overwritten") {
  const std::string good = raw_global(box()).bytes();
  file("p.hdf5", good);
  file("old.hdf5", "precious");
  file("old.csv", "precious");
  file("cut.hdf5", good.substr(0, good.size() / 2));
  file("text.hdf5", "no problem at all\n");
  RawFclib solid = raw_global(box());
  solid.integers["fclib_global/spacedim"] = {3};
  file("solid.hdf5", solid.bytes());
  RawFclib outside = raw_global(box());
  outside.integers["fclib_global/H/i"][2] = 36;
  file("outside.hdf5", outside.bytes());
  check_refused("solve p.hdf5 -o old.hdf5", {"old.hdf5", "exists already"});
  check_refused("solve p.hdf5 --convergence old.csv", {"old.csv", "exists already"});
  check_refused("solve p.hdf5 -o p.hdf5 --force", {"p.hdf5", "would be lost"});
  check_refused("solve p.hdf5 --convergence x.h5 -o x.h5", {"the same twice"});
  check_refused("solve p.hdf5 -o -", {"-: expected the name of a file that ends in .h5"});
  check_refused("solve none.hdf5", {"none.hdf5"});
  check_refused("solve cut.hdf5", {"cut.hdf5", "HDF5 of FCLIB"});
  check_refused("solve text.hdf5 -o new.hdf5", {"text.hdf5", "HDF5 of FCLIB"});
  check_refused("solve solid.hdf5", {"solid.hdf5: fclib_global/", "expected"});
  check_refused("solve outside.hdf5", {"fclib_global/H/i", "met 36 at position 2"});
  check_refused("solve p.hdf5 --tolerance 0", {"--tolerance: expected a finite number > 0"});
  check_refused("solve p.hdf5 --relaxation 2", {"relaxation"});
  check_refused("solve p.hdf5 --order sideways", {"--order", "coloured"});
  check_refused("solve p.hdf5 --order random --seed -1", {"--seed"});
  CHECK_FALSE(has("new.hdf5"));
  CHECK(run("solve p.hdf5 -o old.hdf5 --force").exit_code == 0);
  CHECK(fclib_from_hdf5(read("old.hdf5"), "old.hdf5").solution.has_value());
}

TEST_CASE_FIXTURE(Session, "solve: numbers whose squares overflow or vanish, and what is no number, are refused") {
  for (const auto& [factor, part] : {std::pair(1e170, "e+1"), std::pair(1e-170, "e-1")}) {
    LocalFrictionProblem problem = reduce(box());
    problem.q *= factor;
    file("far.hdf5", raw_local(problem).bytes());
    check_refused("solve far.hdf5", {"far.hdf5: largest |q|: expected a number from 1e-140 to 1e+140", part});
  }
  LocalFrictionProblem problem = reduce(box());
  problem.q *= 1e100;
  problem.w *= 1e-100;
  file("far.hdf5", raw_local(problem).bytes());
  check_refused("solve far.hdf5", {"far.hdf5: largest |q| over the least of W_nn and W_tt: expected"});
  problem = reduce(box());
  problem.q *= 1e-100;
  file("small.hdf5", raw_local(problem).bytes());
  CHECK(value(answer("solve small.hdf5 --solver admm"), "status") == "converged");
  problem.q[3] = not_a_number;
  file("none.hdf5", raw_local(problem).bytes());
  check_refused("solve none.hdf5", {"none.hdf5", "q"});
}

TEST_CASE_FIXTURE(Session, "solve: an interrupted run leaves its rows and the impulses that it had") {
  const GlobalFrictionProblem problem = random_bodies_problem(7, 1000, 2300);
  file("p.hdf5", raw_global(problem).bytes());
  ended(130,
        "solve p.hdf5 --solver nlgs --tolerance 1e-30 --check-every 1 "
        "--convergence c.csv -o some.hdf5",
        {"interrupted after"}, {.signal_at = SignalAt{"c.csv.partial", 4000, SIGINT}});
  const FclibFile some = fclib_from_hdf5(read("some.hdf5"), "some.hdf5");
  CHECK_FALSE(some.solution);
  REQUIRE(some.guesses.size() == 1);
  const CsvTable checks = csv("c.csv.partial");
  REQUIRE(checks.rows.size() > 5);
  CHECK(friction_state(reduce(problem), some.guesses[0].r).residual ==
        doctest::Approx(checks.number(checks.rows.size() - 1, "residual")).epsilon(1e-6));
}

TEST_CASE_FIXTURE(Session, "a global problem goes through sweep, optimum and inspect like any case") {
  file("p.hdf5", raw_global(box()).bytes());
  file("local.hdf5", raw_local(reduce(box())).bytes());
  file("case.toml", "[problem]\nfile = \"p.hdf5\"\n[partition]\nmetis = 3\n");
  const CsvTable rows = table("sweep p.hdf5 --subdomains metis:3 --epsilon 0.1,1");
  REQUIRE(rows.rows.size() == 2);
  CHECK(rows.text(0, "grains") == "12");
  CHECK(rows.text(0, "contacts") == "20");
  CHECK(rows.text(0, "active_contacts") == "20");
  CHECK(rows.number(0, "interface_dofs") > 0);
  CHECK(rows.number(0, "spectral_radius") > rows.number(1, "spectral_radius"));
  CHECK(rows.number(0, "spectral_radius") < 1);
  const CsvTable same = table("sweep case.toml --epsilon 0.1,1");
  CHECK(same.text(0, "spectral_radius") == rows.text(0, "spectral_radius"));
  CHECK(answer("optimum p.hdf5 --subdomains metis:3 --contacts all --epsilon 0.1").find("best_eta") !=
        std::string::npos);
  const std::string report = answer("inspect p.hdf5 --subdomains metis:3");
  CHECK(value(report, "contacts") == "20");
  CHECK(!contains(report, "solid fraction"));

  check_refused("sweep p.hdf5 --subdomains 2x1 --epsilon 1 --csv -", {"p.hdf5", "expected subdomains metis:N"});
  check_refused("sweep local.hdf5 --subdomains metis:2 --epsilon 1 --csv -", {"local.hdf5: expected a global problem"});
  check_refused("sweep p.hdf5 --subdomains metis:3 --epsilon 1 --contacts active --csv -",
                {"expected --contacts all or frozen for a problem with friction"});
  check_refused("sweep p.hdf5 --subdomains metis:3 --epsilon 1 --density 2 --csv -",
                {"masses.density: this case is a contact problem"});
  CHECK(table("network p.hdf5 --subdomains metis:3").text(0, "subdomain") == "0");
  check_refused("inspect p.hdf5 --histogram h.csv", {"sizes of grains: expected a packing"});
  check_refused("generate p.hdf5 -o g.csv", {"p.hdf5: expected a packing"});
}

TEST_CASE_FIXTURE(Session, "solve: a tolerance that says nothing is refused") {
  file("local.hdf5", raw_local(reduce(box()), Storage::triplets).bytes());
  for (const std::string& tolerance : Texts{"inf", "nan", "-1", "1.5"}) {
    CAPTURE(tolerance);
    check_refused("solve local.hdf5 --tolerance " + tolerance, {"--tolerance: expected"});
  }
}

TEST_CASE("solve: ends at the tolerance that was asked for, and says what to doubt beside it") {
  // After k sweeps r = (2 k - 1, 2 k) N s and the natural map is 2 N s.
  const Session session;
  session.file("squeezed.hdf5", raw_local(squeezed_grain(), Storage::triplets).bytes());
  const Outcome loose =
      session.ended(0, "solve squeezed.hdf5 --solver nlgs --check-every 1 --tolerance 3e-3 --convergence c.csv",
                    {"impulses grow without bound"});
  CHECK(value(loose.standard_output, "status") == "converged");
  CHECK(value(loose.standard_output, "sweeps") == "236");  // 2 / |(471, 472)| is the first below 3e-3
  const CsvTable checks = session.csv("c.csv");
  const std::size_t last = checks.rows.size() - 1;
  CHECK(checks.number(last, "residual") <= 3e-3);
  CHECK(checks.number(last - 1, "residual") > 3e-3);
  CHECK(checks.number(last, "driven_residual") == doctest::Approx(std::sqrt(2)));
  const Outcome tight = session.ended(1, "solve squeezed.hdf5");
  CHECK(value(tight.standard_output, "status") != "converged");
  session.file("p.hdf5", raw_global(box()).bytes());
  const Outcome sound = session.run("solve p.hdf5");
  CHECK(!contains(sound.standard_error, "Where no solution exists"));
  session.answer("solve squeezed.hdf5 --solver nlgs --tolerance 3e-3 --csv t.csv");
  CHECK(session.csv("t.csv").number(0, "driven_residual") == doctest::Approx(std::sqrt(2)));
}
