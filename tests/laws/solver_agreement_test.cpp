// SPDX-License-Identifier: GPL-3.0-or-later
// Dense against sparse subdomains, dense pencils against ARPACK, matrices against applications.
#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "mechanics/active_set.hpp"
#include "two_stage/two_stage.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

TEST_CASE("interface operator: application, dense matrix and inverse agree, dense and sparse subdomains") {
  on_every_interface([](const Model& model) {
    const Index n = model.parts.interface_size();
    for (const GluingShape shape : {GluingShape::chain, GluingShape::star}) {
      const Decomposition parts = decompose(model.problem, model.partition, shape);
      const InterfaceFamily modal(parts), sparse(parts, 0);
      const Vector f = RandomStream(9).normal_vector(n);
      for (const double eta : {0.0, 1e-6, 1e-2, 1.0, 1e3, infinity}) {
        CAPTURE(eta);
        const InterfaceOperator a = modal.at(eta), b = sparse.at(eta);
        // Cholesky of M + K/eta loses digits as its condition grows like 1/eta
        const double scale = modal.at(infinity).dense().norm() * (eta > 0 ? std::max(1.0, 1e-3 / eta) : 1.0);
        CHECK((a.dense() - b.dense()).norm() < 1e-11 * scale);
        CHECK((a.dense() - a.dense().transpose()).norm() == 0);
        for (const InterfaceOperator& x : {a, b}) {
          CHECK((x.apply(f) - a.dense() * f).norm() < 1e-11 * scale * f.norm());
          if (eta >= 1e-2) CHECK((x.apply(x.solve(f)) - f).norm() < 1e-9 * f.norm());
        }
      }
    }
  });
}

TEST_CASE("dense pencil against ARPACK, generic and enriched, linear and nonsmooth, rigid and not") {
  for (const Case& one : {random_lattice(11, 12, 10, {3, 3}), random_lattice(12, 16, 8, {4, 1}), strip(40),
                          random_lattice(13, 10, 14, {2, 4}), random_fcc(11, 6, 6, 5, GridPartitioner{{2, 2, 2}}),
                          sphere_cluster(12, 60, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    Case cut = one;
    if (one.spec.name == "strip40") cut.spec.partition = GridPartitioner{{4, 1}};
    const Model model = build(cut);
    const std::vector<char> active = active_contacts(model.problem, rigid_impulses(model.problem));
    for (const Index limit : {Index{0}, InterfaceFamily::default_dense_limit}) {
      const InterfaceFamily family(model.parts, limit), nonsmooth(restrict_contacts(model.parts, active), limit);
      for (const double epsilon : {0.0, 1e-4, 1.0, 50.0})
        for (const double eta : {0.3, 1.0, infinity})
          for (const InterfaceFamily* system : {&family, &nonsmooth}) {
            INFO("epsilon = ", epsilon, ", eta = ", eta);
            const Contraction b{family.at(eta), system->at(epsilon)};
            const SpectralRadius dense = spectral_radius(b, {.solver = SpectralSolver::dense});
            const SpectralRadius arpack = spectral_radius(b, {.solver = SpectralSolver::arpack});
            REQUIRE(dense.converged);
            REQUIRE(arpack.converged);
            CHECK(arpack.solver == "arpack");
            CHECK(arpack.applications > 0);
            CHECK(std::abs(arpack.value - dense.value) < 1e-9 * std::max(1.0, dense.value));
            CHECK(std::abs(arpack.eigenvalue_min - dense.eigenvalue_min) < 1e-9 * std::max(1.0, dense.value));
            CHECK(std::abs(arpack.eigenvalue_max - dense.eigenvalue_max) < 1e-9 * std::max(1.0, dense.value));
            CHECK(std::abs(arpack.subdominant - dense.subdominant) < 1e-9 * std::max(1.0, dense.value));
            CHECK(arpack.unit_multiplicity == dense.unit_multiplicity);
          }
    }
  }
}

TEST_CASE("ARPACK: B = 0 and few interface unknowns") {
  const InterfaceFamily family(build(random_lattice(2, 8, 6, {3, 2})).parts);
  const SpectralRadius zero = spectral_radius({family.at(1.0), family.at(1.0)}, {.solver = SpectralSolver::arpack});
  CHECK(zero.converged);
  CHECK(zero.value < 1e-12);
  Case two = strip(2);  // one contact: nothing to share
  const Model one_contact = build(two);
  CHECK(one_contact.parts.interface_size() == 0);
  const SpectralRadius none = spectral_radius(contraction(one_contact.parts, Generic{}, LinearViscous{1.0}));
  CHECK(none.solver == "none");
  CHECK(none.value == 0);
  CHECK(none.converged);
}

TEST_CASE("ARPACK gives the same bits whatever was computed before") {
  const InterfaceFamily family(build(random_lattice(11, 12, 10, {3, 3})).parts);
  const Contraction b{family.at(0.4), family.at(0.01)};
  const SpectralRadius first = spectral_radius(b, {.solver = SpectralSolver::arpack});
  spectral_radius({family.at(infinity), family.at(1e-3)}, {.solver = SpectralSolver::arpack});
  const SpectralRadius second = spectral_radius(b, {.solver = SpectralSolver::arpack});
  CHECK(first.value == second.value);
  CHECK(first.eigenvalue_min == second.eigenvalue_min);
  CHECK(first.residual == second.residual);
}

TEST_CASE("not converged is data: ARPACK out of restarts says so and stays within its residual or gives none") {
  const InterfaceFamily family(build(random_lattice(13, 10, 14, {2, 4})).parts);
  SpectralOptions options{.solver = SpectralSolver::arpack, .tolerance = 1e-14};
  options.arpack.basis = 4;
  options.arpack.maximum_restarts = 1;
  const SpectralRadius radius = spectral_radius({family.at(infinity), family.at(1e-3)}, options);
  CHECK_FALSE(radius.converged);
}

TEST_CASE("J_n: dense against ARPACK's nonsymmetric driver, complex pairs included") {
  bool complex_pair_met = false;
  for (const Case& one : {random_lattice(2, 8, 6, {3, 2}), random_fcc(1, 4, 4, 4, GridPartitioner{{2, 2, 2}})})
    for (const auto& [epsilon, eta] : {std::pair{0.05, 0.3}, {0.05, infinity}, {1.0, 0.3}, {1.0, infinity}})
      for (const Index sweeps : {1, 3, 20}) {
        CAPTURE(one.spec.name);
        const Model model = build(one);
        const InterfaceFamily family(model.parts);
        const TwoStageIteration j(model.parts, LinearViscous{epsilon}, family.at(eta), sweeps);
        const MapRadius dense = inexact_radius(j, {.solver = SpectralSolver::dense});
        const MapRadius arpack = inexact_radius(j, {.solver = SpectralSolver::arpack});
        REQUIRE(dense.converged);
        REQUIRE(arpack.converged);
        CHECK(arpack.solver == "arpack");
        CHECK(arpack.value == doctest::Approx(dense.value).epsilon(1e-8));
        CHECK(std::abs(arpack.dominant.imag()) == doctest::Approx(std::abs(dense.dominant.imag())).epsilon(1e-6));
        complex_pair_met = complex_pair_met || dense.dominant.imag() != 0;
      }
  CHECK(complex_pair_met);
}
