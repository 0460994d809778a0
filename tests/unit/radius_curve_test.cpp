// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds of the radius between two points of a curve: Moebius functions, slopes, chords and tangents.
#include "spectra/radius_curve.hpp"

#include "../support/problems.hpp"
#include "ddm/enriched_inertia.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "study/linear/values.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Vector random_vector(Index n, RandomStream& random) {
  Vector x(n);
  for (double& entry : x) entry = random.uniform() - 0.5;
  return x;
}

// A single mode of stiffness kappa in S, P = X_infinity: lambda = epsilon / (epsilon + kappa), both ends alike.
CurvePoint single_mode(double epsilon, double kappa) {
  const double lambda = epsilon / (epsilon + kappa), slope = epsilon * kappa / ((epsilon + kappa) * (epsilon + kappa));
  const CurveEnd end{.lambda = lambda, .error = 0, .slope = slope, .slope_error = 0};
  return {.x = epsilon, .radius = 1 - lambda, .ends = std::array{end, end}};
}

}  // namespace

TEST_CASE("moebius: stationary places and crossings are where the functions say") {
  const Moebius m{2, 1, 1, 3}, n{-1, 4, 0.5, 1};
  const double slope = 0.3;
  const std::vector<double> places = stationary_places(m, slope);
  CHECK(places.size() == 2);
  for (const double x : places) {
    const double h = 1e-5, value = (m(x * (1 + h)) - m(x * (1 - h))) / (std::log1p(h) - std::log1p(-h));
    CHECK(value == doctest::Approx(slope).epsilon(1e-8));
  }
  const std::vector<double> meetings = crossings(m, n);
  REQUIRE(!meetings.empty());
  for (const double x : meetings) CHECK(m(x) == doctest::Approx(n(x)).epsilon(1e-12));
  CHECK(one_minus(0.7, m)(2) == doctest::Approx(1 - 0.7 * m(2)).epsilon(1e-15));
  CHECK(over_minus_one(0.7, m)(2) == doctest::Approx(0.7 / m(2) - 1).epsilon(1e-15));
  CHECK(stationary_places(m, 0).empty());
}

TEST_CASE("interface operator: its slope is the derivative over log eta") {
  RandomStream random(3);
  for (const Case& one : {strip(8), random_lattice(2, 8, 6, {3, 2})}) {
    const Decomposition parts = build(one).parts;
    for (const Index limit : {Index{0}, InterfaceFamily::default_dense_limit}) {  // factorised and diagonalised
      const InterfaceFamily family(parts, limit);
      const Vector f = random_vector(parts.interface_size(), random);
      for (const double eta : {1e-3, 0.1, 1.0, 50.0}) {
        const double h = 1e-3;
        const auto form = [&](double step) { return f.dot(family.at(eta * std::exp(step)).apply(f)); };
        const double difference = (8 * (form(h) - form(-h)) - (form(2 * h) - form(-2 * h))) / (12 * h);
        CHECK(std::abs(family.at(eta).slope(f) - difference) < 1e-9 * f.squaredNorm());
      }
      CHECK(family.at(infinity).slope(f) == 0);
      CHECK(family.at(0).slope(f) == 0);
    }
  }
}

TEST_CASE("curve: the slopes of both ends are those of finite differences") {
  const Model model = build(strip(8));
  const InterfaceFamily family(model.parts);
  const SpectralOptions options{.certify = true};
  for (const CurveAxis axis : {CurveAxis::epsilon, CurveAxis::eta})
    for (const double epsilon : {0.05, 3.0}) {
      const double eta = 0.4;
      const auto at_step = [&](double h) {
        const Contraction b{family.at(axis == CurveAxis::eta ? eta * std::exp(h) : eta),
                            family.at(axis == CurveAxis::epsilon ? epsilon * std::exp(h) : epsilon)};
        return curve_point(b, spectral_radius(b, options), axis);
      };
      const double h = 1e-4;
      const CurvePoint before = at_step(-h), point = at_step(0), after = at_step(h);
      for (const std::size_t side : {0u, 1u}) {
        const double difference = ((*after.ends)[side].lambda - (*before.ends)[side].lambda) / (2 * h);
        CHECK(std::abs((*point.ends)[side].slope - difference) < 1e-7);
        CHECK((*point.ends)[side].error < 1e-13);
        CHECK((*point.ends)[side].error > 0);
      }
    }
}

