// SPDX-License-Identifier: GPL-3.0-or-later
// The scheme schwarz: spectra on the interface against J = I - (D + epsilon)^-1 (W + epsilon) of all contacts.
#include "../support/cut_lattice.hpp"
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "study/linear/modes.hpp"
#include "study/linear/observed_rate.hpp"
#include <nscdd/ddm/schwarz.hpp>
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// W and D of whole masses on all contacts, in the order of the subdomains.
struct Literal {
  Matrix w, d;

  explicit Literal(const Decomposition& parts) {
    Index contacts = 0, rows = parts.dofs_per_grain() * parts.interface.grains();
    for (const Subdomain& s : parts.subdomains) contacts += s.h.cols();
    Matrix h = Matrix::Zero(rows, contacts);
    Vector mass = Vector::Zero(rows);
    std::vector<Index> subdomain;
    for (std::size_t e = 0; e < parts.subdomains.size(); ++e) {
      const Subdomain& s = parts.subdomains[e];
      const Matrix own = s.h;
      const Index k = parts.dofs_per_grain(), first = count(subdomain);
      for (Index i = 0; i < s.inertia.size(); ++i) {
        const Index row = k * s.grains[at(i / k)] + i % k;
        mass[row] += s.inertia[i];
        h.block(row, first, 1, own.cols()) = own.row(i);
      }
      subdomain.insert(subdomain.end(), at(own.cols()), static_cast<Index>(e));
    }
    const Vector inverse = (mass.array() > 0).select(mass.cwiseInverse(), 0);
    w = h.transpose() * inverse.asDiagonal() * h;
    d = w;
    for (Index i = 0; i < contacts; ++i)
      for (Index j = 0; j < contacts; ++j)
        if (subdomain[at(i)] != subdomain[at(j)]) d(i, j) = 0;
  }

  // Eigenvalues lambda of (W + epsilon, D + epsilon) outside ker D, ascending.
  Vector lambda(double epsilon) const {
    const Matrix unit = Matrix::Identity(d.rows(), d.rows());
    if (epsilon > 0) return pencil_eigenvalues(Matrix(w + epsilon * unit), Matrix(d + epsilon * unit));
    const auto [values, vectors] = symmetric_eigen(d);
    const Index zeros = (values.array() < 1e-10 * values.maxCoeff()).count();
    const Matrix range = vectors.rightCols(d.rows() - zeros);
    return pencil_eigenvalues(Matrix(range.transpose() * w * range), Matrix(range.transpose() * d * range));
  }

  // T^n + (I - T^n) J by its columns: n sweeps under the loads of the others.
  double radius_of_sweeps(double epsilon, Index sweeps, double omega) const {
    const Matrix unit = Matrix::Identity(d.rows(), d.rows());
    const Matrix lower = (d + epsilon * unit).triangularView<Eigen::Lower>();
    const Matrix t = unit - Matrix(lower.triangularView<Eigen::Lower>().solve(d + epsilon * unit));
    Matrix power = unit;
    for (Index k = 0; k < sweeps; ++k) power = power * t;
    const Matrix j = unit - solve(Dense(Matrix(d + epsilon * unit)), Dense(Matrix(w + epsilon * unit))).entries();
    const Matrix map = (1 - omega) * unit + omega * (power + (unit - power) * j);
    return general_eigenvalues(Dense(map)).cwiseAbs().maxCoeff();
  }
};

struct Ends {
  double low = 0, high = 0;
  Index units = 0;
};

// Ends of mu = 1 - lambda; the units are left out.
Ends ends_of(const Vector& lambda) {
  Ends ends;
  ends.units = (lambda.array() < 1e-9).count();
  ends.low = 1 - lambda[lambda.size() - 1];
  ends.high = 1 - lambda[ends.units];
  return ends;
}

std::vector<Case> problems() {
  std::vector<Case> all = with_interface(every_problem());
  all.push_back(deposit(150, {3, 2}));
  all.push_back(with_unequal_masses(deposit(120, {0, 0}, 5), 3));
  return all;
}

}  // namespace

TEST_CASE("schwarz: dense spectra are those of the literal J of all contacts, flexible and rigid") {
  for (const Case& one : problems()) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const Literal literal(model.parts);
    const Index q = largest_multiplicity(whole_masses(model.parts).interface);
    for (const double epsilon : {0.0, 1e-4, 0.3, 20.0}) {
      CAPTURE(epsilon);
      const Vector lambda = literal.lambda(epsilon);
      CHECK(lambda[lambda.size() - 1] <= static_cast<double>(q) + 1e-9);
      const Ends expected = ends_of(lambda);
      const SpectralRadius found = spectral_radius(schwarz_contraction(model.parts, LinearViscous{epsilon}),
                                                   {.solver = SpectralSolver::dense, .certify = true});
      REQUIRE(found.converged);
      CHECK(found.unit_multiplicity == expected.units);
      CHECK(std::abs(found.subdominant_min - expected.low) < 1e-9);
      CHECK(std::abs(found.subdominant_max - expected.high) < 1e-9);
      CHECK(found.certified);
      const auto near = [&](double mu) { return ((1 - lambda.array() - mu).abs() < 1e-8).count(); };
      if (std::abs(expected.low) > 1e-6) CHECK(found.within_min == near(expected.low));
    }
  }
}

