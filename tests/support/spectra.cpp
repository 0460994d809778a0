// SPDX-License-Identifier: GPL-3.0-or-later
#include "spectra.hpp"

#include "linalg/random.hpp"
#include "problems.hpp"

#include <cmath>

namespace nscdd::testing {
namespace {

// `one` and the same again beside it, in one packing, cut so that each has the same subdomains.
Case doubled(Case one, Index strips) {
  const Packing single = packing_of(one);
  Packing both = single;
  double left = single.x[0], right = single.x[0];
  for (const double x : single.x) {
    left = std::min(left, x);
    right = std::max(right, x);
  }
  const double shift = 2 * (right - left);  // a whole number of cells: both are cut alike
  for (Index i = 0; i < single.size(); ++i) {
    both.x.push_back(single.x[at(i)] + shift);
    both.y.push_back(single.y[at(i)]);
    both.radius.push_back(single.radius[at(i)]);
    if (single.dimension() == 3) both.z.push_back(single.z[at(i)]);
    if (!single.mass.empty()) both.mass.push_back(single.mass[at(i)]);
  }
  one.spec.name += " twice";
  one.spec.packing = PackingFile{"made in a test"};
  one.packing = both;
  one.spec.partition = GridPartitioner{{3 * strips, 1}};
  return one;
}

}  // namespace

DenseSpectrum::DenseSpectrum(const Contraction& b) : root(b.system.scale().cwiseSqrt().cwiseInverse()) {
  s = Matrix(root.asDiagonal() * b.system.dense() * root.asDiagonal());
  p = Matrix(root.asDiagonal() * b.preconditioner.dense() * root.asDiagonal());
  lambda = pencil_eigenvalues(s, p);
}

Index DenseSpectrum::between(double from, double to) const {
  return (lambda.array() >= from && lambda.array() <= to).count();
}

Contraction contraction_of(const Case& one, double epsilon, double eta) {
  const InterfaceFamily family(build(one).parts);
  return {family.at(eta), family.at(epsilon)};
}

SpectralRadius dense_pencil_radius(const Contraction& b) {
  return spectral_radius(b, {.solver = SpectralSolver::dense});
}

Case lattice_in_grid(Index grains, std::array<Index, 2> grid) {
  const auto n = static_cast<double>(grains);
  const Index columns = std::lround(std::sqrt(std::sqrt(3.0) * n));
  const Index rows = (grains + columns - 1) / columns;
  Packing packing = generate(HexagonalLattice{.columns = columns, .rows = rows, .radius = 0.5});
  for (auto* values : {&packing.x, &packing.y, &packing.radius}) values->resize(at(grains));
  packing.mass.assign(at(grains), 1.0);
  Case one;
  one.spec.name = "lattice of " + std::to_string(grains);
  one.spec.packing = PackingFile{"made in a test"};
  one.packing = packing;
  one.spec.partition = GridPartitioner{grid};
  return one;
}

Case deposit(Index grains, std::array<Index, 2> grid, Index parts) {
  Case one;
  one.spec.name = "deposit of " + std::to_string(grains);
  one.spec.packing = Generator{Deposit{.grains = grains, .seed = 3}};
  one.spec.partition = GridPartitioner{grid};
  if (parts > 0) one.spec.partition = MetisPartitioner{.metis = parts, .seed = 2};
  return one;
}

Case with_unequal_masses(Case one, std::uint64_t seed) {
  Packing packing = packing_of(one);
  RandomStream random(seed);
  packing.mass.resize(at(packing.size()));
  for (double& mass : packing.mass) mass = std::pow(10.0, 4 * random.uniform() - 2);
  one.spec.name += ", unequal masses";
  one.spec.packing = PackingFile{"made in a test"};
  one.packing = packing;
  return one;
}

std::vector<Case> packings_up_to(Index largest) {
  Case metis = random_lattice(25, 14, 12, {1, 1});
  metis.spec.name = "METIS";
  metis.spec.partition = MetisPartitioner{.metis = 9, .seed = 1};
  const std::vector<Case> all{random_lattice(21, 9, 8, {3, 2}),
                              random_lattice(22, 12, 10, {4, 4}),
                              metis,
                              deposit(150, {4, 3}),
                              deposit(300, {1, 1}, 12),
                              with_unequal_masses(random_lattice(23, 10, 9, {3, 3}), 7),
                              with_unequal_masses(deposit(200, {5, 4}), 8),
                              doubled(random_lattice(24, 9, 7, {1, 1}), 3),
                              random_fcc(21, 5, 5, 4, GridPartitioner{{2, 2, 2}}),
                              random_fcc(22, 7, 6, 6, MetisPartitioner{.metis = 5, .seed = 1}),
                              sphere_cluster(23, 80, GridPartitioner{{2, 2, 2}}),
                              lattice_in_grid(200, {2, 1}),
                              lattice_in_grid(400, {8, 1}),
                              lattice_in_grid(400, {4, 4}),
                              random_lattice(26, 40, 16, {16, 1}),
                              deposit(1500, {6, 6})};
  std::vector<Case> small;
  for (const Case& one : all)
    if (build(one).parts.interface_size() <= largest) small.push_back(one);
  return small;
}

Optimum optimum_of(const Model& model, double epsilon, ContactSet contacts) {
  Optimum best;
  optima(model, select(model, contacts), {.epsilon = {epsilon}, .contacts = contacts},
         [&](const OptimumResult& result) { best = result.best; });
  return best;
}

}  // namespace nscdd::testing
