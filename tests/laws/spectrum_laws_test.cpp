// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of the contraction operator, stated once and run on every problem.
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "mechanics/active_set.hpp"
#include "study/linear/inspection.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

double smallest_eigenvalue(const Matrix& a) { return symmetric_eigenvalues(a).minCoeff(); }

InterfaceOperator active_system(const Model& model, double epsilon) {
  const std::vector<char> active = active_contacts(model.problem, rigid_impulses(model.problem));
  return InterfaceFamily(restrict_contacts(model.parts, active)).at(epsilon);
}

}  // namespace

TEST_CASE("the problems of these tests have cross points and hyperstatic parts") {
  Index points = 0, unit = 0;
  for (const Case& one : every_problem()) {
    const Model model = build(one);
    points += cross_points(model.parts);
    unit += inspect(model).unit_multiplicity;
  }
  CHECK(points >= 5);
  CHECK(unit >= 5);
}

TEST_CASE("signs: epsilon < eta gives [0, 1), epsilon > eta gives <= 0, epsilon = eta gives B = 0") {
  on_every_interface([](const Model& model) {
    const InterfaceFamily family(model.parts);
    for (const double eta : {0.05, 1.0, 20.0})
      for (const double epsilon : {0.01, 0.05, 1.0, 20.0, 300.0}) {
        const SpectralRadius radius = spectral_radius({family.at(eta), family.at(epsilon)});
        REQUIRE(radius.converged);
        if (epsilon < eta) {
          CHECK(radius.eigenvalue_min > -1e-12);
          CHECK(radius.eigenvalue_max < 1);
        } else if (epsilon > eta) {
          CHECK(radius.eigenvalue_max < 1e-12);
        } else {
          CHECK(radius.value == 0);
        }
        CHECK(radius.unit_multiplicity == 0);
      }
  });
}

TEST_CASE("order: X_eta grows with eta, from X_0 to X; fewer contacts make it larger") {
  on_every_interface([](const Model& model) {
    const InterfaceFamily family(model.parts);
    double previous = 0;
    for (const double eta : {1e-3, 1e-1, 1.0, 10.0, 1e3, infinity}) {
      const Matrix difference = family.at(eta).dense() - family.at(previous).dense();
      CHECK(smallest_eigenvalue(difference) > -1e-12);
      CHECK(difference.norm() > 0);
      previous = eta;
    }
    CHECK(smallest_eigenvalue(active_system(model, 0).dense() - family.at(0).dense()) > -1e-10);
  });
}

TEST_CASE("limits: eta to infinity is the generic algorithm, epsilon to 0 the rigid limit") {
  on_every_interface([](const Model& model) {
    const InterfaceFamily family(model.parts);
    const InterfaceOperator system = family.at(0.3);
    CHECK(spectral_radius({family.at(1e12), system}).value ==
          doctest::Approx(spectral_radius({family.at(infinity), system}).value).epsilon(1e-10));
    const SpectralRadius rigid = spectral_radius({family.at(infinity), family.at(0)});
    const SpectralRadius nearly = spectral_radius({family.at(infinity), family.at(1e-9)});
    CHECK(nearly.value == doctest::Approx(rigid.value).epsilon(1e-6));
    CHECK(nearly.eigenvalue_min == doctest::Approx(rigid.eigenvalue_min).epsilon(1e-6));
  });
}

TEST_CASE("the generic radius rises monotonically as epsilon falls") {
  on_every_interface([](const Model& model) {
    const InterfaceFamily family(model.parts);
    double previous = 0;
    for (double exponent = 4; exponent >= -4; exponent -= 0.5) {
      const double radius = spectral_radius({family.at(infinity), family.at(std::pow(10, exponent))}).value;
      CHECK(radius > previous);
      CHECK(radius < 1);
      previous = radius;
    }
  });
}

TEST_CASE("rigid limit: the multiplicity of 1 is that counted from ranks, for every eta") {
  on_every_interface([](const Model& model) {
    const InterfaceFamily family(model.parts);
    const Index expected = inspect(model).unit_multiplicity;
    for (const double eta : {0.01, 1.0, infinity}) {
      const SpectralRadius radius = spectral_radius({family.at(eta), family.at(0)});
      REQUIRE(radius.converged);
      CHECK(radius.unit_multiplicity == expected);
      CHECK(radius.subdominant < 1);
      if (expected > 0) CHECK(radius.eigenvalue_max == 1);
      if (expected == 0) CHECK(radius.subdominant == radius.value);
      // the spectrum of the scaled X_0 has as many zeros, and a gap above them
      const InterfaceOperator limit = family.at(0);
      const Dense root = diagonal(limit.scale().cwiseSqrt().cwiseInverse());
      const Dense scaled = root * limit.dense() * root;
      const Vector eigenvalues = symmetric_eigenvalues(scaled);
      CHECK((eigenvalues.array() < 1e-12).count() == expected);
      CHECK((eigenvalues.array() < 1e-6).count() == expected);
      CHECK((scaled * limit.kernel().kernel).norm() < 1e-10);
    }
  });
}

