// SPDX-License-Identifier: GPL-3.0-or-later
// Where spectra are hard: many threads at once, clusters at the end, several eigenvalues, stiff contacts on
// light grains, extreme ratios of flexibilities.
#include "../support/judged_radius.hpp"
#include "../support/matrices.hpp"
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "linalg/random.hpp"
#include "linalg/threads.hpp"
#include "spectra/pencil_end.hpp"
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

SpectralOptions shift_invert(Index eigenvalues = 1, bool certify = true) {
  return {.solver = SpectralSolver::shift_invert, .eigenvalues = eigenvalues, .certify = certify};
}

std::vector<std::string> hard_rows(const Model& model, const SweepParameters& parameters) {
  std::vector<std::string> rows;
  sweep(model, parameters, [&](const SweepResult& result) {
    std::string line;
    for (const Cell& cell : row(sweep_columns(parameters), result)) line += to_text(cell) + ",";
    rows.push_back(line);
  });
  return rows;
}

// 12 x 12 disks of a lattice in each.
Case thin_strips(Index strips) {
  Case one = lattice_in_grid(1, {1, 1});
  one.spec.packing = Generator{HexagonalLattice{.columns = 12 * strips, .rows = 12, .radius = 0.5}};
  one.spec.partition = GridPartitioner{{strips, 1}};
  return one;
}

}  // namespace

TEST_CASE("elimination orders found in parallel are those found alone") {
  const SparseMatrix a = shifted_laplacian(30, 31, 0);
  const std::vector<Index> group = single_rows(a.rows());
  const double alone = SymmetricAnalysis(a, group).entries();
  for (int repetition = 0; repetition < 20; ++repetition) {
    std::vector<double> entries(12);
    for_each_in_parallel(12, [&](Index k) { entries[at(k)] = SymmetricAnalysis(a, group).entries(); });
    const bool equal = entries == std::vector<double>(12, alone);
    CHECK(equal);
  }
}

TEST_CASE("interface operators are the same bits whatever the number of threads they were made with") {
  const Model model = build(lattice_in_grid(4000, {6, 2}));
  const Vector f = RandomStream(3).normal_vector(model.parts.interface_size());
  Vector first;
  for (int repetition = 0; repetition < 10; ++repetition)
    for (const Index threads : {1, 2, 3, 4}) {
      const ThreadLimit limit(threads);
      const Vector again = InterfaceFamily(model.parts).at(0.1).apply(f);
      if (first.size() == 0) first = again;
      const bool equal = again == first;
      CHECK(equal);
    }
}

TEST_CASE("sweep table: the same bits for 1 to 4 threads") {
  const Model model = build(lattice_in_grid(1500, {4, 1}));
  const SweepParameters parameters{.epsilon = {1e-2, 0.1}, .eta = {0.5, infinity}, .spectral = shift_invert()};
  std::vector<std::string> first;
  for (const Index threads : {1, 2, 3, 4, 2, 1}) {
    CAPTURE(threads);
    const ThreadLimit limit(threads);
    const std::vector<std::string> rows = hard_rows(model, parameters);
    if (first.empty()) first = rows;
    CHECK(rows == first);
  }
}

TEST_CASE("shift-invert: several eigenvalues at each end") {
  struct Flexibilities {
    double epsilon, eta;
  };
  for (const Case& one : {random_lattice(22, 12, 10, {4, 4}), deposit(150, {4, 3}), lattice_in_grid(200, {2, 1}),
                          with_unequal_masses(random_lattice(23, 10, 9, {3, 3}), 7)}) {
    CAPTURE(one.spec.name);
    const InterfaceFamily family(build(one).parts);
    for (const auto& point :
         {Flexibilities{1e-4, infinity}, {1e-2, infinity}, {1.0, infinity}, {1e-2, 0.3}, {3.0, 0.3}}) {
      INFO("epsilon = ", point.epsilon, ", eta = ", point.eta);
      const Contraction b{family.at(point.eta), family.at(point.epsilon)};
      const DenseSpectrum dense(b);
      const Index n = dense.lambda.size();
      const SpectralRadius found = judged_radius(b, shift_invert(5, false));
      CHECK(found.converged);
      REQUIRE(found.low.size() == 5);
      REQUIRE(found.high.size() == 5);
      for (Index k = 0; k < 5; ++k) {
        CAPTURE(k);
        CHECK(std::abs(found.low[at(k)] - (1 - dense.lambda[n - 1 - k])) <= found.residual + 1e-10);
        CHECK(std::abs(found.high[at(k)] - (1 - dense.lambda[k])) <= found.residual + 1e-10);
      }
    }
  }
}

