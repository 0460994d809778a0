// SPDX-License-Identifier: GPL-3.0-or-later
// Shift-invert against all eigenvalues of the dense pencil: ends, certificates, multiplicities.
#include "../support/judged_radius.hpp"
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "../support/thorough.hpp"
#include "linalg/random.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <optional>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

constexpr double tolerance = 1e-8;

SpectralOptions by_shift_invert(Index eigenvalues = 1, bool certify = true) {
  return {
      .solver = SpectralSolver::shift_invert, .tolerance = tolerance, .eigenvalues = eigenvalues, .certify = certify};
}

// What no residual can see: rounding of the dense answer and of 1 - lambda, and that of solves with M +
// K/epsilon, whose condition grows like 1/epsilon.
double rounding(const DenseSpectrum& dense, double epsilon) {
  return 1e-11 * std::max(1.0, dense.lambda[dense.lambda.size() - 1]) + 1e-15 / epsilon;
}

// Eigenvalues from `lambda` outwards, if no eigenvalue is so near to it that rounding decides.
std::optional<Index> countable(const DenseSpectrum& dense, double from, double to, double slack) {
  for (const double border : {from, to})
    if (std::isfinite(border) && (dense.lambda.array() - border).abs().minCoeff() < slack) return std::nullopt;
  return dense.between(from, to);
}

// Ends, certificate and multiplicities of what was found. Returns whether the counts could be compared.
bool check_radius(const SpectralRadius& found, const Contraction& b) {
  const DenseSpectrum dense(b);
  const Index n = dense.lambda.size();
  const double omega = b.relaxation;
  const double low = 1 - omega * dense.lambda[n - 1], high = 1 - omega * dense.lambda[0];
  const double slack = omega * rounding(dense, b.system.flexibility());
  INFO("found.residual = ", found.residual, ", found.value = ", found.value,
       ", found.factorisations = ", found.factorisations);
  REQUIRE(found.converged);
  CHECK(found.solver == "shift-invert");
  CHECK(found.unit_multiplicity == 0);
  const double value = std::max(std::abs(low), std::abs(high));
  CHECK(found.residual <= tolerance * std::max(1.0, value));
  CHECK(std::abs(found.eigenvalue_min - low) <= found.residual + slack);
  CHECK(std::abs(found.eigenvalue_max - high) <= found.residual + slack);
  CHECK(std::abs(found.value - value) <= found.residual + slack);
  CHECK(found.subdominant == found.value);
  CHECK(found.factorisations > 0);
  REQUIRE(found.certified);
  CHECK(found.interval_min[0] <= low + slack);
  CHECK(low <= found.interval_min[1] + slack);
  CHECK(found.interval_max[0] <= high + slack);
  CHECK(high <= found.interval_max[1] + slack);
  const double lambda_from = (1 - found.interval_min[1]) / omega, lambda_to = (1 - found.interval_max[0]) / omega;
  const auto at_low = countable(dense, lambda_from, infinity, slack / omega);
  const auto at_high = countable(dense, -infinity, lambda_to, slack / omega);
  if (at_low) CHECK(found.within_min == *at_low);
  if (at_high) CHECK(found.within_max == *at_high);
  return at_low && at_high;
}

struct Flexibilities {
  double epsilon, eta;
};

const std::vector<Flexibilities>& every_pair() {
  static const std::vector<Flexibilities> pairs{{1e-6, infinity}, {1e-4, infinity}, {1e-2, infinity},
                                                {1.0, infinity},  {1e2, infinity},  {1e-4, 1e-2},
                                                {1e-2, 1.0},      {1.0, 30.0},                   // eta > epsilon
                                                {1e-2, 1e-3},     {1.0, 0.1},       {1e2, 5.0},  // eta < epsilon
                                                {0.1, 0.1001},    {1.0, 0.999}};                 // near
  return pairs;
}

}  // namespace

TEST_CASE("shift-invert: ends, certificates and multiplicities of every packing") {
  int counted = 0, compared = 0;
  for (const Case& one : packings_up_to(thorough() ? 800 : 500)) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const InterfaceFamily family(model.parts);
    CAPTURE(model.parts.interface_size());
    for (const auto& point : every_pair()) {
      // K / epsilon against the lightest grain takes all digits beyond
      if (point.epsilon < 1e-4 && one.spec.name.find("unequal") != std::string::npos) continue;
      INFO("epsilon = ", point.epsilon, ", eta = ", point.eta);
      const Contraction b{family.at(point.eta), family.at(point.epsilon)};
      counted += check_radius(judged_radius(b, by_shift_invert()), b);
      ++compared;
    }
  }
  CHECK(compared > 100);
  CHECK(counted > 0.9 * compared);
}

