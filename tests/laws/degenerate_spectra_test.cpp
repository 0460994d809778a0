// SPDX-License-Identifier: GPL-3.0-or-later
// Spectra in which many eigenvalues are equal, as those of lattices, chains, rings and copies are: every solver has the
// answer, and what one solver cannot answer another one does.
#include "../support/small_packings.hpp"
#include "../support/spectra.hpp"
#include "../support/thorough.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr std::array solvers{SpectralSolver::automatic, SpectralSolver::dense, SpectralSolver::shift_invert,
                             SpectralSolver::arpack};

// Rows of disks of unit mass that touch along x and along y, cut in two by x.
Case square_lattice(Index columns, Index rows) {
  Case one;
  one.spec.name = "square";
  one.spec.packing = PackingFile{"made in a test"};
  for (Index j = 0; j < rows; ++j)
    for (Index i = 0; i < columns; ++i) {
      one.packing.x.push_back(static_cast<double>(i));
      one.packing.y.push_back(static_cast<double>(j));
      one.packing.radius.push_back(0.5);
    }
  one.spec.partition = GridPartitioner{{2, 1}};
  return one;
}

// rho of the generic algorithm on a chain of disks of unit mass, cut in its middle grain: 1 - c / 2, with c the corner
// of (M + K / epsilon)^-1 of half a chain, by elimination from the free end.
double radius_of_chain(Index grains, double epsilon) {
  const double k = 1 / epsilon;
  double pivot = 1 + k;
  for (Index i = 1; i < grains / 2; ++i) pivot = 1 + 2 * k - k * k / pivot;
  return 1 - 1 / (0.5 + k - k * k / pivot) / 2;
}

// Of the middle grains along y: halves of grains in a column of contacts, which one subdomain has, against free halves.
// A mode of the column, whose stiffness is kappa / epsilon with kappa up to 4 cos^2(pi / (2 rows)), has 1 - S / P with
// S = 1 / (1/2 + kappa / epsilon) + 2 and P = 4.
double radius_of_column(Index rows, double epsilon) {
  const double kappa = 4 * std::pow(std::cos(std::numbers::pi / (2 * static_cast<double>(rows))), 2);
  return (1 - 1 / (1 + 2 * kappa / epsilon)) / 2;
}

}  // namespace

TEST_CASE("rows of a square lattice have the radius of one chain, each of them once more") {
  CHECK(radius_of_chain(5, 1) == doctest::Approx(6.0 / 11).epsilon(1e-14));
  for (const Index columns : {3, 5, 9})
    for (const Index rows : {1, 2, 3, 7, 12, 20, 33})
      for (const double epsilon : {1e-3, 1.0, 30.0}) {
        const InterfaceFamily family(build(square_lattice(columns, rows)).parts);
        const Contraction b{family.at(infinity), family.at(epsilon)};
        const double exact = std::max(radius_of_chain(columns, epsilon), radius_of_column(rows, epsilon));
        for (const SpectralSolver solver : solvers)
          for (const Index eigenvalues : {1, 2, 5}) {
            INFO("columns = ", columns, ", rows = ", rows, ", epsilon = ", epsilon, ", solver = ", solver,
                 ", eigenvalues = ", eigenvalues);
            const bool list = solver != SpectralSolver::arpack;
            const SpectralRadius radius =
                spectral_radius(b, {.solver = solver, .eigenvalues = list ? eigenvalues : 1, .certify = list});
            REQUIRE(radius.converged);
            CHECK(radius.certified == list);
            CHECK(radius.failure.empty());
            CHECK(std::abs(radius.value - exact) <= radius.residual + 1e-12);
          }
      }
}

