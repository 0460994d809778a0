// SPDX-License-Identifier: GPL-3.0-or-later
// What must not change a spectrum: where the packing lies, how things are numbered, how copies are glued.
#include "../support/matrices.hpp"
#include "../support/problems.hpp"
#include "linalg/random.hpp"
#include "mechanics/active_set.hpp"
#include <nscdd/spectra/spectral_radius.hpp>
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Both ends of four contraction operators: generic and enriched, linear and nonsmooth.
std::vector<double> ends(const ReferenceProblem& problem, const Decomposition& parts, double mass_factor = 1) {
  const InterfaceFamily family(parts);
  const std::vector<char> active = active_contacts(problem, rigid_impulses(problem));
  const InterfaceOperator nonsmooth = InterfaceFamily(restrict_contacts(parts, active)).at(0);
  std::vector<double> values;
  const double eta = 0.7 / mass_factor, epsilon = 0.02 / mass_factor;
  for (const Contraction& b :
       {Contraction{family.at(infinity), family.at(epsilon)}, Contraction{family.at(eta), family.at(epsilon)},
        Contraction{family.at(eta), nonsmooth}, Contraction{family.at(infinity), family.at(0)}}) {
    const SpectralRadius radius = spectral_radius(b);
    REQUIRE(radius.converged);
    values.insert(values.end(), {radius.value, radius.eigenvalue_min, radius.eigenvalue_max, radius.subdominant,
                                 static_cast<double>(radius.unit_multiplicity)});
  }
  return values;
}

void require_equal(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i] == doctest::Approx(b[i]).epsilon(1e-9));
}

// Permutes the contacts of a problem and of its partition together.
void permute_contacts(ReferenceProblem& problem, Partition& partition, std::uint64_t seed) {
  std::vector<Index> order = natural_order(problem.contacts());
  RandomStream random(seed);
  for (Index i = problem.contacts() - 1; i > 0; --i) std::swap(order[at(i)], order[at(random.below(i + 1))]);
  const Matrix h = problem.h;
  Matrix permuted = h;
  std::vector<Index> subdomains;
  for (Index c = 0; c < problem.contacts(); ++c) {
    permuted.col(c) = h.col(order[at(c)]);
    subdomains.push_back(partition.subdomain_of_contact[at(order[at(c)])]);
  }
  problem.h = permuted.sparseView();
  partition.subdomain_of_contact = subdomains;
}

}  // namespace

TEST_CASE("rotation and translation of the packing") {
  for (const Case& one : with_interface(every_problem())) {
    CAPTURE(one.spec.name);
    const Model still = build(one), turned = moved(one, 0.7, 13.0, -5.0);
    REQUIRE(turned.network.size() == still.network.size());
    require_equal(ends(turned.problem, turned.parts), ends(still.problem, still.parts));
  }
}

TEST_CASE("renumbering of grains, contacts and subdomains") {
  for (const Case& one : with_interface(every_problem())) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    const std::vector<double> expected = ends(model.problem, model.parts);
    if (one.spec.name != "metis") {  // METIS makes another partition of the renumbered graph
      const Model other = build(renumbered(one, 11));
      require_equal(ends(other.problem, other.parts), expected);
    }
    ReferenceProblem problem = model.problem;
    Partition partition = model.partition;
    permute_contacts(problem, partition, 5);
    require_equal(ends(problem, decompose(problem, partition)), expected);

    Partition reversed = model.partition;
    for (Index& subdomain : reversed.subdomain_of_contact) subdomain = reversed.subdomains - 1 - subdomain;
    require_equal(ends(model.problem, decompose(model.problem, reversed)), expected);
  }
}

TEST_CASE("another full-rank gluing: star in place of chain, and any regular combination of the rows") {
  on_every_interface([&](const Model& model) {
    const std::vector<double> expected = ends(model.problem, model.parts);
    require_equal(ends(model.problem, decompose(model.problem, model.partition, GluingShape::star)), expected);

    Decomposition mixed = model.parts;  // A_E <- T A_E with a random regular T
    const Index n = mixed.interface_size();
    const Dense t = random_matrix(n, n, 3) + 3.0 * static_cast<double>(n) * identity(n);
    for (Subdomain& subdomain : mixed.subdomains) subdomain.a = (t * subdomain.a).entries().sparseView();
    require_equal(ends(model.problem, mixed), expected);
  });
}

TEST_CASE("masses times a factor: flexibilities divided by it") {
  on_every_interface([&](const Model& model) {
    ReferenceProblem heavy = model.problem;
    heavy.inertia *= 250.0;
    require_equal(ends(heavy, decompose(heavy, model.partition), 250.0), ends(model.problem, model.parts));
  });
}

TEST_CASE("a grain that touches nothing, and a contact-free subdomain, change nothing") {
  Case one = strip(8);
  const Model model = build(one);
  const std::vector<double> expected = ends(model.problem, model.parts);
  Packing packing = model.packing;  // an isolated grain inside the bounding box, numbered first
  packing.x.insert(packing.x.begin(), 2.0);
  packing.y.insert(packing.y.begin(), 0.577);
  packing.radius.insert(packing.radius.begin(), 0.01);
  packing.mass.insert(packing.mass.begin(), 3.0);
  one.spec.packing = PackingFile{"with an isolated grain"};
  one.packing = packing;
  const Model with = build(one);
  REQUIRE(with.network.size() == model.network.size());
  require_equal(ends(with.problem, with.parts), expected);

  Partition padded = model.partition;
  padded.subdomains += 3;
  require_equal(ends(model.problem, decompose(model.problem, padded)), expected);
}

TEST_CASE("masses 7 000 times as large: the same radii at the same relative eta and epsilon") {
  for (const Case& light : {random_lattice(3, 8, 6, {3, 2}), random_fcc(3, 4, 4, 4, GridPartitioner{{2, 2, 2}})}) {
    CAPTURE(light.spec.name);
    Case heavy = light;
    for (double& mass : heavy.packing.mass) mass *= 7000;
    SweepParameters parameters{
        .epsilon = {0.02, 1}, .eta = {0.5, 3, infinity}, .relative_epsilon = true, .relative_eta = true};
    const auto results = [&](const Case& one) {
      std::vector<SweepResult> all;
      sweep(build(one), parameters, [&](const SweepResult& result) { all.push_back(result); });
      return all;
    };
    const std::vector<SweepResult> of_light = results(light), of_heavy = results(heavy);
    REQUIRE(of_light.size() == 6);
    for (std::size_t k = 0; k < of_light.size(); ++k) {
      CHECK(of_heavy[k].scale == doctest::Approx(of_light[k].scale / 7000).epsilon(1e-12));
      CHECK(of_heavy[k].point.epsilon == doctest::Approx(of_light[k].point.epsilon / 7000).epsilon(1e-12));
      CHECK(of_heavy[k].asked.eta == of_light[k].asked.eta);
      CHECK(of_heavy[k].radius.value == doctest::Approx(of_light[k].radius.value).epsilon(1e-9));
      CHECK(of_light[k].radius.value > 0.01);
    }
    parameters.relative_epsilon = parameters.relative_eta = false;  // else masses matter
    CHECK(std::abs(results(heavy)[1].radius.value - of_light[1].radius.value) > 0.01);
    const SweepParameters absolute{.epsilon = {0.02 * of_light[0].scale}, .eta = {3 * of_light[0].scale}};
    sweep(build(light), absolute, [&](const SweepResult& result) {
      CHECK(result.radius.value == doctest::Approx(of_light[1].radius.value).epsilon(1e-12));
    });
  }
}