TEST_CASE("schwarz: shift-invert proves the ends of the dense spectrum") {
  Index compared = 0;
  for (const Case& one : problems()) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    for (const double epsilon : {0.0, 1e-4, 1e-2, 1.0}) {
      CAPTURE(epsilon);
      const Contraction b = schwarz_contraction(model.parts, LinearViscous{epsilon});
      if (b.rows() < 5) continue;
      const SpectralRadius dense =
          spectral_radius(b, {.solver = SpectralSolver::dense, .eigenvalues = 3, .certify = true});
      if (std::abs(dense.subdominant_max) < 1e-6) continue;  // only mu = 0 is left beside the kernel
      const bool listed = count(dense.low) > 2 && dense.low[2] < -1e-6 && dense.high[2] > 1e-6;
      const SpectralRadius found =
          spectral_radius(b, {.solver = SpectralSolver::shift_invert, .eigenvalues = listed ? 3 : 1, .certify = true});
      INFO(found.failure);
      REQUIRE(found.converged);
      CHECK(found.certified);
      CHECK(found.unit_multiplicity == dense.unit_multiplicity);
      CHECK(std::abs(found.subdominant_min - dense.subdominant_min) <= found.residual + 1e-11);
      CHECK(std::abs(found.subdominant_max - dense.subdominant_max) <= found.residual + 1e-11);
      CHECK(found.interval_min[0] <= dense.subdominant_min);
      CHECK(found.interval_min[1] >= dense.subdominant_min);
      CHECK(found.interval_max[0] <= dense.subdominant_max);
      CHECK(found.interval_max[1] >= dense.subdominant_max);
      CHECK(found.within_min >= dense.within_min);
      for (std::size_t k = 0; listed && k < 3; ++k) {
        CHECK(std::abs(found.low[k] - dense.low[k]) <= found.residual + 1e-11);
        CHECK(std::abs(found.high[k] - dense.high[k]) <= found.residual + 1e-11);
      }
      for (const bool low : {true, false}) {  // a mode of resultants: J p = mu p
        const Vector& p = low ? found.mode_min : found.mode_max;
        const double mu = low ? found.subdominant_min : found.subdominant_max;
        CHECK((b.apply(p) - mu * p).norm() < 1e-4 * p.norm());
      }
      ++compared;
    }
  }
  CHECK(compared > 30);
}

TEST_CASE("schwarz: columns of friction are contacts like others") {
  const Decomposition parts = cut_lattice({3, 2}).parts;
  CHECK(parts.dofs_per_grain() == 3);
  const Literal literal(parts);
  for (const double epsilon : {0.0, 0.2}) {
    const Ends expected = ends_of(literal.lambda(epsilon));
    for (const SpectralSolver solver : {SpectralSolver::dense, SpectralSolver::shift_invert}) {
      const SpectralRadius found =
          spectral_radius(schwarz_contraction(parts, LinearViscous{epsilon}), {.solver = solver});
      CHECK(found.converged);
      CHECK(found.unit_multiplicity == expected.units);
      CHECK(std::abs(found.subdominant_min - expected.low) < 1e-8);
      CHECK(std::abs(found.subdominant_max - expected.high) < 1e-8);
    }
  }
}

TEST_CASE("schwarz: 4 disks have 1/sqrt 5, two subdomains a spectrum that is symmetric about 0") {
  for (const Index grains : {4, 8, 12}) {
    const SpectralRadius rigid = spectral_radius(schwarz_contraction(build(strip(grains)).parts, LinearViscous{0}));
    if (grains == 4) CHECK(std::abs(rigid.value - 1 / std::sqrt(5.0)) < 1e-14);
    CHECK(std::abs(rigid.eigenvalue_min + rigid.eigenvalue_max) < 1e-14);
  }
}

TEST_CASE("schwarz: without an impulse that others feel J is 0, and has no mode") {
  const Decomposition parts = build(strip(8)).parts;
  const Decomposition none = restrict_contacts(parts, std::vector<char>(at(parts.contacts), 0));
  const Model cube = build([] {
    Case one;
    one.spec.packing = CubicLattice{{.columns = 2, .rows = 2, .layers = 2, .radius = 0.5}};
    one.spec.partition = GridPartitioner{{2, 2, 1}};
    return one;
  }());
  for (const Decomposition& some : {none, cube.parts})
    for (const double epsilon : {0.0, 1.0}) {
      const Contraction b = schwarz_contraction(some, LinearViscous{epsilon});
      CHECK(b.rows() > 4);
      const Mode mode = mode_of(b, SpectrumSide::slowest, {.certify = true});
      CHECK(mode.spectrum.value < 1e-14);
      CHECK(mode.spectrum.certified);
      CHECK_FALSE(mode.found());
    }
}

