// SPDX-License-Identifier: GPL-3.0-or-later
// Problems large enough for parallel work: known values, inertia known in closed form, bits for any threads.
#include "../support/matrices.hpp"
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "linalg/multifrontal/factor.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include "spectra/spectrum_memory.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Index laplacian_eigenvalues_below(Index columns, Index rows, double shift) {
  const auto part = [](Index k, Index n) {
    const double s = std::sin(0.5 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n + 1));
    return 4 * s * s;
  };
  Index below = 0;
  for (Index i = 1; i <= columns; ++i)
    for (Index j = 1; j <= rows; ++j) below += part(i, columns) + part(j, rows) < shift;
  return below;
}

SpectralRadius certified_radius(const Case& one, double epsilon) {
  const InterfaceFamily family(build(one).parts);
  return spectral_radius({family.at(infinity), family.at(epsilon)},
                         {.solver = SpectralSolver::shift_invert, .tolerance = 1e-9, .certify = true});
}

}  // namespace

TEST_CASE("symmetric factor: inertia of a large Laplacian in closed form, indefinite and not") {
  const Index columns = 160, rows = 150;
  const SymmetricAnalysis analysis(shifted_laplacian(columns, rows, 0), single_rows(columns * rows));
  for (const double shift : {0.0, 0.01, 0.7, 3.3, 4.1, 7.9, 8.5}) {
    CAPTURE(shift);
    const SparseMatrix lower = shifted_laplacian(columns, rows, shift);
    const SymmetricFactor factor(analysis, lower);
    REQUIRE(factor.regular());
    CHECK(factor.negative_eigenvalues() == laplacian_eigenvalues_below(columns, rows, shift));
    const Vector b = RandomStream(2).normal_vector(lower.rows());
    CHECK(backward_error(lower, factor.solve(b), b) < 1e-8);
  }
}

TEST_CASE("symmetric factor: the same bits for 1 to 4 threads, again and again") {
  SymmetricProblem problem{"Laplacian", shifted_laplacian(160, 150, 1.3), {}};
  for (Index i = 0; i < problem.lower.rows(); ++i) problem.group.push_back(i / 3);
  const SymmetricAnalysis analysis(problem.lower, problem.group);
  CHECK(analysis.entries() > 5e5);  // or there would be nothing to do in parallel
  const Vector b = RandomStream(5).normal_vector(problem.lower.rows());
  const std::vector<Index> rows{0, 7, 1111, 12000, 23999};
  Vector x;
  Matrix block;
  for (int repetition = 0; repetition < 3; ++repetition)
    for (const Index threads : {1, 2, 3, 4, 0}) {
      CAPTURE(threads);
      const ThreadLimit limit(threads);
      const SymmetricFactor factor(analysis, problem.lower);
      REQUIRE(factor.regular());
      CHECK(factor.negative_eigenvalues() == laplacian_eigenvalues_below(160, 150, 1.3));
      const Vector again = factor.solve(b);
      const Matrix block_again = factor.inverse_block(rows);
      if (x.size() == 0) {
        x = again;
        block = block_again;
        CHECK(backward_error(problem.lower, x, b) < 1e-9);
        for (Index k = 0; k < count(rows); ++k) {
          const Vector column = factor.solve(Vector::Unit(b.size(), rows[at(k)]));
          CHECK((Vector(column(rows)) - block.col(k)).norm() < 1e-9 * block.norm());
        }
      }
      CHECK(again == x);
      CHECK(block_again == block);
    }
}

TEST_CASE("10^4 disks in 16 strips at epsilon = 1: 0.743952321309, certified") {
  const SpectralRadius found = certified_radius(lattice_in_grid(10000, {16, 1}), 1.0);
  CHECK(found.converged);
  CHECK(found.certified);
  CHECK(std::abs(found.value - 0.743952321309) < 1e-9);
  CHECK(found.interval_max[0] <= found.value);
  CHECK(found.value <= found.interval_max[1]);
  CHECK(found.interval_max[1] - found.interval_max[0] < 1e-7);
}

// Computed outside of the library, with SciPy and Octave, on matrices written out for them.
TEST_CASE("10^3 disks in 2 strips: known radii at both ends of epsilon") {
  const Case one = lattice_in_grid(1000, {2, 1});
  for (const auto& known : {std::pair{1e-4, 0.999961672916}, {1e2, 0.041824310509}}) {
    CAPTURE(known.first);
    const SpectralRadius found = certified_radius(one, known.first);
    CHECK(found.converged);
    CHECK(found.certified);
    CHECK(std::abs(found.value - known.second) < 1e-9);
  }
}

TEST_CASE("800 to 2 000 interface unknowns: shift-invert and ARPACK against the dense solver") {
  Case lognormal = deposit(3000, {1, 1}, 40);
  lognormal.spec.packing =
      Generator{Deposit{.grains = 3000,
                        .sizes = {.distribution = "lognormal", .radius_min = 0.02, .radius_max = 0.4, .sigma = 0.6},
                        .seed = 5}};
  for (const Case& one : {random_lattice(31, 60, 50, {6, 6}), deposit(3000, {8, 8}), lognormal,
                          lattice_in_grid(3000, {12, 1}), with_unequal_masses(random_lattice(32, 50, 40, {8, 8}), 9)}) {
    CAPTURE(one.spec.name);
    const InterfaceFamily family(build(one).parts);
    SpectrumMemory memory;
    for (const auto& [epsilon, eta] : {std::pair{0.01, infinity}, {1.0, 0.2}}) {
      const Contraction b{family.at(eta), family.at(epsilon)};
      CAPTURE(b.rows());
      CHECK(b.rows() > 800);
      CHECK(b.rows() <= 2000);
      const SpectralRadius found = spectral_radius(b, {.certify = true}, &memory);
      const SpectralRadius arpack = spectral_radius(b, {.solver = SpectralSolver::arpack}, &memory);
      const SpectralRadius dense = dense_pencil_radius(b);
      CHECK(found.solver == "shift-invert");
      CHECK(found.certified);
      for (const SpectralRadius* other : {&found, &arpack}) {
        CAPTURE(other->solver);
        REQUIRE(other->converged);
        CHECK(std::abs(other->eigenvalue_min - dense.eigenvalue_min) <= other->residual + 1e-10);
        CHECK(std::abs(other->eigenvalue_max - dense.eigenvalue_max) <= other->residual + 1e-10);
      }
    }
  }
}
