// SPDX-License-Identifier: GPL-3.0-or-later
// The algorithm itself against what the operators say of it.
#include "two_stage/two_stage.hpp"

#include "../support/dense.hpp"
#include "../support/literal_formulas.hpp"
#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "study/linear/observed_rate.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Stage 2 of the paper, (16), on the outcome of Stage 1: X_eta F' = sum A M_eta^-1 (F^d + H (r + v/eta)).
Vector literal_stage_two(const Decomposition& parts, const std::vector<Vector>& loads, const Vector& f, double epsilon,
                         double eta) {
  Dense x = zero(f.size(), f.size());
  Vector right = Vector::Zero(f.size());
  for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
    const Subdomain& s = parts.subdomains[e];
    const Dense mass = diagonal(s.inertia), h = s.h, a = s.a;
    const Dense w = h.transpose() * mass.inverse() * h;
    const Vector v_d = h.transpose() * mass.inverse() * loads[e];
    const Vector r = solve(w + epsilon * identity(w.rows()), -v_d + h.transpose() * mass.inverse() * a.transpose() * f);
    const Vector v = -epsilon * r;
    const Dense m_eta = std::isinf(eta) ? mass : mass + h * h.transpose() / eta;
    const Vector r_plus = std::isinf(eta) ? r : Vector(r + v / eta);
    x += a * m_eta.inverse() * a.transpose();
    right += a * m_eta.inverse() * (loads[e] + h * r_plus);
  }
  return solve(x, right);
}

// z = (0, f)
Vector state_with(const TwoStageIteration& iteration, const Vector& f) {
  Vector z = Vector::Zero(iteration.rows());
  z.tail(f.size()) = f;
  return z;
}

}  // namespace

TEST_CASE("one iteration is the paper's Stage 1 and Stage 2, generic and enriched, under loads") {
  on_every_interface([&](const Model& model) {
    const std::vector<Vector> loads = impact_loads(model.parts, model.problem.arriving_velocity);
    const InterfaceFamily family(model.parts);
    for (const double eta : {0.4, 2.0, infinity}) {
      const TwoStageIteration iteration(model.parts, LinearViscous{0.3}, family.at(eta), std::nullopt);
      const Vector f = RandomStream(1).normal_vector(model.parts.interface_size());
      const Vector expected = literal_stage_two(model.parts, loads, f, 0.3, eta);
      const Vector met = iteration.iterate(state_with(iteration, f), &loads).tail(f.size());
      CHECK((met - expected).norm() < 1e-10 * expected.norm());
    }
  });
}

TEST_CASE("without loads one iteration is the contraction operator, rigid and relaxed included") {
  on_every_interface([&](const Model& model) {
    const InterfaceFamily family(model.parts);
    for (const double epsilon : {0.0, 0.2, 5.0})
      for (const double eta : {0.7, infinity})
        for (const double relaxation : {1.0, 0.6}) {
          const TwoStageIteration iteration(model.parts, LinearViscous{epsilon}, family.at(eta), std::nullopt,
                                            relaxation);
          const Contraction b{family.at(eta), family.at(epsilon), relaxation};
          const Vector f = RandomStream(2).normal_vector(b.rows());
          const Vector expected = b.apply(f);
          const Vector met = iteration.iterate(state_with(iteration, f)).tail(f.size());
          CHECK((met - expected).norm() < 1e-9 * f.norm());
        }
  });
}

