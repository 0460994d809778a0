// SPDX-License-Identifier: GPL-3.0-or-later
// The search for one end of the spectrum: whatever it is told to start from, and what it says when stopped.
#include "spectra/pencil_end.hpp"

#include "../support/problems.hpp"
#include "../support/sanitized.hpp"
#include "../support/spectra.hpp"
#include "linalg/random.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

struct Problem {
  Problem(const Case& one, double epsilon, double eta)
      : family(build(one).parts), b{family.at(eta), family.at(epsilon)}, dense(b), pencils(b), point{epsilon, eta} {}
  PencilEnd find(SpectrumEnd end, const EndOptions& options = {}, const std::optional<EndGuess>& guess = {},
                 const Vector& start = {}) const {
    return find_end(pencils, b.preconditioner, point, end, guess, start, options);
  }
  double expected(SpectrumEnd end) const {
    return end == SpectrumEnd::smallest ? dense.lambda[0] : dense.lambda[dense.lambda.size() - 1];
  }
  InterfaceFamily family;
  Contraction b;
  DenseSpectrum dense;
  ShiftedPencilFamily pencils;
  PencilPoint point;
};

const std::vector<SpectrumEnd> both_ends{SpectrumEnd::smallest, SpectrumEnd::largest};

std::vector<Problem> some_problems() {
  std::vector<Problem> all;
  all.emplace_back(random_lattice(2, 8, 6, {3, 2}), 0.05, infinity);
  all.emplace_back(random_lattice(3, 8, 9, {2, 3}), 1.0, 0.2);
  all.emplace_back(deposit(80, {3, 2}), 1e-3, 0.4);
  return all;
}

}  // namespace

TEST_CASE("shifted pencil: with infinite eta all velocities are the interior, and the gluing alone is the border") {
  for (const double eta : {infinity, 0.5}) {
    CAPTURE(eta);
    const Problem problem(random_lattice(2, 8, 6, {3, 2}), 0.05, eta);
    InertiaPattern seen;
    const ShiftedPencilFamily family(problem.b, SystemForm::condensed, {"looks on", [&](const InertiaPattern& pattern) {
                                                                          seen = pattern;
                                                                          return InertiaFamily{};
                                                                        }});
    const auto border = seen.group.end() - seen.border;
    Index shared = 0;  // velocities in a group with gluing
    for (auto group = seen.group.begin(); group != border; ++group)
      shared += std::find(border, seen.group.end(), *group) != seen.group.end();
    CHECK(seen.border == problem.b.rows());
    CHECK((shared == 0) == std::isinf(eta));
  }
}

TEST_CASE("pencil end: without bounds, with loose bounds, with exact ones") {
  for (Problem& problem : some_problems())
    for (const auto& [low, high] :
         {std::pair{0.0, infinity},
          {problem.dense.lambda[0] / 7, 1e3},
          {problem.expected(SpectrumEnd::smallest), problem.expected(SpectrumEnd::largest)}}) {
      problem.point.low = low;
      problem.point.high = high;
      for (const SpectrumEnd end : both_ends) {
        const PencilEnd found = problem.find(end, {.certify = true});
        REQUIRE(found.converged);
        CHECK(found.certified);
        CHECK(found.residual <= 1e-8 * std::max(1.0, std::abs(1 - found.values[0])));
        CHECK(std::abs(found.values[0] - problem.expected(end)) <= found.residual + 1e-12);
        CHECK(found.within >= 1);
        CHECK(found.factorisations >= 2);
        CHECK(found.solves > 0);
      }
    }
}

TEST_CASE("pencil end: a guess helps or does no harm, however wrong") {
  for (const Problem& problem : some_problems())
    for (const SpectrumEnd end : both_ends) {
      const double truth = problem.expected(end);
      const double middle = problem.dense.lambda[problem.dense.lambda.size() / 2];
      const std::vector<EndGuess> guesses{{truth, 0},           {truth, 1e-6},     {truth * 1.01, 1e-6},
                                          {truth * 0.99, 1e-6}, {middle, 0},       {middle, 1e-3},
                                          {truth * 50, 0.1},    {truth / 50, 0.1}, {truth, 1e3 * truth},
                                          {1e-6 * truth, 0},    {1e6 * truth, 0}};
      for (const EndGuess& guess : watched(guesses)) {
        INFO("value = ", guess.value, ", uncertainty = ", guess.uncertainty);
        const PencilEnd found = problem.find(end, {.certify = true}, guess);
        REQUIRE(found.converged);
        CHECK(found.certified);
        CHECK(std::abs(found.values[0] - truth) <= found.residual + 1e-12);
      }
      const PencilEnd cold = problem.find(end);
      CHECK(problem.find(end, {}, EndGuess{truth, 1e-7}, cold.vectors.col(0)).factorisations <= cold.factorisations);
    }
}

