// SPDX-License-Identifier: GPL-3.0-or-later
// Certified curves: the band holds hundreds of samples that are computed one by one.
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "../support/thorough.hpp"
#include "study/linear/curve.hpp"
#include "study/linear/values.hpp"

#include <doctest/doctest.h>
using namespace nscdd;
using namespace nscdd::testing;

namespace {

struct Traced {
  std::vector<CurveResult> rows;
  std::vector<CurveReport> reports;
};

Traced traced(const Model& model, const CurveParameters& parameters) {
  Traced result;
  result.reports = trace_curves(model, parameters, [&](const CurveResult& row) { result.rows.push_back(row); });
  return result;
}

CurveParameters along_epsilon(double from, double to, double eta) {
  CurveParameters curve;
  curve.sweep.epsilon = {from, to};
  curve.sweep.eta = {eta};
  curve.tolerance = 5e-3;
  return curve;
}

CurveParameters along_eta(double from, double to, double epsilon) {
  CurveParameters curve = along_epsilon(from, to, epsilon);
  std::swap(curve.sweep.epsilon, curve.sweep.eta);
  curve.axis = CurveAxis::eta;
  return curve;
}

double place(const CurveParameters& curve, const SweepPoint& point) {
  return curve.axis == CurveAxis::epsilon ? point.epsilon : point.eta;
}

// The sweep of many points over the range of a curve.
std::vector<SweepResult> samples(const Model& model, const CurveParameters& curve,
                                 Index number = thorough() ? 1000 : 250) {
  SweepParameters dense = curve.sweep;
  dense.spectral = {.tolerance = 1e-6};
  std::vector<double>& list = curve.axis == CurveAxis::epsilon ? dense.epsilon : dense.eta;
  list = parse_values(to_text(list.front()) + ":" + to_text(list.back()) + ":" + std::to_string(number), "range");
  std::vector<SweepResult> all;
  sweep(model, dense, [&](const SweepResult& result) { all.push_back(result); });
  return all;
}

// Every sample lies between the straight lines over log from row to row. `slack`: error of the samples.
void check_held(const CurveParameters& curve, const std::vector<CurveResult>& rows,
                const std::vector<SweepResult>& dense, double slack) {
  Index outside = 0;
  for (const SweepResult& sample : dense) {
    const double x = place(curve, sample.point);
    std::size_t k = 1;
    while (k + 1 < rows.size() && place(curve, rows[k].found.point) < x) ++k;
    const CurveResult &from = rows[k - 1], &to = rows[k];
    const double start = place(curve, from.found.point);
    const double t = std::log(x / start) / std::log(place(curve, to.found.point) / start);
    const double radius = sample.radius.subdominant, error = slack * std::max(1.0, radius);
    outside +=
        !(radius >= std::lerp(from.low, to.low, t) - error && radius <= std::lerp(from.high, to.high, t) + error);
  }
  CHECK(outside == 0);
}

// One curve: its points, its width, its samples. Returns how many points it has.
Index check_curve(const Model& model, const CurveParameters& curve, double slack = 1e-12) {
  const Traced found = traced(model, curve);
  REQUIRE(found.reports.size() == 1);
  CHECK((found.reports[0].status == CurveStatus::proved && found.reports[0].points == count(found.rows)));
  REQUIRE(found.rows.size() >= 2);
  const std::vector<double>& range = curve.axis == CurveAxis::epsilon ? curve.sweep.epsilon : curve.sweep.eta;
  CHECK(place(curve, found.rows.front().found.point) == range.front());
  CHECK(place(curve, found.rows.back().found.point) == range.back());
  for (std::size_t k = 0; k < found.rows.size(); ++k) {
    const CurveResult& row = found.rows[k];
    const double radius = row.found.radius.subdominant;
    CHECK((row.found.radius.converged && row.low <= radius && row.high >= radius));
    CHECK(row.high - row.low <= curve.tolerance * std::max(1.0, radius) * (1 + 1e-12));
    if (k > 0) CHECK(place(curve, found.rows[k - 1].found.point) < place(curve, row.found.point));
  }
  check_held(curve, found.rows, samples(model, curve), slack);
  return count(found.rows);
}

}  // namespace

TEST_CASE("curves: the band holds all samples on every problem, along epsilon and along eta") {
  int curves = 0;
  on_every_interface([&](const Model& model) {
    check_curve(model, along_epsilon(1e-4, 1e4, infinity));
    check_curve(model, along_epsilon(1e-4, 1e4, 0.3));
    check_curve(model, along_eta(1e-4, 1e4, 1));
    check_curve(model, along_eta(1e-3, 1e4, 0));
    CurveParameters schwarz = along_epsilon(1e-4, 1e4, infinity);
    schwarz.sweep.scheme = DecompositionScheme::schwarz;
    check_curve(model, schwarz, 1e-10);
    ++curves;
  });
  CHECK(curves >= 7);
}

