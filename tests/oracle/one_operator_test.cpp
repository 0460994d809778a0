// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's six contraction matrices, literally and densely, against the one operator of the program.
#include "../support/literal_formulas.hpp"
#include "../support/problems.hpp"
#include "mechanics/active_set.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Spectra agree, eigenvalue for eigenvalue at the ends, and the matrix B itself entry for entry.
void require_same(const Contraction& b, const Dense& x, const Dense& y, double tolerance) {
  if (b.rows() == 0) return;
  const Matrix literal = x.inverse() * y;
  Matrix ours(b.rows(), b.cols());
  for (Index j = 0; j < b.cols(); ++j) ours.col(j) = b.apply(Vector::Unit(b.cols(), j));
  const double scale = std::max(1.0, literal.cwiseAbs().maxCoeff());
  CHECK((ours - literal).cwiseAbs().maxCoeff() < tolerance * scale);

  const Eigen::VectorXcd eigenvalues = contraction_eigenvalues(x, y);
  const SpectralRadius radius = spectral_radius(b);
  REQUIRE(radius.converged);
  CHECK(eigenvalues.imag().cwiseAbs().maxCoeff() < 1e-6);  // real, up to a nonsymmetric solver's rounding
  CHECK(radius.eigenvalue_max == doctest::Approx(eigenvalues.real().maxCoeff()).epsilon(tolerance));
  CHECK(radius.eigenvalue_min == doctest::Approx(eigenvalues.real().minCoeff()).epsilon(tolerance).scale(scale));
  CHECK(radius.value == doctest::Approx(eigenvalues.cwiseAbs().maxCoeff()).epsilon(tolerance));
}

// Calls `check` with every problem, its literal formulas and its operators.
template <class Check>
void for_every_problem(const Check& check) {
  for (const Case& one : every_problem()) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    check(model, LiteralFormulas(model.parts), InterfaceFamily(model.parts));
  }
}

}  // namespace

TEST_CASE("linear law: (10)-(11) and (20)-(24) against the one operator") {
  for_every_problem([](const Model&, const LiteralFormulas& literal, const InterfaceFamily& family) {
    for (const double epsilon : {0.0, 1e-3, 0.1, 1.0, 30.0}) {
      CAPTURE(epsilon);
      require_same({family.at(infinity), family.at(epsilon)}, literal.x(), literal.y(epsilon), 1e-10);
      for (const double eta : {0.1, 1.0, 7.0}) {
        CAPTURE(eta);
        require_same({family.at(eta), family.at(epsilon)}, literal.x_eta(eta), literal.y(epsilon, eta), 1e-9);
      }
    }
  });
}

TEST_CASE("nonsmooth case: (31) and (34)-(36) against the one operator") {
  for_every_problem([](const Model& model, const LiteralFormulas& literal, const InterfaceFamily& family) {
    const std::vector<char> active = active_contacts(model.problem, rigid_impulses(model.problem));
    const InterfaceOperator system = InterfaceFamily(restrict_contacts(model.parts, active)).at(0);
    require_same({family.at(infinity), system}, literal.x(), literal.y_bar(active), 1e-10);
    for (const double eta : {0.1, 1.0, 7.0}) {
      CAPTURE(eta);
      require_same({family.at(eta), system}, literal.x_eta(eta), literal.y_bar(active, eta), 1e-9);
    }
  });
}

TEST_CASE("Woodbury: Y_eps = X - X_eps and Y_eps,eta = X_eta - X_eps") {
  for_every_problem([](const Model&, const LiteralFormulas& literal, const InterfaceFamily& family) {
    for (const double epsilon : {1e-3, 1.0, 30.0}) {
      CHECK((literal.x() - literal.y(epsilon) - family.at(epsilon).dense()).norm() <
            1e-11 * literal.x().norm() + 1e-14);
      CHECK((literal.x_eta(0.3) - literal.y(epsilon, 0.3) - family.at(epsilon).dense()).norm() <
            1e-11 * literal.x().norm() * std::max(1.0, epsilon) + 1e-14);
    }
    // the rigid limit is the limit
    CHECK((family.at(0).dense() - family.at(1e-9).dense()).norm() < 1e-6 * literal.x().norm() + 1e-14);
    CHECK((literal.x() - literal.y(0.0) - family.at(0).dense()).norm() < 1e-10 * literal.x().norm() + 1e-14);
  });
}