TEST_CASE("at convergence the undivided problem is solved: same impulses, glued velocities") {
  for (const Case& one : {strip(4), strip(8), strip(12), two_tetrahedra(), octahedron(),
                          sphere_cluster(1, 24, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const std::vector<Vector> loads = impact_loads(model.parts, model.problem.arriving_velocity);
    const double epsilon = 0.5;
    const TwoStageIteration iteration(model.parts, LinearViscous{epsilon}, InterfaceFamily(model.parts).at(0.7),
                                      std::nullopt);
    Vector state = Vector::Zero(iteration.rows());
    for (int i = 0; i < 200; ++i) state = iteration.iterate(state, &loads);
    const Dense h = model.problem.h;
    const Dense w = h.transpose() * diagonal(model.problem.inertia.cwiseInverse()) * h;
    const Vector expected = solve(w + epsilon * identity(w.rows()), -h.transpose() * model.problem.arriving_velocity);
    Index row = 0;
    for (const Subdomain& subdomain : model.parts.subdomains)
      for (const Index c : subdomain.contacts) CHECK(state[row++] == doctest::Approx(expected[c]).epsilon(1e-10));
  }
}

TEST_CASE("J_n: nonzero spectrum of T^n + (I - T^n) W_eps^-1 Ahat^T X^-1 Ahat") {
  const Model model = build(random_lattice(1, 6, 5, {2, 2}));
  const double epsilon = 0.4;
  const LiteralFormulas literal(model.parts);
  Index contacts = 0;
  for (const Subdomain& s : model.parts.subdomains) contacts += s.h.cols();
  Matrix blocks = Matrix::Zero(contacts, contacts), columns(model.parts.interface_size(), contacts);
  Index offset = 0;
  for (const Subdomain& s : model.parts.subdomains) {
    const Index c = s.h.cols();
    const Dense h = s.h, a = s.a, inverse_mass = diagonal(s.inertia.cwiseInverse());
    blocks.block(offset, offset, c, c) = (h.transpose() * inverse_mass * h + epsilon * identity(c)).entries();
    columns.middleCols(offset, c) = (a * inverse_mass * h).entries();
    offset += c;
  }
  const Dense w = blocks, a_hat = columns;
  const Dense lower = Matrix(blocks.triangularView<Eigen::Lower>());
  const Dense strictly_upper = w - lower;
  const Dense t = -solve(lower, strictly_upper);
  const InterfaceOperator generic = InterfaceFamily(model.parts).at(infinity);
  for (const Index n : {1, 2, 7}) {
    Dense power = identity(contacts);
    for (Index k = 0; k < n; ++k) power = power * t;
    const Dense j =
        power + (identity(contacts) - power) * w.inverse() * a_hat.transpose() * literal.x().inverse() * a_hat;
    const double expected = general_eigenvalues(j).cwiseAbs().maxCoeff();
    const TwoStageIteration ours(model.parts, LinearViscous{epsilon}, generic, n);
    CHECK(inexact_radius(ours, {.solver = SpectralSolver::dense}).value == doctest::Approx(expected).epsilon(1e-9));
  }
}

TEST_CASE("J_n tends to B as n grows, generic and enriched") {
  const Model model = build(strip(8));
  const InterfaceFamily family(model.parts);
  for (const double eta : {0.3, infinity}) {
    const double limit = spectral_radius({family.at(eta), family.at(1.0)}).value;
    const TwoStageIteration j(model.parts, LinearViscous{1.0}, family.at(eta), Index{400});
    CHECK(inexact_radius(j).value == doctest::Approx(limit).epsilon(1e-9));
  }
}

TEST_CASE("observed rates agree with the spectral radius to the error of the fit") {
  for (const Case& one :
       {strip(4), strip(12), random_lattice(2, 8, 6, {3, 2}), random_fcc(1, 4, 4, 4, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    SweepParameters parameters{
        .epsilon = {0, 0.1, 1}, .eta = {0.3, infinity}, .gauss_seidel_sweeps = {2, std::nullopt}};
    if (one.spec.name != "strip4") parameters.epsilon = {0.1, 1};
    Index rows = 0;
    observe(model, parameters, 7, [&](const ObservedResult& result) {
      ++rows;
      INFO("result.predicted.point.epsilon = ", result.predicted.point.epsilon,
           ", result.predicted.point.eta = ", result.predicted.point.eta,
           ", result.predicted.point.gauss_seidel_sweeps.value_or(0) = ",
           result.predicted.point.gauss_seidel_sweeps.value_or(0));
      const double predicted = result.predicted.radius.subdominant;
      const double observed = result.observed.value;
      INFO("predicted = ", predicted, ", observed = ", observed);
      CHECK(result.agree());
      CHECK(std::abs(observed - predicted) < 2e-3);
    });
    CHECK(rows == static_cast<Index>(parameters.epsilon.size() * 4));
  }
}

TEST_CASE("hyperstatic rigid limit: the run shows the subdominant radius, not the unit eigenvalues") {
  for (const Case& one : {random_lattice(1, 6, 5, {2, 2}), random_fcc(5, 5, 5, 4, GridPartitioner{{2, 2, 1}})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const InterfaceFamily family(model.parts);
    const SpectralRadius radius = spectral_radius({family.at(infinity), family.at(0)});
    REQUIRE(radius.unit_multiplicity > 0);
    const InterfaceOperator preconditioner = family.at(infinity);
    const TwoStageIteration iteration(model.parts, LinearViscous{0}, preconditioner, std::nullopt);
    const ObservedRate observed = observed_rate(iteration, preconditioner, 3);
    CHECK(observed.value == doctest::Approx(radius.subdominant).epsilon(1e-6));
  }
}