TEST_CASE("schwarz: neither the numbers of grains nor the gluing matter, nor masses scaled with 1/epsilon") {
  const Case one = random_lattice(5, 7, 6, {2, 2});
  const auto ends = [](const Decomposition& parts, double epsilon) {
    const SpectralRadius found = spectral_radius(schwarz_contraction(parts, LinearViscous{epsilon}));
    return std::pair(found.eigenvalue_min, found.eigenvalue_max);
  };
  Model model = build(one);
  for (const double epsilon : {0.0, 0.1}) {
    const std::pair<double, double> expected = ends(model.parts, epsilon);
    const auto same = [&](const Decomposition& parts, double with) {
      const auto [other_low, other_high] = ends(parts, with);
      CHECK(std::abs(other_low - expected.first) < 1e-11);
      CHECK(std::abs(other_high - expected.second) < 1e-11);
    };
    same(build(renumbered(one, 4)).parts, epsilon);
    same(decompose(model.problem, model.partition, GluingShape::star), epsilon);
    ReferenceProblem heavy = model.problem;
    heavy.inertia *= 7;
    same(decompose(heavy, model.partition), epsilon / 7);
  }
}

TEST_CASE("schwarz: iterations are the operator on resultants, and sweeps have the radius of T^n + (I - T^n) J") {
  for (const Case& one : {strip(8), random_lattice(1, 6, 5, {2, 2}), two_tetrahedra()}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const Decomposition whole = whole_masses(model.parts);
    const double epsilon = 0.2;
    Contraction b = schwarz_contraction(model.parts, LinearViscous{epsilon});
    for (const double omega : {1.0, 0.6}) {
      b.relaxation = omega;
      const TwoStageIteration exact(whole, LinearViscous{epsilon}, b.preconditioner, std::nullopt, omega,
                                    DecompositionScheme::schwarz);
      Vector z = Vector::Zero(exact.rows());
      z.tail(b.rows()) = RandomStream(3).normal_vector(b.rows());
      z = exact.iterate(z);  // now the resultants are those of the impulses
      const Vector p = z.tail(b.rows()), next = exact.iterate(z).tail(b.rows());
      CHECK((next - b.apply(p)).norm() < 1e-10 * p.norm());
      const Literal literal(model.parts);
      for (const Index sweeps : {1, 3, 10}) {
        const TwoStageIteration inexact(whole, LinearViscous{epsilon}, b.preconditioner, sweeps, omega,
                                        DecompositionScheme::schwarz);
        const MapRadius found = inexact_radius(inexact, {.solver = SpectralSolver::dense});
        CHECK(found.value == doctest::Approx(literal.radius_of_sweeps(epsilon, sweeps, omega)).epsilon(1e-9));
      }
    }
  }
}

TEST_CASE("schwarz: the observed rate is the predicted one, and the best relaxation repairs a divergent cut") {
  const Model model = build(lattice_in_grid(150, {2, 2}));
  SweepParameters parameters;
  parameters.scheme = DecompositionScheme::schwarz;
  parameters.epsilon = {0.3};
  parameters.relaxation = {1.0, std::nullopt};
  Index rows = 0;
  const Index failed = observe(model, parameters, 1, [&](const ObservedResult& one) {
    CHECK(std::abs(one.difference()) < 1e-3 * std::abs(1 - one.predicted.radius.subdominant));
    ++rows;
  });
  CHECK(failed == 0);
  CHECK(rows == 2);
  parameters.epsilon = {0.0};
  parameters.spectral.solver = SpectralSolver::dense;
  std::vector<SweepResult> rigid;
  sweep(model, parameters, [&](const SweepResult& one) { rigid.push_back(one); });
  CHECK(rigid[0].radius.value > 1);
  const double low = rigid[0].radius.subdominant_min, high = rigid[0].radius.subdominant_max;
  CHECK(*rigid[1].point.relaxation == doctest::Approx(2 / (2 - low - high)));
  CHECK(rigid[1].radius.subdominant == doctest::Approx((high - low) / (2 - low - high)));
  CHECK(rigid[1].radius.subdominant < 1);
  parameters.relaxation = {1.0};
  parameters.epsilon = {0.3};
  parameters.gauss_seidel_sweeps = {1, 4};
  observe(model, parameters, 1, [&](const ObservedResult& one) {
    CHECK(std::abs(one.difference()) < 1e-3 * std::abs(1 - one.predicted.radius.subdominant));
  });
}
