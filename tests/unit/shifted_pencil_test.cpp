// SPDX-License-Identifier: GPL-3.0-or-later
// The shifted pencil against dense algebra: eigenvalue counts by inertia, and solves.
#include "ddm/shifted_pencil.hpp"

#include "../support/problems.hpp"
#include "../support/sanitized.hpp"
#include "../support/spectra.hpp"
#include "linalg/random.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Shifts between, below and above the eigenvalues, none nearer to one than 1e-6 of itself.
std::vector<double> shifts_for(const Vector& lambda, Index wanted, std::uint64_t seed) {
  const Index n = lambda.size();
  std::vector<double> shifts{2 * lambda[n - 1], 1.01 * lambda[n - 1]};
  if (lambda[0] > 1e-12) shifts.insert(shifts.end(), {0.5 * lambda[0], 0.99 * lambda[0]});
  RandomStream random(seed);
  for (Index k = 0; k < wanted; ++k) {
    const Index i = random.below(n - 1);
    const double from = std::max(lambda[i], 1e-12), to = lambda[i + 1];
    if (to > from * (1 + 1e-5)) shifts.push_back(from * std::pow(to / from, 0.2 + 0.6 * random.uniform()));
  }
  return shifts;
}

void check_pencil(const ShiftedPencil& pencil, const DenseSpectrum& dense, double sigma) {
  CAPTURE(sigma);
  REQUIRE(pencil.reliable());
  CHECK(pencil.shift() == sigma);
  CHECK(pencil.below() == dense.below(sigma));
  const Vector g = RandomStream(11).normal_vector(dense.lambda.size());
  const Vector x = pencil.solve(g);
  // (S - sigma P) x = g with an error relative to the size of what is summed
  const Vector y = dense.root.cwiseInverse().cwiseProduct(x);
  const Vector error = (dense.s - sigma * dense.p) * y - dense.root.cwiseProduct(g);
  CHECK(error.norm() <
        1e-8 * (dense.root.cwiseProduct(g).norm() + (dense.s.norm() + sigma * dense.p.norm()) * y.norm()));
}

// Counts and solves for flexibilities of every order, with contacts restricted in S where `active` says so.
void check_family(const Model& model, const std::vector<char>& active, Index shifts) {
  const InterfaceFamily stage_two(model.parts);
  const InterfaceFamily stage_one =
      active.empty() ? stage_two : InterfaceFamily(restrict_contacts(model.parts, active));
  const Contraction generic{stage_two.at(infinity), stage_one.at(1.0)};
  const Contraction enriched{stage_two.at(1.0), stage_one.at(1.0)};
  const ShiftedPencilFamily for_generic(generic), for_enriched(enriched);
  CHECK(for_generic.serves(generic));
  CHECK_FALSE(for_generic.serves(enriched));
  CHECK_FALSE(for_enriched.serves(generic));
  CHECK(for_enriched.serves({stage_two.at(0.2), stage_one.at(7.0)}));
  for (const double epsilon : watched<double>({1e-4, 1e-2, 1.0, 30.0}))
    for (const double eta : watched<double>({infinity, 1e-2, 0.9, 1.1, 40.0})) {
      INFO("epsilon = ", epsilon, ", eta = ", eta);
      const DenseSpectrum dense({stage_two.at(eta), stage_one.at(epsilon)});
      const ShiftedPencilFamily& family = std::isinf(eta) ? for_generic : for_enriched;
      for (const double sigma : shifts_for(dense.lambda, shifts, 5))
        check_pencil(family.at(epsilon, eta, sigma), dense, sigma);
    }
}

std::vector<char> random_choice(const Model& model, double kept, std::uint64_t seed) {
  RandomStream random(seed);
  std::vector<char> active(at(model.problem.contacts()));
  for (char& flag : active) flag = random.uniform() < kept;
  return active;
}

}  // namespace

TEST_CASE("shifted pencil: counts and solves on every small packing") {
  for (const Case& one : watched(every_problem())) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    if (model.parts.interface_size() < 2) continue;
    check_family(model, {}, 4);
  }
}

TEST_CASE("shifted pencil: counts and solves on deposits, METIS parts, unequal masses") {
  Case metis = random_lattice(25, 8, 7, {1, 1});
  metis.spec.partition = MetisPartitioner{.metis = 6, .seed = 1};
  bool crossed = false;
  for (const Case& one :
       {deposit(60, {3, 2}), deposit(80, {1, 1}, 5), metis, with_unequal_masses(random_lattice(23, 7, 6, {3, 2}), 7)}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    REQUIRE(model.parts.interface_size() > 4);
    crossed = crossed || cross_points(model.parts) > 0;
    check_family(model, {}, 3);
  }
  CHECK(crossed);
}

TEST_CASE("shifted pencil: contacts restricted in S only") {
  for (const Case& one : {strip(12), random_lattice(2, 8, 6, {3, 2}), deposit(60, {3, 2})}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    for (const double kept : {0.0, 0.5, 0.9}) check_family(model, random_choice(model, kept, 9), 3);
  }
}

TEST_CASE("shifted pencil: other gluing rows give the same counts") {
  const Case one = random_lattice(3, 8, 9, {3, 3});
  const Model model = build(one);
  REQUIRE(cross_points(model.parts) > 0);
  const Decomposition star = decompose(model.problem, model.partition, GluingShape::star);
  const InterfaceFamily chain_family(model.parts), star_family(star);
  for (const double eta : {0.3, infinity}) {
    const Contraction chained{chain_family.at(eta), chain_family.at(0.1)};
    const ShiftedPencilFamily a(chained), b({star_family.at(eta), star_family.at(0.1)});
    const DenseSpectrum dense(chained);
    for (const double sigma : shifts_for(dense.lambda, 8, 3)) {
      CHECK(a.at(0.1, eta, sigma).below() == dense.below(sigma));
      CHECK(b.at(0.1, eta, sigma).below() == dense.below(sigma));
    }
  }
}

TEST_CASE("shifted pencil: a shift on an eigenvalue is unreliable or counts it on one side") {
  const Model model = build(random_lattice(2, 8, 6, {3, 2}));
  const InterfaceFamily family(model.parts);
  for (const double eta : {0.3, infinity}) {
    const Contraction b{family.at(eta), family.at(0.1)};
    const DenseSpectrum dense(b);
    const ShiftedPencilFamily pencils(b);
    for (const Index k : {Index{0}, dense.lambda.size() / 2, dense.lambda.size() - 1}) {
      const double lambda = dense.lambda[k];
      const ShiftedPencil on = pencils.at(0.1, eta, lambda);
      if (!on.reliable()) continue;
      CHECK(on.below() >= dense.below(lambda * (1 - 1e-9)));
      CHECK(on.below() <= dense.below(lambda * (1 + 1e-9)));
    }
  }
}
