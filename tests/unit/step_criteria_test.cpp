// SPDX-License-Identifier: GPL-3.0-or-later
// Criteria of LMGC90 and of the program of [ADI12], written down contact by contact as there.
#include "../support/granular.hpp"
#include "two_stage/granular_two_stage.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double friction_of_judged_steps = 0.3;

Dynamics unfinished(const std::string& algorithm, Index iterations) {
  Dynamics dynamics = tight();
  dynamics.solver.algorithm = algorithm;
  dynamics.interaction.friction = friction_of_judged_steps;
  dynamics.solver.criterion = "none";
  dynamics.solver.maximum_iterations = iterations;
  dynamics.solver.warm_start = false;
  return dynamics;
}

// What check_convergence_nlgs of LMGC90 judges, times its tolerance.
struct IndicatorsOfLmgc90 {
  double mean_dv_over_r = 0, quad_dv = 0, quad_dvr = 0, maxm_dv = 0, maxm_dvr = 0;
};

// As in mod_nlgs.f90, with its names.
IndicatorsOfLmgc90 indicators_of_lmgc90(const GranularStep<2>& step) {
  double sum_dvdv = 0, max_dvdv = 0, sum_dvdvrr = 0, max_dvdvrr = 0, sum_dvor = 0, sum_wrr = 0, sum_wrwr = 0;
  double active = 0;
  for (const GrainContact<2>& c : step.contacts) {
    const GrainVelocity<2>&a = step.velocities[at(c.a)], &b = step.velocities[at(c.b)];
    const double nx = c.normal[0], ny = c.normal[1], wnn = a.inverse_mass + b.inverse_mass, wtt = 3 * wnn;
    const double rn = c.impulse.n, rt = c.impulse.t;
    const double vn = nx * (b.x - a.x) + ny * (b.y - a.y) + c.bias.n;
    const double vt = nx * (b.y - a.y) - ny * (b.x - a.x) - a.rim - b.rim + c.bias.t;
    const double free_n = vn - wnn * rn, free_t = vt - wtt * rt;
    const double next_n = std::max(0.0, -free_n / wnn);
    const double most_t = friction_of_judged_steps * next_n;
    const double next_t = std::clamp(-free_t / wtt, -most_t, most_t);
    const double dvn = wnn * (rn - next_n), dvt = wtt * (rt - next_t);
    const double mean_n = (rn + next_n) / 2, mean_t = (rt + next_t) / 2;
    const double dvdv = dvn * dvn + dvt * dvt, rr = mean_n * mean_n + mean_t * mean_t;
    sum_dvdv += dvdv;
    max_dvdv = std::max(max_dvdv, dvdv);
    sum_dvdvrr += dvdv * rr;
    max_dvdvrr = std::max(max_dvdvrr, dvdv * rr);
    sum_dvor += mean_n * dvn + mean_t * dvt;
    sum_wrr += (wnn * rn * rn + wtt * rt * rt + wnn * next_n * next_n + wtt * next_t * next_t) / 2;
    sum_wrwr += (wnn * wnn * (rn * rn + next_n * next_n) + wtt * wtt * (rt * rt + next_t * next_t)) / 2;
    active += rr != 0 ? 1 : 0;
  }
  const double quad_wr = std::sqrt(sum_wrwr / active), mean_wrr = sum_wrr / active;
  return {.mean_dv_over_r = sum_dvor / sum_wrr,
          .quad_dv = std::sqrt(sum_dvdv / active) / quad_wr,
          .quad_dvr = std::sqrt(sum_dvdvrr / active) / mean_wrr,
          .maxm_dv = std::sqrt(max_dvdv) / quad_wr,
          .maxm_dvr = std::sqrt(max_dvdvrr) / mean_wrr};
}

}  // namespace

TEST_CASE("LMGC90's indicators are those of its sources, after few sweeps and many") {
  for (const Index sweeps : {Index{1}, Index{3}, Index{20}, Index{200}}) {
    CAPTURE(sweeps);
    const GranularStep<2> step = solve_step(shaken_lattice(7, 6, unfinished("nlgs", sweeps)));
    const IndicatorsOfLmgc90 expected = indicators_of_lmgc90(step);
    const ContactResidual& met = step.report.residual;
    CHECK(met.quad_dv() == doctest::Approx(expected.quad_dv).epsilon(1e-9));
    CHECK(met.quad_dvr() == doctest::Approx(expected.quad_dvr).epsilon(1e-9));
    CHECK(met.mean_dv_over_r() == doctest::Approx(-expected.mean_dv_over_r).epsilon(1e-6));
    const double largest = std::max({std::abs(expected.mean_dv_over_r), expected.quad_dv, expected.quad_dvr,
                                     expected.maxm_dv / 16.666, expected.maxm_dvr / 16.666});
    CHECK(met.qm_16() == doctest::Approx(largest).epsilon(1e-9));
  }
}