TEST_CASE("pencil end: a start vector helps or does no harm, even an eigenvector of the other end") {
  for (const Problem& problem : some_problems())
    for (const SpectrumEnd end : both_ends) {
      const SpectrumEnd other = end == SpectrumEnd::smallest ? SpectrumEnd::largest : SpectrumEnd::smallest;
      const Index n = problem.b.rows();
      for (const Vector& start : {Vector(problem.find(other).vectors.col(0)), Vector(RandomStream(3).normal_vector(n)),
                                  Vector(Vector::Unit(n, 0)), Vector(Vector::Zero(n)), Vector(Vector::Ones(2))}) {
        const PencilEnd found = problem.find(end, {.certify = true}, {}, start);
        REQUIRE(found.converged);
        CHECK(found.certified);
        CHECK(std::abs(found.values[0] - problem.expected(end)) <= found.residual + 1e-12);
      }
    }
}

TEST_CASE("pencil end: an eigenvector of the next mode is not the end, certified or not") {
  for (const Problem& problem : some_problems())
    for (const SpectrumEnd end : both_ends) {
      const Index n = problem.b.rows();
      const Dense scaled = solve(problem.dense.p, problem.dense.s);
      const double truth = problem.expected(end);
      // number k from the end, by inverse iteration
      for (const Index k : {1, 2, 3}) {
        const double other = problem.dense.lambda[end == SpectrumEnd::smallest ? k : n - 1 - k];
        Vector x = RandomStream(5).normal_vector(n);
        const LinearMap inverse = solver(scaled - other * (1 + 1e-9) * identity(n));
        for (int repetition = 0; repetition < 3; ++repetition) x = inverse(x).normalized();
        const Vector impulses = problem.dense.root.asDiagonal() * x;
        for (const double distance : {1e-3, 1e-6}) {
          const double side = end == SpectrumEnd::smallest ? -1 : 1;
          const EndGuess guess{truth + side * distance, 0};
          const PencilEnd found = problem.find(end, {}, guess, impulses);
          REQUIRE(found.converged);
          CHECK(std::abs(found.values[0] - truth) <= found.residual + 1e-12);
        }
      }
    }
}

TEST_CASE("pencil end: the tolerance asked for is met, loose or tight") {
  for (const Problem& problem : some_problems())
    for (const SpectrumEnd end : both_ends)
      for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-9}) {
        CAPTURE(tolerance);
        const PencilEnd found = problem.find(end, {.tolerance = tolerance, .certify = true});
        REQUIRE(found.converged);
        CHECK(found.residual <= tolerance * std::max(1.0, std::abs(1 - found.values[0])));
        CHECK(std::abs(found.values[0] - problem.expected(end)) <= found.residual + 1e-12);
        REQUIRE(found.certified);
        const double from = std::min(found.outside, found.inside), to = std::max(found.outside, found.inside);
        CHECK(from <= problem.expected(end));
        CHECK(to >= problem.expected(end));
        CHECK(to - from <= 5 * tolerance * std::max(1.0, std::abs(1 - found.values[0])));
        CHECK(found.within == problem.dense.between(from, to));
      }
}

TEST_CASE("pencil end: a value that a false bound passes off as the end is not certified") {
  // Nothing counts beyond the value until the certificate does: what is known beforehand stands for a proof.
  int misled = 0;
  for (Problem& problem : some_problems())
    for (const SpectrumEnd end : both_ends)
      for (const Index steps : watched(std::vector<Index>{1, 2, 3}))
        for (const double false_by : {9e-4, 5e-4, 1e-4, 1e-5, 1e-6})
          for (const double tolerance : watched<double>({1e-12, 1e-10, 1e-8})) {
            const double truth = problem.expected(end);
            problem.point.low = end == SpectrumEnd::smallest ? truth * (1 + false_by) : 0;
            problem.point.high = end == SpectrumEnd::largest ? truth * (1 - false_by) : infinity;
            const PencilEnd found = problem.find(end, {.tolerance = tolerance, .certify = true, .steps = steps});
            const double away = std::abs(found.values[0] - truth);
            if (!found.converged || away <= 20 * tolerance * std::max(1.0, truth) + 1e-12) continue;
            CHECK_FALSE(found.certified);
            ++misled;
          }
  CHECK(misled > 0);
}