TEST_CASE("certificates of the dense solver count the eigenvalues in the interval of each end") {
  constexpr double rounding = 1e-11;  // of eigenvalues found by two solvers
  Index unlike = 0;
  on_every_interface([&](const Model& model) {
    const InterfaceFamily family(model.parts);
    const Contraction b{family.at(infinity), family.at(0.1)};
    const SpectralRadius found = spectral_radius(b, {.solver = SpectralSolver::dense, .certify = true});
    REQUIRE(found.certified);
    const DenseSpectrum all(b);
    const auto counted = [&](const std::array<double, 2>& interval) {
      return all.between(1 - interval[1] - rounding, 1 - interval[0] + rounding);
    };
    CHECK(found.within_min == counted(found.interval_min));
    CHECK(found.within_max == counted(found.interval_max));
    unlike += found.within_min != found.within_max;
  });
  CHECK(unlike > 0);
}

TEST_CASE("isostatic: rho(B_0,eta) goes to 0 linearly with eta (4 disks: 0.626 eta)") {
  const Model four = build(strip(4));
  const InterfaceFamily family(four.parts);
  for (const double eta : {1e-3, 1e-4, 1e-5, 1e-6})
    CHECK(spectral_radius({family.at(eta), family.at(0)}).value / eta == doctest::Approx(0.626).epsilon(2e-3));
  for (const Index n : {8, 12}) {
    const InterfaceFamily larger(build(strip(n)).parts);
    const double at_small = spectral_radius({larger.at(1e-5), larger.at(0)}).value / 1e-5;
    CHECK(spectral_radius({larger.at(1e-6), larger.at(0)}).value / 1e-6 == doctest::Approx(at_small).epsilon(1e-3));
  }
  for (const Case& one : {two_tetrahedra(), octahedron(), sphere_cluster(1, 24, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    REQUIRE(inspect(model).whole.hyperstaticity == 0);
    REQUIRE(inspect(model).whole.rigid_modes == 6);
    const InterfaceFamily spatial(model.parts);
    const double at_small = spectral_radius({spatial.at(1e-5), spatial.at(0)}).value / 1e-5;
    CHECK(spectral_radius({spatial.at(1e-6), spatial.at(0)}).value / 1e-6 == doctest::Approx(at_small).epsilon(1e-3));
  }
}

TEST_CASE("nonsmooth, eta to 0: eigenvalues <= 0 and a limit I - X_0^-1 X-bar_0 where X_0 is regular") {
  for (const Index n : {4, 8, 12}) {
    const Model model = build(strip(n));
    const InterfaceFamily family(model.parts);
    const InterfaceOperator system = active_system(model, 0);
    const SpectralRadius small = spectral_radius({family.at(1e-7), system});
    CHECK(small.eigenvalue_max < 1e-6);
    CHECK(small.value > 1);
    const Dense limit = identity(4) - solve(family.at(0).dense(), system.dense());
    const Eigen::VectorXcd eigenvalues = general_eigenvalues(limit);
    CHECK(small.eigenvalue_min == doctest::Approx(eigenvalues.real().minCoeff()).epsilon(1e-5));
  }
}

TEST_CASE("the best eta has equal and opposite ends, and no other eta does better") {
  int always_convergent = 0;
  for (const Case& one : {strip(4), strip(8), strip(12), strip(20), two_tetrahedra(), octahedron(),
                          sphere_cluster(1, 24, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const Optimum best = optimum_of(model);
    REQUIRE(best.status == OptimumStatus::interior);
    const InterfaceFamily family(model.parts);
    const InterfaceOperator system = active_system(model, 0);
    const SpectralRadius there = spectral_radius({family.at(best.eta), system});
    CHECK(std::abs(there.eigenvalue_min + there.eigenvalue_max) < 1e-10);
    CHECK(there.value == doctest::Approx(best.radius));
    for (const double factor : {0.2, 0.9, 0.999, 1.001, 1.1, 5.0})
      CHECK(spectral_radius({family.at(best.eta * factor), system}).value > best.radius);
    // thresholds: on one side of each the property holds, on the other it does not
    if (best.convergent_from > 0) {
      CHECK(spectral_radius({family.at(best.convergent_from * 1.0001), system}).value < 1);
      CHECK(spectral_radius({family.at(best.convergent_from * 0.9999), system}).value > 1);
    } else {  // the octahedron converges with every eta
      CHECK(spectral_radius({family.at(1e-7), system}).value < 1);
    }
    always_convergent += best.convergent_from == 0;
    CHECK(spectral_radius({family.at(best.better_from * 1.0001), system}).value < best.generic_radius);
    CHECK(spectral_radius({family.at(best.better_from * 0.9999), system}).value > best.generic_radius);
    CHECK(best.relaxed_radius <= best.radius);
    CHECK(best.relaxed_radius <= best.generic_relaxed_radius * (1 + 1e-6));
  }
  CHECK(always_convergent == 1);
}

TEST_CASE("linear law: the best eta is epsilon, where B = 0") {
  for (const double epsilon : {0.01, 1.0, 40.0}) {
    for (const Case& one : {strip(8), two_tetrahedra()}) {
      const Optimum best = optimum_of(build(one), epsilon, ContactSet::all);
      CHECK(best.status == OptimumStatus::interior);
      CHECK(best.eta == doctest::Approx(epsilon).epsilon(1e-9));
      CHECK(best.radius < 1e-9);
    }
  }
}

TEST_CASE("optimal relaxation gives (kappa - 1)/(kappa + 1) < 1 for every eta") {
  on_every_interface([](const Model& model) {
    const InterfaceFamily family(model.parts);
    const InterfaceOperator system = active_system(model, 0);
    for (const double eta : {0.01, 0.3, 1.0, 30.0, infinity}) {
      CAPTURE(eta);
      const SpectralRadius plain = spectral_radius({family.at(eta), system});
      const double low = 1 - plain.subdominant_max, high = 1 - plain.subdominant_min;
      const SpectralRadius relaxed = spectral_radius({family.at(eta), system, 2 / (low + high)});
      CHECK(relaxed.subdominant == doctest::Approx((high - low) / (high + low)).epsilon(1e-9));
      CHECK(relaxed.subdominant < 1);
      CHECK(relaxed.subdominant <= plain.subdominant + 1e-12);
      CHECK(relaxed.unit_multiplicity == plain.unit_multiplicity);
    }
  });
}

TEST_CASE("residuals bound the errors of the ends") {
  // With the dense answer as truth, ARPACK stopped early must be off by no more than it says.
  for (const Case& one : {random_lattice(7, 9, 9, {3, 3}), random_fcc(7, 6, 5, 5, GridPartitioner{{2, 2, 2}})}) {
    const InterfaceFamily family(build(one).parts);
    const Contraction b{family.at(0.5), family.at(0.01)};
    const SpectralRadius truth = dense_pencil_radius(b);
    for (const double tolerance : {1e-2, 1e-4, 1e-8}) {
      SpectralOptions loose{.solver = SpectralSolver::arpack};
      loose.arpack.tolerance = tolerance;
      loose.arpack.basis = 6;
      const SpectralRadius radius = spectral_radius(b, loose);
      CHECK(radius.solver == "arpack");
      CHECK(std::abs(radius.eigenvalue_max - truth.eigenvalue_max) <= radius.residual + 1e-13);
      CHECK(std::abs(radius.eigenvalue_min - truth.eigenvalue_min) <= radius.residual + 1e-13);
    }
  }
}

TEST_CASE("rigid limit with masses over eight decades: multiplicity of the geometry, radii below 1, both solvers") {
  for (Case one : {random_lattice(6, 9, 8, {2, 2}), random_fcc(6, 6, 5, 4, GridPartitioner{{2, 2, 1}})}) {
    CAPTURE(one.spec.name);
    const Index unit = inspect(build(one)).unit_multiplicity;
    REQUIRE(unit > 0);
    RandomStream random(17);
    for (double& mass : one.packing.mass) mass = std::pow(10.0, 8 * random.uniform() - 4);
    const InterfaceFamily family(build(one).parts);
    const Contraction b{family.at(infinity), family.at(0)};
    const SpectralRadius dense = dense_pencil_radius(b);
    const SpectralRadius arpack = spectral_radius(b, {.solver = SpectralSolver::arpack});
    for (const SpectralRadius& radius : {dense, arpack}) {
      CHECK(radius.converged);
      CHECK(radius.unit_multiplicity == unit);
      CHECK(radius.value == 1);
      CHECK(radius.subdominant < 1 + 1e-12);
    }
    CHECK(std::abs(dense.subdominant - arpack.subdominant) < 1e-9);
  }
}
