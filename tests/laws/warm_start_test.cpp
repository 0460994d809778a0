// SPDX-License-Identifier: GPL-3.0-or-later
// Sweeps that pass ends and vectors from point to point: no result depends on them, or on the row a table starts from.
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "spectra/spectrum_memory.hpp"
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

const SpectralOptions certified_shift_invert{.solver = SpectralSolver::shift_invert, .certify = true};

struct EpsilonEta {
  double epsilon, eta;
};

// A line along epsilon, a line along eta, a grid, jumps forth and back, a point twice, generic and enriched mixed.
std::vector<std::vector<EpsilonEta>> every_path() {
  std::vector<EpsilonEta> along_epsilon, along_eta, grid;
  for (double exponent = -4; exponent <= 2; exponent += 0.5)
    along_epsilon.push_back({std::pow(10, exponent), infinity});
  for (double exponent = -2; exponent <= 2; exponent += 0.4) along_eta.push_back({0.1, 1.03 * std::pow(10, exponent)});
  for (const double epsilon : {1e-3, 1e-2, 0.1})
    for (const double eta : {0.05, 0.5, 5.0, 50.0}) grid.push_back({epsilon, eta});
  const std::vector<EpsilonEta> jumps{{1e-4, infinity},   {1e2, infinity}, {1e-4, infinity}, {1e-4, infinity},
                                      {1.0, infinity},    {1.0, 0.3},      {1e-3, 0.3},      {10.0, 0.3},
                                      {10.0, 40.0},       {10.0, 0.01},    {1e-3, infinity}, {1.1e-3, infinity},
                                      {1.2e-3, infinity}, {90.0, infinity}};
  return {along_epsilon, {along_epsilon.rbegin(), along_epsilon.rend()}, along_eta, grid, jumps};
}

std::vector<std::string> rows_of(const Model& model, const SweepParameters& parameters, Index first = 0) {
  std::vector<std::string> rows;
  sweep(
      model, parameters,
      [&](const SweepResult& result) {
        std::string line;
        for (const Cell& cell : row(sweep_columns(parameters), result)) line += to_text(cell) + ",";
        rows.push_back(line);
      },
      {}, first);
  return rows;
}

SweepParameters two_way_sweep() {
  return {.epsilon = {1, 1e-3, 1e-2, 0.1, 1, 10},
          .eta = {0.02, 0.5, infinity},
          .relaxation = {1.0, std::nullopt},
          .spectral = certified_shift_invert};
}

}  // namespace