TEST_CASE("pencil end: out of factorisations is marked, and what was found stays within its residual") {
  int marked = 0;
  for (const Problem& problem : some_problems())
    for (const SpectrumEnd end : both_ends) {
      for (const Index allowed : {1, 2}) {
        const PencilEnd few = problem.find(end, {.maximum_factorisations = allowed});
        CHECK(few.factorisations <= allowed);
        CHECK(few.converged == (few.residual <= 1e-8));
        if (few.values.size() > 0)
          CHECK((problem.dense.lambda.array() - few.values[0]).abs().minCoeff() <= few.residual + 1e-12);
        if (!few.converged) ++marked;
        const PencilEnd proved = problem.find(end, {.certify = true, .maximum_factorisations = allowed});
        CHECK(proved.factorisations <= allowed + 2);  // the two counts come on top
        if (!proved.converged) CHECK_FALSE(proved.certified);
      }
      const PencilEnd none = problem.find(end, {.maximum_factorisations = 0});
      CHECK_FALSE(none.converged);
      CHECK(none.values.size() == 0);
    }
  CHECK(marked > 0);
}

TEST_CASE("relaxed: the same spectrum under another omega as computed with it") {
  const InterfaceFamily family(build(random_lattice(2, 8, 6, {3, 2})).parts);
  for (const SpectralSolver solver : {SpectralSolver::dense, SpectralSolver::arpack, SpectralSolver::shift_invert})
    for (const double epsilon : {0.0, 0.05, 3.0})
      for (const double eta : {0.3, infinity})
        for (const double omega : watched<double>({0.2, 1.0, 1.6, 4.0})) {
          if (epsilon == 0 && solver == SpectralSolver::shift_invert) continue;
          INFO("epsilon = ", epsilon, ", eta = ", eta, ", omega = ", omega);
          const SpectralOptions options{.solver = solver, .certify = true};
          const SpectralRadius direct = spectral_radius({family.at(eta), family.at(epsilon), omega}, options);
          const SpectralRadius plain = spectral_radius({family.at(eta), family.at(epsilon)}, options);
          const SpectralRadius after = relaxed(plain, omega, options.tolerance);
          CHECK((after.value == direct.value && after.converged == direct.converged));
          CHECK(after.residual == omega * plain.residual);
          CHECK(after.unit_multiplicity == plain.unit_multiplicity);
          CHECK(after.subdominant_min == doctest::Approx(1 - omega * (1 - plain.subdominant_min)).epsilon(1e-14));
          CHECK(after.subdominant_max == doctest::Approx(1 - omega * (1 - plain.subdominant_max)).epsilon(1e-14));
          if (plain.unit_multiplicity > 0) CHECK(after.eigenvalue_max >= 1);
          REQUIRE(after.low.size() == plain.low.size());
          for (std::size_t k = 0; k < plain.low.size(); ++k)
            CHECK(after.low[k] == doctest::Approx(1 - omega * (1 - plain.low[k])).epsilon(1e-14));
          CHECK(after.certified == plain.certified);
          if (plain.certified)
            CHECK(after.interval_max[1] == doctest::Approx(1 - omega * (1 - plain.interval_max[1])).epsilon(1e-14));
        }
}

TEST_CASE("relaxed: an empty interface and a search without result stay what they are") {
  CHECK(relaxed(SpectralRadius{}, 0.5, 1e-8).solver == "none");
  SpectralRadius failed;
  failed.solver = "shift-invert";
  failed.converged = false;
  failed.value = failed.subdominant = not_a_number;
  CHECK(std::isnan(relaxed(failed, 0.5, 1e-8).value));
  CHECK_FALSE(relaxed(failed, 0.5, 1e-8).converged);
  failed.value = failed.subdominant = 0.5;
  failed.subdominant_min = -0.5;
  failed.subdominant_max = 0.25;
  CHECK_FALSE(relaxed(failed, 0.5, 1e-8).converged);  // however small its residual
}