TEST_CASE("curves: with a choice of contacts and with a relaxation") {
  for (const Index grains : {4, 8, 12}) {
    const Model model = build(strip(grains));
    for (const ContactSet contacts : {ContactSet::active, ContactSet::unilateral})
      for (CurveParameters curve : {along_eta(1e-4, 1e3, 0), along_epsilon(1e-3, 1e3, infinity)}) {
        curve.sweep.contacts = contacts;
        check_curve(model, curve);
        curve.sweep.relaxation = {1.7};
        check_curve(model, curve);
      }
  }
  CurveParameters relative = along_epsilon(1e-2, 1e2, 1);
  relative.sweep.relative_epsilon = true;
  const Traced found = traced(build(strip(8)), relative);
  CHECK(found.rows.front().found.asked.epsilon == 1e-2);
  CHECK(found.rows.back().found.point.epsilon == doctest::Approx(100 * found.rows.back().found.scale).epsilon(1e-15));
}

TEST_CASE("curves: unequal masses, and a tolerance of 1e-5") {
  const Model model = build(with_unequal_masses(random_lattice(2, 8, 6, {3, 2}), 5));
  check_curve(model, along_epsilon(1e-3, 1e5, infinity), 1e-10);
  check_curve(model, along_eta(1e-2, 1e5, 0.5), 1e-10);
  CurveParameters fine = along_epsilon(1e-2, 1e2, infinity);
  fine.tolerance = 1e-5;
  CHECK(check_curve(build(strip(8)), fine) < 600);
}

TEST_CASE("curves: shift-invert, whose points start from both neighbours") {
  const Model model = build(random_lattice(2, 8, 6, {3, 2}));
  for (CurveParameters curve : {along_epsilon(1e-3, 1e3, infinity), along_eta(1e-2, 1e3, 1), along_eta(1e-2, 1e3, 0)}) {
    curve.sweep.spectral.solver = SpectralSolver::shift_invert;
    const Index points = check_curve(model, curve, 1e-11);
    const Index factorisations = traced(model, curve).reports[0].factorisations;
    CHECK(factorisations > points);
    CHECK(factorisations < 8 * points);
  }
}

TEST_CASE("curves: one for every value of the other flexibility and every relaxation") {
  CurveParameters curve = along_epsilon(1e-2, 1e2, 0.3);
  curve.sweep.eta = {0.3, infinity};
  curve.sweep.relaxation = {1.0, 0.5};
  const Model model = build(strip(8));
  const Traced found = traced(model, curve);
  REQUIRE(found.reports.size() == 4);
  std::size_t row = 0;
  for (std::size_t k = 0; k < 4; ++k)
    for (Index i = 0; i < found.reports[k].points; ++i, ++row) {
      CHECK(found.rows[row].found.point.eta == curve.sweep.eta[k / 2]);
      CHECK(found.rows[row].found.point.relaxation == curve.sweep.relaxation[k % 2]);
    }
  CHECK(row == found.rows.size());
}

TEST_CASE("curves: too few points give a band that is wide but holds") {
  CurveParameters curve = along_epsilon(1e-3, 1e3, infinity);
  curve.most_points = 5;
  const Model model = build(strip(12));
  const Traced found = traced(model, curve);
  CHECK(found.reports[0].status == CurveStatus::wide);
  CHECK(found.rows.size() == 5);
  check_held(curve, found.rows, samples(model, curve), 1e-12);
}

TEST_CASE("curves: where spectra have lost their digits the band is as wide as what is lost") {
  const Model model = build(strip(8));
  const CurveParameters curve = along_epsilon(1e-13, 1e2, infinity);
  const Traced found = traced(model, curve);
  CHECK(found.reports[0].status == CurveStatus::wide);
  CHECK(found.rows.size() < 60);
  CHECK(found.rows.front().high - found.rows.front().low > curve.tolerance);
  CHECK(found.rows.back().high - found.rows.back().low <= curve.tolerance);
  check_held(curve, found.rows, samples(model, curve), 1e-12);
}

TEST_CASE("curves: points that do not converge prove nothing, and a monitor stops a curve") {
  const Model model = build(strip(8));
  CurveParameters curve = along_epsilon(1e-3, 1e3, infinity);
  curve.sweep.spectral.tolerance = 1e-300;
  const Traced found = traced(model, curve);
  CHECK(found.reports[0].status == CurveStatus::not_converged);
  REQUIRE(!found.rows.empty());
  for (const CurveResult& row : found.rows) CHECK(std::isnan(row.low + row.high));
  Index rows = 0;
  const auto reports = trace_curves(
      model, along_epsilon(1e-3, 1e3, infinity), [&](const CurveResult&) { ++rows; },
      [](Index done, Index total) { return done >= total || done < 5; });
  CHECK(reports.back().status == CurveStatus::stopped);
  CHECK(rows == 0);
}

TEST_CASE("curves: an empty interface has radius 0 all along") {
  Case one = strip(6);
  one.spec.partition = GridPartitioner{{1, 1}};
  const Traced found = traced(build(one), along_epsilon(1, 2, infinity));
  REQUIRE(found.rows.size() == 2);
  for (const CurveResult& row : found.rows) CHECK(row.high - row.low == 0);
}
