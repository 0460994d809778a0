// SPDX-License-Identifier: GPL-3.0-or-later
// The rigid limit in space: clusters that move as one, free motions, unit eigenvalues, by dense algebra and MUMPS.
#include "../support/dense.hpp"
#include "../support/judged_radius.hpp"
#include "../support/problems.hpp"
#include "ddm/rigid_system.hpp"
#include <nscdd/spectra/spectral_radius.hpp>

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Case spheres(Generator generator, std::string name) {
  Case one;
  one.spec.name = std::move(name);
  one.spec.packing = std::move(generator);
  one.spec.masses.model = MassModel::unit;
  one.spec.partition = GridPartitioner{{2, 2, 2}};
  return one;
}

SphereSites sites(Index columns, Index rows, Index layers, double vacancies) {
  return {.columns = columns, .rows = rows, .layers = layers, .vacancies = vacancies, .seed = 3};
}

Case fcc(Index columns, Index rows, Index layers, double vacancies) {
  return spheres(FccLattice{sites(columns, rows, layers, vacancies)}, "fcc");
}

Case hcp(Index columns, Index rows, Index layers, double vacancies) {
  return spheres(HcpLattice{sites(columns, rows, layers, vacancies)}, "hcp");
}

Case fallen(Index grains) { return spheres(SphereDeposit{.grains = grains, .seed = 3}, "deposit"); }

SpectralRadius spheres_shift_inverted(const Contraction& b) {
  return judged_radius(b, {.solver = SpectralSolver::shift_invert, .certify = true});
}

Index rank(const SparseMatrix& h) {
  const Dense rows = Matrix(h);
  return (symmetric_eigenvalues(rows * rows.transpose()).array() > 1e-10).count();
}

}  // namespace

TEST_CASE("rigid limit of spheres: unit eigenvalues are those of dense ranks") {
  for (const Case& one : {fcc(5, 5, 5, 0), fcc(5, 5, 6, 0.1), hcp(5, 5, 5, 0.1), fallen(120)}) {
    CAPTURE(one.spec.name);
    const Model model = build(one);
    Index unit = -rank(model.problem.h);
    for (const Subdomain& subdomain : model.parts.subdomains) unit += rank(subdomain.h);
    CHECK(InterfaceFamily(model.parts).at(0).nullity() == unit);
  }
}

TEST_CASE("rigid limit of spheres: shift-invert proves what the dense pencil finds, and MUMPS counts the same") {
  for (const Case& one : {fcc(8, 8, 8, 0), fcc(8, 8, 8, 0.08), hcp(8, 8, 7, 0.05), fcc(8, 8, 7, 0.3), fallen(500)}) {
    CAPTURE(one.spec.name);
    const InterfaceFamily family(build(one).parts);
    for (const double eta : {0.1, infinity}) {
      CAPTURE(eta);
      const Contraction b{family.at(eta), family.at(0)};
      const SpectralRadius found = spheres_shift_inverted(b),
                           dense = spectral_radius(b, {.solver = SpectralSolver::dense});
      CHECK(found.converged);
      CHECK(found.certified);
      CHECK(dense.converged);
      CHECK(found.unit_multiplicity == dense.unit_multiplicity);
      CHECK(std::abs(found.subdominant_min - dense.subdominant_min) <= 1e-8);
      CHECK(std::abs(found.subdominant_max - dense.subdominant_max) <= 1e-8);
    }
  }
}

TEST_CASE("rigid limit of 2 000 spheres, regular, with vacancies and fallen: proved as MUMPS counts") {
  for (const Case& one : {fcc(13, 13, 12, 0), fcc(13, 13, 12, 0.1), hcp(12, 12, 12, 0.1), fallen(2000)}) {
    CAPTURE(one.spec.name);
    const InterfaceFamily family(build(one).parts);
    const SpectralRadius found = spheres_shift_inverted({family.at(infinity), family.at(0)});
    CHECK(found.converged);
    CHECK(found.certified);
  }
}

TEST_CASE("rigid limit of an fcc block: each of its eight parts is one cluster, with few grains beside it") {
  const Model model = build(fcc(12, 12, 12, 0));
  for (const RigidSubdomain& part : rigid_system(model.parts).subdomains) {
    CHECK(std::ranges::count(part.hub, 1) == 1);
    CHECK(count(part.motions.bodies) < 60);
    CHECK(count(part.early) + count(part.late) < 70);
  }
}

TEST_CASE("rigid clusters: two heavy spheres among light ones leave no inertia about their line, and no cluster") {
  const Model model = build(fcc(6, 6, 6, 0));
  const Subdomain& part = model.parts.subdomains[0];
  const Index grains = count(part.grains);
  const auto bodies = [&](const Vector& inertia) {
    return count(rigid_motions(3, part.centres, inertia, part.h).bodies);
  };
  REQUIRE(bodies(part.inertia) < grains / 2);
  const Index a = part.h.col(0).nonZeros() > 0 ? SparseMatrix::InnerIterator(part.h, 0).row() / 3 : 0;
  Index b = a;
  for (SparseMatrix::InnerIterator e(part.h, 0); e; ++e) b = e.row() / 3;
  REQUIRE(b != a);
  Vector heavy = part.inertia;
  for (const Index grain : {a, b}) heavy.segment(3 * grain, 3) *= 1e13;
  CHECK(bodies(heavy) == grains);
}