TEST_CASE("shift-invert: what rounding takes counts as residual, and there is no convergence beyond the tolerance") {
  const InterfaceFamily family(build(with_unequal_masses(random_lattice(2, 8, 6, {3, 2}), 7)).parts);
  int lost = 0;
  for (const double epsilon : {1e-6, 1e-4})
    for (double tolerance = 1e-6; tolerance > 1e-11; tolerance *= sanitized ? 0.3 : 0.8) {
      INFO("epsilon = ", epsilon, ", tolerance = ", tolerance);
      const SpectralRadius found = spectral_radius({family.at(infinity), family.at(epsilon)},
                                                   {.solver = SpectralSolver::shift_invert, .tolerance = tolerance});
      REQUIRE(found.value < 1);
      CHECK(found.converged == (found.residual <= tolerance));
      lost += !found.converged;
    }
  CHECK(lost > 0);
}

TEST_CASE("a list of no eigenvalues is refused") {
  const InterfaceFamily family(build(random_lattice(2, 4, 4, {2, 1})).parts);
  CHECK_THROWS_WITH_AS(spectral_radius({family.at(infinity), family.at(1)}, {.eigenvalues = 0}),
                       "eigenvalues: expected at least 1, met 0", Error);
}

TEST_CASE("matrix-free: the residual is that of the worse end") {
  const InterfaceFamily family(build(random_lattice(2, 8, 6, {3, 2})).parts);
  const Contraction b{family.at(0.3), family.at(0.05)};
  const Dense s = b.system.dense(), p = b.preconditioner.dense();
  const SpectralRadius found =
      spectral_radius(b, {.solver = SpectralSolver::arpack, .tolerance = 1, .arpack = {.basis = 6, .tolerance = 1e-2}});
  const auto residual = [&](const Vector& x, double mu) {
    const Vector r = s * x - (1 - mu) * (p * x);
    return std::sqrt(r.dot(solve(p, r)) / x.dot(p * x));
  };
  const double low = residual(found.mode_min, found.subdominant_min);
  const double high = residual(found.mode_max, found.subdominant_max);
  REQUIRE(std::max(low, high) > 1.1 * std::min(low, high));
  CHECK(found.residual == doctest::Approx(std::max(low, high)).epsilon(1e-6));
}

TEST_CASE("pencil end: slopes along a sweep are those of finite differences") {
  const Case one = random_lattice(3, 8, 9, {2, 3});
  const double epsilon = 1, eta = 0.2, step = 1e-3;
  const Problem here(one, epsilon, eta);
  const Problem softer(one, epsilon * std::exp(step), eta), stiffer(one, epsilon * std::exp(-step), eta);
  const Problem looser(one, epsilon, eta * std::exp(step)), tighter(one, epsilon, eta * std::exp(-step));
  for (const SpectrumEnd end : both_ends) {
    const PencilEnd found = here.find(end);
    REQUIRE(found.converged);
    CHECK(found.slope_epsilon ==
          doctest::Approx((softer.expected(end) - stiffer.expected(end)) / (2 * step)).epsilon(1e-3));
    CHECK(found.slope_eta ==
          doctest::Approx((looser.expected(end) - tighter.expected(end)) / (2 * step)).epsilon(1e-3));
  }
}

TEST_CASE("shift-invert: an end without a proof leaves the radius uncertified, whichever end it is") {
  const InterfaceFamily family(build(random_lattice(2, 8, 6, {3, 2})).parts);
  const Contraction b{family.at(infinity), family.at(0.05)};
  const DenseSpectrum dense(b);
  const Index n = dense.lambda.size();
  const Index last = b.rows() - 1;
  const double unit = b.preconditioner.generic().coeff(last, last);
  for (const auto& [from, to] :
       {std::pair{dense.lambda[0], dense.lambda[1]}, {dense.lambda[n - 2], dense.lambda[n - 1]}}) {
    // Every factorisation from one of these shifts looks singular; the last entry of the matrix tells it.
    const auto blind = [=, from = from, to = to](const InertiaPattern& pattern) {
      const InertiaFamily sighted = multifrontal().analyse(pattern);
      return InertiaFamily{[=](const SparseMatrix& lower, const std::array<double, 2>& parameters) {
                             const Index corner = lower.rows() - 1;
                             const double shift = lower.coeff(corner, corner) / unit;
                             return shift > from && shift < to ? InertiaFactor{} : sighted.factorise(lower, parameters);
                           },
                           sighted.release};
    };
    const SpectralRadius found =
        spectral_radius(b, {.solver = SpectralSolver::shift_invert, .certify = true, .inertia = {"blind", blind}});
    CHECK(found.converged);
    CHECK_FALSE(found.certified);
  }
}