TEST_CASE("QM/16: one contact among thousands counts by itself, and no number stays none") {
  ContactResidual one{.violation = 1e-8, .scale_work = 1, .scale_velocity = 1, .squared_work = 1e-10, .loaded = 90'000};
  CHECK(one.quad_dv() == doctest::Approx(1e-4));
  CHECK(one.quad_dvr() == doctest::Approx(3e-3));
  CHECK(one.qm_16() == doctest::Approx(3e-3));
  one.largest_squared_work = 1e-10;
  CHECK(one.qm_16() == doctest::Approx(0.9 / 16.666));
  one.squared_work = one.largest_squared_work = 0;
  CHECK(one.qm_16() == doctest::Approx(1e-4));
  one.largest_violation = 1e-8;
  CHECK(one.qm_16() == doctest::Approx(3e-2 / 16.666));
  one.work = -0.5;
  CHECK(one.qm_16() == doctest::Approx(0.5));
  one.violation = not_a_number;
  CHECK(std::isnan(one.qm_16()));
  CHECK(ContactResidual{}.qm_16() == 0);
}

TEST_CASE("normal_change is sum |r_n - r_n'| / sum |r_n| of two iterations, with any number of subdomains and sweeps") {
  for (const std::string algorithm : {"nlgs", "generic", "enriched"})
    for (const Index sweeps : {Index{1}, Index{4}})
      for (const Index iteration : {Index{1}, Index{2}, Index{9}}) {
        INFO("algorithm = ", algorithm, ", sweeps = ", sweeps, ", iteration = ", iteration);
        std::vector<IterationRow> rows;
        const auto solved = [&](Index iterations) {
          Dynamics dynamics = unfinished(algorithm, iterations);
          dynamics.solver.gauss_seidel_sweeps = sweeps;
          const std::array<Index, 2> grid =
              algorithm == "nlgs" ? std::array<Index, 2>{1, 1} : std::array<Index, 2>{3, 2};
          return solve_step(shaken_lattice(7, 6, dynamics, grid),
                            {.row = [&](const IterationRow& row) { rows.push_back(row); }, .every = iterations});
        };
        std::vector<GrainContact<2>> before;
        if (iteration > 1) before = solved(iteration - 1).contacts;
        const GranularStep<2> step = solved(iteration);
        double change = 0, sum = 0;
        for (std::size_t k = 0; k < step.contacts.size(); ++k) {
          const double n = step.contacts[k].impulse.n;
          change += std::abs(n - (before.empty() ? 0.0 : before[k].impulse.n));
          sum += std::abs(n);
        }
        REQUIRE(sum > 0);
        CHECK(rows.back().record.normal_change == doctest::Approx(change / sum).epsilon(1e-12));
        CHECK(step.report.last.normal_change == rows.back().record.normal_change);
      }
}

TEST_CASE("criterion normal_change ends a step where it falls to the tolerance, and others do not measure it") {
  Dynamics dynamics = unfinished("generic", 20'000);
  dynamics.solver.criterion = "normal_change";
  dynamics.solver.tolerance = 1e-3;
  dynamics.solver.gluing_tolerance = 1;
  std::vector<double> values;
  const IterationSink all{.row = [&](const IterationRow& row) { values.push_back(row.record.normal_change); }};
  const GranularStep<2> step = solve_step(shaken_lattice(7, 6, dynamics, {3, 2}), all);
  CHECK(step.report.status == SolverStatus::converged);
  REQUIRE(values.size() > 3);
  for (std::size_t k = 0; k < values.size(); ++k) CHECK((values[k] <= 1e-3) == (k + 1 == values.size()));
  const GranularStep<2> silent = solve_step(shaken_lattice(7, 6, dynamics, {3, 2}));
  CHECK(silent.report.last.iteration == step.report.last.iteration);
  CHECK(silent.report.last.normal_change == step.report.last.normal_change);
  dynamics.solver.criterion = "zeta";
  CHECK(std::isnan(solve_step(shaken_lattice(7, 6, dynamics, {3, 2})).report.last.normal_change));
}

TEST_CASE("the last row of a step has normal_change, though it is not one of those asked for") {
  std::vector<IterationRow> rows;
  const IterationSink few{.row = [&](const IterationRow& row) { rows.push_back(row); }, .every = 1000};
  solve_step(shaken_lattice(7, 6, unfinished("generic", 7), {3, 2}), few);
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].record.normal_change > 0);
}

TEST_CASE("QM/16 of a step does not know into how many subdomains its contacts are cut") {
  const GranularStep<2> whole = solve_step(shaken_lattice(7, 6, unfinished("nlgs", 3)));
  std::vector<ContactResidual> parts;
  for (std::size_t start = 0; start < 3; ++start) {
    std::vector<GrainContact<2>> own;
    for (std::size_t k = start; k < whole.contacts.size(); k += 3) own.push_back(whole.contacts[k]);
    parts.push_back(contact_residual(whole.problem.law, own, whole.velocities));
  }
  ContactResidual sum = added_up(parts, {});
  sum.scale = whole.report.residual.scale;
  CHECK(sum.qm_16() == doctest::Approx(whole.report.residual.qm_16()).epsilon(1e-12));
  CHECK(sum.largest_violation == whole.report.residual.largest_violation);
  CHECK(sum.largest_squared_work == whole.report.residual.largest_squared_work);
  CHECK(sum.loaded == whole.report.residual.loaded);
}

TEST_CASE("normal_change: impulses that are rounding are measured against the momenta of the bodies") {
  Dynamics dynamics = unfinished("nlgs", 100);
  dynamics.solver.criterion = "normal_change";
  dynamics.solver.tolerance = 1e-3;
  // Both go on at 1/2 m/s after the impact of the first step; the first sweep finds what is rounding.
  Simulation pair = simulation_of({{.y = 0.5, .velocity_x = 1}, {.x = 1.001, .y = 0.5}}, dynamics);
  for (int step = 1; step <= 6; ++step) {
    const GranularStep<2> solved = solve_step(pair);
    CHECK(solved.report.status == SolverStatus::converged);
    if (step > 1) CHECK(solved.report.last.iteration == 1);
    if (step > 1 && solved.report.last.impulses > 0) CHECK(solved.report.last.normal_change <= 1e-3);
    take_step(pair, solved);
  }
}