TEST_CASE("small packings, 400 or 2 000: each solver has an answer, and all agree to their residuals with LAPACK's") {
  Index in_lists = 0, open_lists = 0;
  const Index packings = thorough() ? 2000 : 400;
  for (Index seed = 0; seed < packings; ++seed) {
    const SmallProblem small = small_problem(static_cast<std::uint64_t>(seed));
    INFO("seed = ", seed, ", name = ", small.one.spec.name);
    const InterfaceFamily family(build(small.one).parts);
    const Contraction b{family.at(small.eta), family.at(small.epsilon)};
    const Index n = b.rows(), units = n > 0 && small.epsilon == 0 ? b.system.nullity() : 0;
    const Vector lambda = n > 0 ? DenseSpectrum(b).lambda : Vector();  // in the rigid limit the units come first
    if (small.epsilon == 0) CHECK((lambda.array() < 1e-9).count() == units);
    for (const SpectralSolver solver : solvers)
      for (const bool certify : {false, true}) {
        if (certify && solver == SpectralSolver::arpack) continue;
        INFO("solver = ", solver, ", certify = ", certify);
        const Index wanted = solver == SpectralSolver::arpack ? 1 : small.eigenvalues;
        const SpectralRadius radius = spectral_radius(b, {.solver = solver, .eigenvalues = wanted, .certify = certify});
        CAPTURE(radius.failure);
        // Far from a shift a list by shift-invert alone needs digits that extreme flexibilities cost.
        const double smallest = small.epsilon > 0 ? std::min(small.epsilon, small.eta) : small.eta;
        if (solver == SpectralSolver::shift_invert && wanted > 1 && (smallest < 1e-3 || small.epsilon > 1e6) &&
            !radius.converged) {
          CHECK(radius.failure.starts_with("shift-invert: "));
          ++open_lists;
          continue;
        }
        REQUIRE(radius.converged);
        if (certify) CHECK(radius.certified);
        CHECK(radius.unit_multiplicity == units);
        if (n == units) continue;
        const double rounding = 1e-11 * std::max(1.0, lambda[n - 1]), error = radius.residual + rounding;
        CHECK(std::abs(radius.subdominant_max - (1 - lambda[units])) <= error);
        CHECK(std::abs(radius.subdominant_min - (1 - lambda[n - 1])) <= error);
        for (std::size_t k = 0; k < radius.high.size(); ++k, ++in_lists) {
          CHECK(std::abs(radius.high[k] - (1 - lambda[units + static_cast<Index>(k)])) <= error);
          CHECK(std::abs(radius.low[k] - (1 - lambda[n - 1 - static_cast<Index>(k)])) <= error);
        }
        if (radius.solver == "arpack" || wanted == 1) continue;
        CHECK(count(radius.high) == std::min(wanted, n - units));
      }
  }
  CHECK(in_lists > 5 * packings);
  CHECK(open_lists < packings / 50);
}

TEST_CASE("where the dense pencil loses its digits, auto goes on to a solver that has not, or says why none has") {
  const InterfaceFamily family(build(small_problem(3).one).parts);
  const auto radius = [&](double eta, SpectralSolver solver) {
    return spectral_radius({family.at(eta), family.at(1e3)}, {.solver = solver});
  };
  // lambda_max eta tends to a limit as eta goes to 0, in first order of eta.
  const auto scaled = [&](double eta) { return eta * radius(eta, SpectralSolver::dense).subdominant_min; };
  const double limit = 2 * scaled(1e-5) - scaled(2e-5);
  const SpectralRadius dense = radius(1e-12, SpectralSolver::dense), found = radius(1e-12, SpectralSolver::automatic);
  CHECK_FALSE(dense.converged);
  CHECK(dense.solver == "dense");
  CHECK(dense.failure.starts_with("dense: "));
  REQUIRE(found.converged);
  CHECK(found.solver == "arpack");
  CHECK(found.failure.empty());
  CHECK(1e-12 * found.subdominant_min == doctest::Approx(limit).epsilon(1e-7));
  // Next to the smallest numbers no solver has digits left.
  const SpectralRadius none = radius(1e-20, SpectralSolver::automatic);
  CHECK_FALSE(none.converged);
  CHECK(none.solver == "dense+shift-invert+arpack");
  for (const char* tried : {"dense: ", "; shift-invert: ", "; arpack: "})
    CHECK(none.failure.find(tried) != std::string::npos);
}