TEST_CASE("shift-invert: no copy of a multiple eigenvalue is missing in a list") {
  const Contraction b = contraction_of(lattice_in_grid(1500, {16, 1}), 100.0);
  const SpectralRadius dense = spectral_radius(b, {.solver = SpectralSolver::dense, .eigenvalues = 20});
  for (const bool certify : {false, true}) {
    const SpectralRadius found = judged_radius(b, shift_invert(20, certify));
    CHECK(found.converged);
    CHECK(found.certified == certify);
    REQUIRE(found.low.size() == 20);
    REQUIRE(found.high.size() == 20);
    for (std::size_t k = 0; k < 20; ++k) {
      CAPTURE(k);
      CHECK(std::abs(found.low[k] - dense.low[k]) <= 1e-8);
      CHECK(std::abs(found.high[k] - dense.high[k]) <= 1e-8);
    }
  }
}

TEST_CASE("rigid limit by shift-invert: eigenvalues of 8e-9 that are none of the kernel") {
  const InterfaceFamily family(build(thin_strips(96)).parts);
  const SpectralRadius found = judged_radius({family.at(infinity), family.at(0)}, shift_invert());
  CHECK(found.certified);
  CHECK(found.unit_multiplicity == 1425);  // of the dense pencil, 20 s
  CHECK(found.subdominant < 1 - 5e-9);
  CHECK(found.subdominant > 1 - 2e-8);
}

TEST_CASE("rigid limit by shift-invert: unit eigenvalues from ranks, the rest as dense") {
  for (const Case& one : {thin_strips(32), deposit(150, {4, 3}), deposit(600, {2, 2}), lattice_in_grid(200, {8, 1}),
                          lattice_in_grid(45 * 45, {2, 1}), lattice_in_grid(400, {4, 4})}) {
    CAPTURE(one.spec.name);
    const Contraction b = contraction_of(one, 0);
    const SpectralRadius found = judged_radius(b, shift_invert());
    const SpectralRadius dense = dense_pencil_radius(b);
    CHECK(found.unit_multiplicity == dense.unit_multiplicity);
    CHECK(found.converged);
    CHECK(found.certified);
    CHECK(std::abs(found.subdominant - dense.subdominant) <= found.residual + 1e-10);
    CHECK(std::abs(found.subdominant_min - dense.subdominant_min) <= found.residual + 1e-10);
  }
}

TEST_CASE("certificates: a cluster at lambda = 1, stiff contacts and light grains") {
  const Contraction b = contraction_of(with_unequal_masses(deposit(200, {5, 4}), 8), 1e-6);
  const DenseSpectrum dense(b);
  const SpectralRadius found = judged_radius(b, shift_invert());
  // Beside K/epsilon the lightest masses keep few digits: what that is worth is in the residual.
  REQUIRE(found.low.size() > 0);
  CHECK(std::abs(found.high[0] - (1 - dense.lambda[0])) <= found.residual);
  CHECK(std::abs(found.low[0] - (1 - dense.lambda[dense.lambda.size() - 1])) <= found.residual);
  // 8 eigenvalues are 1, the next is 0.99985: no count between the two may be another
  if (found.certified) CHECK(found.within_min == dense.between(1 - found.interval_min[1], infinity));
  const ShiftedPencilFamily pencils(b);
  for (const double distance : {1e-5, 1e-6, 1e-7}) {  // nearer, the lost digits decide
    CAPTURE(distance);
    const ShiftedPencil pencil = pencils.at(1e-6, infinity, 1 - distance);
    if (pencil.reliable()) CHECK(pencil.below() == dense.below(1 - distance));
  }
}

TEST_CASE("certificates: a shift that must be moved stays on its side of the end") {
  const Contraction b = contraction_of(deposit(80, {3, 2}), 1e-3, 0.4);
  const PencilEnd found = find_end(ShiftedPencilFamily(b), b.preconditioner, {1e-3, 0.4}, SpectrumEnd::largest, {}, {},
                                   {.tolerance = 4e-10, .certify = true});
  REQUIRE(found.converged);
  CHECK(found.outside > found.values[0]);
  CHECK(found.inside < found.values[0]);
  CHECK(found.certified);
  CHECK(found.within == 4);
}

