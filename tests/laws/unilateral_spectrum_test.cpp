// SPDX-License-Identifier: GPL-3.0-or-later
// The nonsmooth laws with the contacts that carry in the frictionless unilateral problem.
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

double smallest_of(const Matrix& a) { return symmetric_eigenvalues(a).minCoeff(); }

// Every problem under its own load and under compression.
template <class Law>
void on_every_problem(Law&& law) {
  int problems = 0;
  for (Case one : with_interface(every_problem()))
    for (const bool compressed : {false, true}) {
      INFO("name = ", one.spec.name, ", compressed = ", compressed);
      if (compressed) {
        one.spec.prescribed.clear();
        one.spec.loads = {{1.0, 0.3}, 0.2};
        if (dimension_of(one) == 3) one.spec.loads.compression = {1.0, 0.3, -0.1};
      }
      const Model model = build(one);
      law(model, select(model, ContactSet::unilateral));
      ++problems;
    }
  CHECK(problems >= 28);
}

}  // namespace

TEST_CASE("order: fewer contacts than all make the rigid operator larger, up to X") {
  on_every_problem([](const Model& model, const Selection& selection) {
    REQUIRE(selection.certain);
    const InterfaceFamily family(model.parts);
    const Matrix carrying = InterfaceFamily(selection.stage_one(model)).at(0).dense();
    CHECK(smallest_of(carrying - family.at(0).dense()) > -1e-10);
    CHECK(smallest_of(family.at(infinity).dense() - carrying) > -1e-10);
  });
}

TEST_CASE("the generic algorithm on the contacts that carry never diverges; relaxed, no eta does") {
  on_every_problem([](const Model& model, const Selection& selection) {
    const InterfaceFamily family(model.parts);
    const InterfaceOperator system = InterfaceFamily(selection.stage_one(model)).at(0);
    const SpectralRadius generic = spectral_radius({family.at(infinity), system}, {.solver = SpectralSolver::dense});
    REQUIRE(generic.converged);
    CHECK(generic.subdominant < 1);
    CHECK(generic.eigenvalue_min > -1e-12);
    const SpectralRadius enriched = spectral_radius({family.at(0.05), system}, {.solver = SpectralSolver::dense});
    const double low = 1 - enriched.subdominant_max, high = 1 - enriched.subdominant_min;
    CHECK(low > 0);
    CHECK((high - low) / (high + low) < 1);
  });
}