TEST_CASE("shift-invert: a list has both copies of every double eigenvalue") {
  int lists = 0;
  for (const Case& one : packings_up_to(400)) {
    if (one.spec.name.find("twice") == std::string::npos) continue;
    const InterfaceFamily family(build(one).parts);
    for (const auto& point : {Flexibilities{1e-2, infinity}, {1.0, infinity}, {1.0, 0.1}})
      for (const Index wanted : {3, 4, 7}) {
        INFO("epsilon = ", point.epsilon, ", eta = ", point.eta, ", wanted = ", wanted);
        const Contraction b{family.at(point.eta), family.at(point.epsilon)};
        const DenseSpectrum dense(b);
        const Index n = dense.lambda.size();
        const SpectralRadius found = judged_radius(b, by_shift_invert(wanted, false));
        REQUIRE(found.converged);
        REQUIRE(count(found.low) == wanted);
        REQUIRE(count(found.high) == wanted);
        const double slack = found.residual + rounding(dense, point.epsilon);
        for (Index k = 0; k < wanted; ++k) {
          CHECK(std::abs(found.low[at(k)] - (1 - dense.lambda[n - 1 - k])) <= slack);
          CHECK(std::abs(found.high[at(k)] - (1 - dense.lambda[k])) <= slack);
        }
        ++lists;
      }
  }
  CHECK(lists > 0);
}

TEST_CASE("shift-invert: contacts restricted in Stage 1") {
  for (const Case& one : {random_lattice(21, 9, 8, {3, 2}), deposit(150, {4, 3}), lattice_in_grid(200, {4, 1}),
                          random_fcc(21, 5, 5, 4, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    RandomStream random(4);
    std::vector<char> active(at(model.problem.contacts()));
    for (char& flag : active) flag = random.uniform() < 0.6;
    const InterfaceFamily all(model.parts), some(restrict_contacts(model.parts, active));
    for (const auto& point : every_pair()) {
      INFO("epsilon = ", point.epsilon, ", eta = ", point.eta);
      const Contraction b{all.at(point.eta), some.at(point.epsilon)};
      check_radius(judged_radius(b, by_shift_invert()), b);
    }
  }
}

TEST_CASE("shift-invert: relaxation, given or applied afterwards") {
  const InterfaceFamily family(build(random_lattice(22, 12, 10, {4, 4})).parts);
  for (const auto& [epsilon, eta] : {Flexibilities{0.1, infinity}, {0.5, 0.1}, {0.5, 2.0}})
    for (const double omega : {0.1, 0.7, 1.3, 1.9, 5.0}) {
      CAPTURE(omega);
      const Contraction b{family.at(eta), family.at(epsilon), omega};
      const SpectralRadius direct = judged_radius(b, by_shift_invert());
      check_radius(direct, b);
      Contraction plain = b;
      plain.relaxation = 1;
      const SpectralRadius after = relaxed(judged_radius(plain, by_shift_invert()), omega, tolerance);
      CHECK(after.value == direct.value);
      CHECK(after.low == direct.low);
      CHECK(after.high == direct.high);
      CHECK(after.interval_min == direct.interval_min);
      CHECK(after.interval_max == direct.interval_max);
      const SpectralRadius dense = dense_pencil_radius(b);
      CHECK(std::abs(dense.value - direct.value) <= direct.residual + 1e-11);
      CHECK(std::abs(dense.eigenvalue_min - direct.eigenvalue_min) <= direct.residual + 1e-11);
      CHECK(std::abs(dense.eigenvalue_max - direct.eigenvalue_max) <= direct.residual + 1e-11);
    }
}

TEST_CASE("shift-invert: modes are eigenvectors") {
  const InterfaceFamily family(build(random_lattice(21, 9, 8, {3, 2})).parts);
  for (const double eta : {0.3, infinity}) {
    const Contraction b{family.at(eta), family.at(0.05)};
    const SpectralRadius found = judged_radius(b, by_shift_invert());
    for (const auto& [mode, mu] :
         {std::pair{found.mode_min, found.eigenvalue_min}, {found.mode_max, found.eigenvalue_max}}) {
      REQUIRE(mode.size() == b.rows());
      CHECK((b.apply(mode) - mu * mode).norm() < 1e-5 * mode.norm());
    }
  }
}

TEST_CASE("shift-invert: equal flexibilities leave no error") {
  const Model model = build(random_lattice(21, 9, 8, {3, 2}));
  const InterfaceFamily family(model.parts);
  const SpectralRadius none = judged_radius({family.at(0.3), family.at(0.3)}, by_shift_invert());
  CHECK(none.value == 0);
  CHECK(none.converged);
  CHECK(none.certified);
  CHECK(none.within_max == model.parts.interface_size());
}

TEST_CASE("shift-invert: few interface unknowns") {
  for (const Index grains : {4, 6, 8}) {
    const InterfaceFamily family(build(strip(grains)).parts);
    const Contraction b{family.at(infinity), family.at(0.2)};
    const SpectralRadius found = judged_radius(b, by_shift_invert());
    CHECK(std::abs(found.value - (1 - DenseSpectrum(b).lambda[0])) < 1e-8);
    CHECK(found.converged);
  }
}