TEST_CASE("warm starts agree with cold ones within their residuals, whatever the path") {
  bool certified_before = false;
  for (const Case& one : {random_lattice(21, 9, 8, {3, 2}), deposit(150, {4, 3}), lattice_in_grid(300, {6, 1}),
                          random_fcc(21, 5, 5, 4, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const InterfaceFamily family(build(one).parts);
    for (const std::vector<EpsilonEta>& path : every_path()) {
      const bool certify = !certified_before;
      certified_before = certify;
      SpectrumMemory memory, matrix_free_memory;
      for (const auto& point : path) {
        INFO("epsilon = ", point.epsilon, ", eta = ", point.eta);
        const Contraction b{family.at(point.eta), family.at(point.epsilon)};
        const SpectralRadius warm =
            spectral_radius(b, {.solver = SpectralSolver::shift_invert, .certify = certify}, &memory);
        const SpectralRadius matrix_free = spectral_radius(b, {.solver = SpectralSolver::arpack}, &matrix_free_memory);
        const SpectralRadius cold = spectral_radius(b, certified_shift_invert);
        REQUIRE(warm.converged);
        REQUIRE(cold.converged);
        CHECK(warm.certified == certify);
        const double slack = warm.residual + cold.residual + 1e-15 / point.epsilon + 1e-12 * std::max(1.0, cold.value);
        CHECK(std::abs(warm.value - cold.value) <= slack);
        CHECK(std::abs(warm.eigenvalue_min - cold.eigenvalue_min) <= slack);
        CHECK(std::abs(warm.eigenvalue_max - cold.eigenvalue_max) <= slack);
        REQUIRE(matrix_free.converged);
        const double slack_free = slack + matrix_free.residual;
        CHECK(std::abs(matrix_free.eigenvalue_min - cold.eigenvalue_min) <= slack_free);
        CHECK(std::abs(matrix_free.eigenvalue_max - cold.eigenvalue_max) <= slack_free);
        REQUIRE(memory.flexible.visited.size() >= 1);
        CHECK(memory.flexible.visited.size() <= 2);
        CHECK(memory.flexible.visited.back().epsilon == point.epsilon);
        CHECK(memory.flexible.visited.back().eta == point.eta);
      }
    }
  }
}

TEST_CASE("slopes of the ends are those of the dense spectra on both sides") {
  // Simple ends: where two modes meet there is a slope for each.
  const InterfaceFamily family(build(deposit(150, {2, 2})).parts);
  const auto dense = [&](double epsilon, double eta) {
    return spectral_radius({family.at(eta), family.at(epsilon)}, {.solver = SpectralSolver::dense, .tolerance = 1e-12});
  };
  const double step = 1e-3;
  for (const auto& point :
       std::vector<EpsilonEta>{{0.03, infinity}, {2.0, infinity}, {0.03, 0.4}, {2.0, 0.4}, {0.2, 8.0}}) {
    INFO("epsilon = ", point.epsilon, ", eta = ", point.eta);
    SpectrumMemory memory;
    spectral_radius({family.at(point.eta), family.at(point.epsilon)}, certified_shift_invert, &memory);
    const PencilMemory::Visited& met = memory.flexible.visited.back();
    const auto check = [&](const SpectralRadius& before, const SpectralRadius& after, double smallest, double largest) {
      const double rounding = 1e-11 / step;
      CHECK(std::abs((before.eigenvalue_max - after.eigenvalue_max) / (2 * step) - smallest) <
            1e-4 * std::abs(smallest) + rounding);
      CHECK(std::abs((before.eigenvalue_min - after.eigenvalue_min) / (2 * step) - largest) <
            1e-4 * std::abs(largest) + rounding);
    };
    check(dense(point.epsilon * std::exp(-step), point.eta), dense(point.epsilon * std::exp(step), point.eta),
          met.smallest.slope_epsilon, met.largest.slope_epsilon);
    if (std::isfinite(point.eta))
      check(dense(point.epsilon, point.eta * std::exp(-step)), dense(point.epsilon, point.eta * std::exp(step)),
            met.smallest.slope_eta, met.largest.slope_eta);
  }
}

TEST_CASE("ARPACK warm-started agrees with ARPACK from its fixed vector, with less work along a fine sweep") {
  Index warm_products = 0, cold_products = 0;
  for (const Case& one : {random_lattice(21, 9, 8, {3, 2}), deposit(150, {4, 3}), lattice_in_grid(300, {6, 1})}) {
    CAPTURE(one.spec.name);
    const InterfaceFamily family(build(one).parts);
    SpectrumMemory memory;
    for (double exponent = -2; exponent <= 1; exponent += 0.1) {
      const Contraction b{family.at(infinity), family.at(std::pow(10, exponent))};
      const SpectralRadius warm = spectral_radius(b, {.solver = SpectralSolver::arpack}, &memory);
      const SpectralRadius cold = spectral_radius(b, {.solver = SpectralSolver::arpack});
      REQUIRE(warm.converged);
      REQUIRE(cold.converged);
      const double slack = warm.residual + cold.residual + 1e-12;
      CHECK(std::abs(warm.eigenvalue_min - cold.eigenvalue_min) <= slack);
      CHECK(std::abs(warm.eigenvalue_max - cold.eigenvalue_max) <= slack);
      warm_products += warm.applications;
      cold_products += cold.applications;
    }
  }
  CHECK(warm_products < 0.95 * static_cast<double>(cold_products));
}

TEST_CASE("ARPACK: an end that was not found leaves the start of the next point as it was") {
  const InterfaceFamily family(build(deposit(150, {4, 3})).parts);
  const auto at = [&](double epsilon) { return Contraction{family.at(infinity), family.at(epsilon)}; };
  const SpectralOptions options{.solver = SpectralSolver::arpack};
  SpectralOptions hopeless = options;  // one restart of few vectors
  hopeless.arpack.basis = 5;
  hopeless.arpack.maximum_restarts = 1;
  SpectrumMemory memory;
  REQUIRE(spectral_radius(at(0.1), options, &memory).converged);
  const Vector smallest = memory.smallest, largest = memory.largest;
  REQUIRE(smallest.size() == family.at(0.1).rows());
  REQUIRE(!spectral_radius(at(10.0), hopeless, &memory).converged);
  REQUIRE(memory.smallest.size() == smallest.size());
  REQUIRE(memory.largest.size() == largest.size());
  // What failed is as if it had not been tried.
  CHECK(memory.smallest == smallest);
  CHECK(memory.largest == largest);
  SpectrumMemory straight;
  straight.smallest = smallest;
  straight.largest = largest;
  const SpectralRadius after = spectral_radius(at(0.11), options, &memory);
  const SpectralRadius expected = spectral_radius(at(0.11), options, &straight);
  CHECK(after.applications == expected.applications);
  CHECK(after.value == expected.value);
}

TEST_CASE("warm starts are not caught by a mode that is no longer the end, certified or not") {
  // The order of two modes changes between 0.158 and 0.252: the vector of the one is no way to the other.
  Case one = lattice_in_grid(10000, {1, 1});
  one.spec.partition = MetisPartitioner{.metis = 16};
  const InterfaceFamily family(build(one).parts);
  SpectrumMemory memory, matrix_free_memory;
  for (const double exponent : {0.0, 1.0, 2.0, 3.0, 4.0}) {
    const double epsilon = 0.04 * std::pow(25.0, exponent / 7);
    CAPTURE(epsilon);
    const Contraction b{family.at(infinity), family.at(epsilon)};
    const SpectralRadius warm = spectral_radius(b, {.solver = SpectralSolver::shift_invert}, &memory);
    const SpectralRadius proved = spectral_radius(b, certified_shift_invert);
    CHECK(warm.converged);
    REQUIRE(proved.certified);
    CHECK(std::abs(warm.value - proved.value) <= warm.residual + proved.residual);
    const SpectralRadius matrix_free = spectral_radius(b, {.solver = SpectralSolver::arpack}, &matrix_free_memory);
    CHECK(matrix_free.converged);
    CHECK(std::abs(matrix_free.value - proved.value) <= matrix_free.residual + proved.residual);
  }
}

TEST_CASE("warm starts save work along a fine sweep") {
  const InterfaceFamily family(build(lattice_in_grid(400, {8, 1})).parts);
  SpectrumMemory memory;
  Index warm = 0, cold = 0;
  for (double exponent = -2; exponent <= 0; exponent += 0.1) {
    const Contraction b{family.at(infinity), family.at(std::pow(10, exponent))};
    warm += spectral_radius(b, {.solver = SpectralSolver::shift_invert}, &memory).factorisations;
    cold += spectral_radius(b, {.solver = SpectralSolver::shift_invert}).factorisations;
  }
  CHECK(warm < 0.85 * static_cast<double>(cold));  // two of each end are its proof
}

TEST_CASE("a memory used for another packing, or another set of contacts, is not believed") {
  SpectrumMemory memory;
  for (const Case& one : {random_lattice(21, 9, 8, {3, 2}), deposit(150, {4, 3}),
                          random_fcc(22, 5, 5, 4, GridPartitioner{{2, 2, 2}}), random_lattice(22, 9, 8, {3, 2})}) {
    const Model model = build(one);
    const InterfaceFamily all(model.parts);
    std::vector<char> active(at(model.problem.contacts()), 1);
    for (std::size_t k = 0; k < active.size(); k += 3) active[k] = 0;
    const InterfaceFamily some(restrict_contacts(model.parts, active));
    for (char& flag : active) flag = !flag;
    const InterfaceFamily other(restrict_contacts(model.parts, active));
    const auto enriched = 0.03;
    struct Pair {
      const InterfaceFamily &preconditioner, &system;
      double eta;
    };
    // The last two: contacts of S that P does not have.
    for (const auto& [preconditioner, system, eta] :
         {Pair{all, all, infinity}, Pair{all, some, infinity}, Pair{all, some, enriched}, Pair{all, all, infinity},
          Pair{some, all, enriched}, Pair{some, other, enriched}})
      for (const double epsilon : {0.01, 0.02, 0.04, 100.0}) {
        const Contraction b{preconditioner.at(eta), system.at(epsilon)};
        const SpectralRadius found = spectral_radius(b, certified_shift_invert, &memory);
        const SpectralRadius dense = dense_pencil_radius(b);
        CAPTURE(epsilon);
        REQUIRE(found.converged);
        CHECK(std::abs(found.value - dense.value) <= found.residual + 1e-11);
      }
  }
}

TEST_CASE("sweep table: the same bits from whichever row it starts") {
  const Model plane = build(random_lattice(21, 9, 8, {3, 2}));
  const Model space = build(random_fcc(21, 4, 4, 4, GridPartitioner{{2, 2, 2}}));
  for (const auto& [chosen, solver] : {std::pair{&plane, SpectralSolver::shift_invert},
                                       {&plane, SpectralSolver::arpack},
                                       {&space, SpectralSolver::shift_invert}}) {
    const Model& model = *chosen;
    SweepParameters parameters = two_way_sweep();
    parameters.spectral.solver = solver;
    parameters.spectral.certify = solver == SpectralSolver::shift_invert;
    const std::vector<std::string> all = rows_of(model, parameters);
    REQUIRE(count(all) == point_count(parameters));
    for (const Index first : {1, 2, 5, 14, 15, 16, 17, 18, 31, 32, 35, 36}) {
      CAPTURE(first);
      CHECK(rows_of(model, parameters, first) == std::vector<std::string>(all.begin() + first, all.end()));
    }
  }
}

TEST_CASE("sweep table: the same bits with inexact rows in between, and with restricted contacts") {
  Case one = random_lattice(21, 9, 8, {3, 2});
  one.spec.prescribed = {{0, {1.0, 0.5}}};
  const Model model = build(one);
  const SweepParameters parameters{.epsilon = {1e-2, 3e-2, 1e-1, 0.3, 1.0},
                                   .eta = {0.5, 0.7, infinity},
                                   .gauss_seidel_sweeps = {2, std::nullopt},
                                   .contacts = ContactSet::active,
                                   .spectral = {.solver = SpectralSolver::shift_invert}};
  const std::vector<std::string> all = rows_of(model, parameters);
  for (const Index first : {1, 2, 7, 15, 16, 17, 18, 29})
    CHECK(rows_of(model, parameters, first) == std::vector<std::string>(all.begin() + first, all.end()));
}

TEST_CASE("sweep table: automatic, dense and shift-invert agree in every row") {
  const Model model = build(deposit(150, {4, 3}));
  SweepParameters parameters = two_way_sweep();
  std::vector<double> radii;
  const auto collect = [&](SpectralSolver solver) {
    parameters.spectral.solver = solver;
    radii.clear();
    CHECK(sweep(model, parameters, [&](const SweepResult& result) { radii.push_back(result.radius.value); }) == 0);
    return radii;
  };
  const std::vector<double> dense = collect(SpectralSolver::dense), automatic = collect(SpectralSolver::automatic),
                            shifted = collect(SpectralSolver::shift_invert);
  CHECK(automatic == dense);
  REQUIRE(shifted.size() == dense.size());
  for (std::size_t k = 0; k < dense.size(); ++k)
    CHECK(std::abs(shifted[k] - dense[k]) <= 1e-8 * std::max(1.0, dense[k]));
}