// Modes that are off by much more than those of a solver: the quotients whose tangents bound the curve are then told
// apart from the slope that is worked out, and its error must cover the difference. The quotients of a vector f are
//     low end:   f^T S f / f^T P f along epsilon,  f^T S P^-1 S f / f^T S f along eta
//     high end:  f^T P f / f^T S f, of 1 / lambda
TEST_CASE("curve: the error of a slope covers what an inexact mode is off, on each side and axis") {
  double most_in_first_order = 0;  // what is lost without the terms 2 r + r^2 / lambda, over what is left
  for (const Case& one : {strip(8), random_lattice(2, 8, 6, {3, 2})}) {
    const Decomposition parts = build(one).parts;
    const InterfaceFamily family(parts);
    RandomStream random(5);
    for (const CurveAxis axis : {CurveAxis::epsilon, CurveAxis::eta})
      for (const double epsilon : {0.05, 1.0})
        for (const double off : {1e-5, 1e-4, 1e-3}) {
          INFO("along eta: ", axis == CurveAxis::eta, ", epsilon = ", epsilon, ", off = ", off);
          const double eta = 0.4;
          const Contraction b{family.at(eta), family.at(epsilon)};
          SpectralRadius plain = spectral_radius(b, {.certify = true});
          for (Vector* mode : {&plain.mode_max, &plain.mode_min})
            *mode = *mode / mode->norm() + off * random_vector(b.rows(), random).normalized();
          const CurvePoint point = curve_point(b, plain, axis);
          const auto derivative = [&](auto&& quotient) {  // over the logarithm of the flexibility of the axis
            const auto at_step = [&](double h) {
              const double factor = std::exp(h);
              return quotient(axis == CurveAxis::epsilon ? family.at(epsilon * factor) : b.system,
                              axis == CurveAxis::eta ? family.at(eta * factor) : b.preconditioner);
            };
            const double h = 1e-3;
            return (8 * (at_step(h) - at_step(-h)) - (at_step(2 * h) - at_step(-2 * h))) / (12 * h);
          };
          using X = InterfaceOperator;
          const Vector &f = plain.mode_max, &g = plain.mode_min;
          const double of_low = derivative([&](const X& s, const X& p) {
            const Vector sf = s.apply(f);
            return axis == CurveAxis::epsilon ? f.dot(sf) / f.dot(p.apply(f)) : sf.dot(p.solve(sf)) / f.dot(sf);
          });
          const double of_high =
              derivative([&](const X& s, const X& p) { return g.dot(p.apply(g)) / g.dot(s.apply(g)); });
          const CurveEnd &low = (*point.ends)[0], &high = (*point.ends)[1];
          const double rounding = 1e-10;  // of the differences
          CHECK(std::abs(low.slope - of_low) <= low.slope_error + rounding);
          CHECK(std::abs(-high.slope / (high.lambda * high.lambda) - of_high) <=
                high.slope_error / (high.lambda * high.lambda) + rounding);
          const double second_order = off * off * 10 + 10 * low.error + rounding;
          most_in_first_order = std::max(most_in_first_order, std::abs(low.slope - of_low) / second_order);
        }
  }
  CHECK(most_in_first_order > 10);  // the error is of first order along eta: a bound of second order does not do
}

TEST_CASE("curve: no eigenvalue of M_E^-1 K_E is above the bound") {
  for (const Case& one : every_problem())
    for (const Subdomain& subdomain : build(one).parts.subdomains) {
      if (subdomain.h.cols() == 0) continue;
      const Matrix a = subdomain.inertia.cwiseSqrt().cwiseInverse().asDiagonal() * Matrix(subdomain.h);
      const double largest = symmetric_eigen(a * a.transpose(), Eigenvectors::not_wanted).values.maxCoeff();
      Decomposition alone;
      alone.subdomains = {subdomain};
      CHECK(largest <= stiffest(alone) * (1 + 1e-14));
    }
}

TEST_CASE("curve: the energy of a residual is between its bounds, and the upper one is not far above it") {
  double nearest = infinity;
  on_every_interface([&](const Model& model) {
    const InterfaceFamily family(model.parts);
    for (const double eta : {infinity, 10.0, 0.1, 1e-3}) {
      CAPTURE(eta);
      const InterfaceOperator x = family.at(eta);
      const Vector g = Vector::LinSpaced(model.parts.interface_size(), -1, 2);
      const double exact = g.dot(x.solve(g)), bound = inverse_at_most(x, g);
      CHECK(exact <= bound * (1 + 1e-12));
      CHECK(exact >= g.dot(x.solve_generic(g)) * (1 - 1e-12));
      if (std::isfinite(eta)) nearest = std::min(nearest, bound / exact);
    }
  });
  CHECK(nearest < 2);  // a bound that is never near proves little
}