TEST_CASE("certificates of the dense solver count every copy of a multiple eigenvalue") {
  for (const Case& one : packings_up_to(200)) {
    if (one.spec.name.find("twice") == std::string::npos) continue;
    const Contraction b = contraction_of(one, 0.1);
    for (const SpectralSolver solver : {SpectralSolver::shift_invert, SpectralSolver::dense}) {
      CAPTURE(to_string(solver));
      const SpectralRadius found = spectral_radius(b, {.solver = solver, .certify = true});
      CHECK(found.certified);
      CHECK(found.within_max == 2);
    }
  }
}

TEST_CASE("fifteen near-copies next to a bound known beforehand are told apart from it") {
  Case one;
  one.spec.packing = Generator{HexagonalLattice{.columns = 40, .rows = 40, .radius = 0.5}};
  one.spec.partition = GridPartitioner{{16, 1}};
  one.spec.masses = {.model = MassModel::density, .density = 2500};  // 1 963 kg each: eigenvalues of B are near 0
  const InterfaceFamily family(build(one).parts);
  for (const double epsilon : {1.0, 10.0}) {
    CAPTURE(epsilon);
    const Contraction b{family.at(infinity), family.at(epsilon)};
    const SpectralRadius found = judged_radius(b, shift_invert());
    const SpectralRadius dense = dense_pencil_radius(b);
    CHECK(found.converged);
    CHECK(found.certified);
    CHECK(std::abs(found.subdominant_min - dense.subdominant_min) <= found.residual);
    CHECK(std::abs(found.subdominant_max - dense.subdominant_max) <= found.residual);
  }
}

TEST_CASE("certified intervals of the dense solver hold the eigenvalues of the exact matrices") {
  Case one = lattice_in_grid(1, {1, 1});
  one.spec.packing = Generator{HexagonalLattice{.columns = 7, .rows = 6, .radius = 0.5}};
  one.spec.partition = GridPartitioner{{2, 1}};
  const InterfaceFamily family(build(one).parts);
  const auto certified = [&](double epsilon, double eta) {
    return spectral_radius({family.at(eta), family.at(epsilon)}, {.solver = SpectralSolver::dense, .certify = true});
  };
  const auto inside = [](const auto& interval, double value) {
    return interval.front() <= value && value <= interval.back();
  };
  // by arithmetic of 40 digits
  CHECK(inside(certified(1, 1e-3).interval_min, -653.53970838783784));
  CHECK(inside(certified(1, 1e-5).interval_min, -65411.992212446257));
  CHECK(inside(certified(1e-5, 1e-3).interval_max, 0.98999391928763780));
}

TEST_CASE("backward error: a solution that is not finite is not exact") {
  const SymmetricProblem problem = saddle_point(10, 0.5, 0.7, 1);
  const Vector b = Vector::Ones(problem.lower.rows());
  CHECK_FALSE(backward_error(problem.lower, Vector::Constant(b.size(), not_a_number), b) < 1);
  CHECK_FALSE(backward_error(problem.lower, Vector::Constant(b.size(), infinity), b) < 1);
}

TEST_CASE("equal flexibilities leave no error in a sweep, whichever the solver") {
  const Model model = build(random_lattice(21, 9, 8, {3, 2}));
  SweepParameters parameters{.epsilon = {0.3}, .eta = {0.3}};
  for (const SpectralSolver solver : {SpectralSolver::dense, SpectralSolver::shift_invert}) {
    parameters.spectral.solver = solver;
    CHECK(sweep(model, parameters, [](const SweepResult& result) { CHECK(result.radius.value < 1e-12); }) == 0);
  }
  // as many zeros as asked for
  const InterfaceFamily family(model.parts);
  const SpectralRadius none = judged_radius({family.at(0.3), family.at(0.3)}, shift_invert(5));
  CHECK(none.low == std::vector<double>(5, 0.0));
  CHECK(none.high == std::vector<double>(5, 0.0));
}

TEST_CASE("tolerance is relative to a large radius") {
  const InterfaceFamily family(build(random_lattice(21, 9, 8, {3, 2})).parts);
  for (const double eta : {1e-1, 1e-3, 1e-5}) {
    CAPTURE(eta);
    const Contraction b{family.at(eta), family.at(100.0)};
    const SpectralRadius dense = dense_pencil_radius(b);
    const SpectralRadius found = judged_radius(b, shift_invert());
    CHECK(dense.converged);
    CHECK(found.converged);
    CHECK(found.certified);
    CHECK(found.value == doctest::Approx(dense.value).epsilon(1e-8));
    CHECK(found.factorisations < 40);
  }
}