TEST_CASE("curve: the bounds of a single mode hold, and its deviations are not larger than they must be") {
  const double kappa = 2;
  for (const double loose : {1.0, 3.0}) {
    const CurveLaw law{.axis = CurveAxis::epsilon, .stiffest = loose * kappa};
    for (const auto& [from, to] : {std::pair{0.1, 0.3}, {1.0, 8.0}, {1e-4, 1e-2}}) {
      const CurvePoint first = single_mode(from, kappa), last = single_mode(to, kappa);
      const Deviation band = deviation(law, first, last);
      double below = 0, above = 0, high_above = 0, low_below = 0;
      for (int k = 0; k <= 10000; ++k) {
        const double t = k / 10000.0, x = from * std::pow(to / from, t), radius = kappa / (x + kappa);
        const double line = first.radius + t * (last.radius - first.radius);
        const auto [low, high] = radius_bounds(law, first, last, x);
        CHECK(low <= radius + 1e-14);
        CHECK(high >= radius - 1e-14);
        below = std::max(below, line - radius);
        above = std::max(above, radius - line);
        low_below = std::max(low_below, line - low);
        high_above = std::max(high_above, high - line);
      }
      CHECK(band.below >= below - 1e-14);
      CHECK(band.above >= above - 1e-14);
      // The deviations are those of the bounds, to what 10 000 samples of them see: next to nothing of a smooth bound,
      // and of the kink where two tangents meet a ten-thousandth of its slope.
      CHECK(band.below >= low_below);
      CHECK(band.below - low_below < 1e-4);
      CHECK(band.above >= high_above);
      CHECK(band.above - high_above < 1e-7);
      // With the bound met, the chord over epsilon / (epsilon + L) is the mode itself.
      if (loose == 1.0) CHECK(band.above - above < 1e-7);
    }
  }
}

TEST_CASE("curve: an uncertain end widens both bounds by its error; what is not known never makes the band narrower") {
  const CurveLaw law{.axis = CurveAxis::epsilon, .stiffest = 2};
  CurvePoint first = single_mode(1, 2), last = single_mode(1.2, 2);
  const Deviation sharp = deviation(law, first, last);
  const auto with = [&](double CurveEnd::*number, double value) {
    for (CurvePoint* point : {&first, &last})
      for (CurveEnd& end : *point->ends) end.*number = value;
    return deviation(law, first, last);
  };
  const Deviation wide = with(&CurveEnd::error, 1e-3);
  CHECK(std::abs(wide.below - sharp.below - 1e-3) < 5e-5);
  CHECK(std::abs(wide.above - sharp.above - 1e-3) < 5e-5);
  with(&CurveEnd::error, 0);
  const Deviation without_slopes = with(&CurveEnd::slope, not_a_number);
  CHECK(without_slopes.above == sharp.above);
  CHECK(without_slopes.below == doctest::Approx(first.radius).epsilon(1e-12));  // no bound but 0
  (*last.ends)[1].lambda = not_a_number;
  CHECK(deviation(law, first, last).above == infinity);
  // Coordinates that are equal in double precision: both ends of the chord are then its lower one.
  const CurveLaw soft{.axis = CurveAxis::epsilon, .stiffest = 1e-20};
  const Deviation constant = deviation(soft, single_mode(1, 0), single_mode(2, 0));
  CHECK(constant.above < 1e-13);
  CHECK(constant.below < 1e-13);
}

TEST_CASE("values: a range without a count") {
  const auto range = parse_range("1e-3:2", "epsilon");
  REQUIRE(range);
  CHECK(range->first == std::vector{1e-3, 2.0});
  CHECK(!range->second);
  CHECK(parse_range("0.1:10 W", "eta")->second);
  for (const std::string text : {"1", "1:2:3", "1,2", "1:2,3", "inf", "0.1W"}) CHECK(!parse_range(text, "eta"));
  for (const std::string text : {"0:1", "2:1", "1:1", "1:inf", "-1:1", "nan:1", "1:x", ":1", "1:"})
    CHECK_THROWS_WITH_AS(parse_range(text, "eta"), doctest::Contains("eta"), Error);
}
