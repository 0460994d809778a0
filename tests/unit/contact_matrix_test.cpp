// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_solvers/contact_matrix.hpp"

#include "../support/dense.hpp"
#include "../support/fclib_files.hpp"
#include "../support/literal_sweeps.hpp"
#include "linalg/random.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// Contacts that open, stick and slide under a proximal term, and full blocks as a smoothed law has them.
std::vector<ContactRelation<2>> random_relations(RandomStream& random, Index contacts, double smallest) {
  std::vector<ContactRelation<2>> relations(static_cast<std::size_t>(contacts));
  for (ContactRelation<2>& relation : relations) {
    const double kind = random.uniform(), size = std::pow(smallest, random.uniform());
    if (kind < 0.2) continue;  // open
    relation.q(0, 0) = 1;
    relation.p(0, 0) = size;
    if (kind < 0.4) {
      relation.p(1, 0) = random.uniform() - 0.5;  // slides
      continue;
    }
    relation.q(1, 1) = 1;
    relation.p(1, 1) = kind < 0.6 ? size : std::pow(smallest, random.uniform());
    if (kind > 0.6) relation.p(1, 0) = size * (random.uniform() - 0.5);
    if (kind > 0.8) relation.q(1, 0) = 2 * (random.uniform() - 0.5);
  }
  return relations;
}

}  // namespace

// 10 bodies with 40 contacts: fewer entries with the bodies as unknowns. 30 with 31: fewer with the contacts.
TEST_CASE("linear systems of contacts are solved alike with contacts and with bodies as unknowns") {
  Index negative = 0;
  for (const Index bodies : {10, 30})
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const Index contacts = bodies == 10 ? 40 : 31;
      INFO("bodies = ", bodies, ", seed = ", seed);
      const LocalFrictionProblem problem = reduce(random_bodies_problem(seed, bodies, contacts));
      LocalFrictionProblem without = problem;
      without.mass = without.h = SparseMatrix();
      RandomStream random(100 + seed);
      ContactMatrix<2> matrix(problem, problem.w), of_contacts(without, without.w);
      for (const double smallest : {1e-2, 1e-7}) {
        const auto relations = random_relations(random, contacts, smallest);
        const Vector r = random.normal_vector(2 * contacts);
        const Matrix dense = literal_system(Matrix(problem.w), relations);
        const Vector b = dense * r, expected = solve(Dense(dense), b);
        REQUIRE(matrix.factorise(relations));
        REQUIRE(of_contacts.factorise(relations));
        const int sign = determinant(dense) < 0 ? -1 : 1;
        negative += sign < 0;
        CHECK(matrix.determinant_sign() == sign);
        CHECK(of_contacts.determinant_sign() == sign);
        // The matrix is as badly conditioned as `smallest` says: residuals tell what impulses cannot.
        for (const Vector& found : {matrix.solve(b), of_contacts.solve(b)}) {
          CHECK((dense * found - b).norm() <= 1e-11 * b.norm());
          CHECK((found - expected).norm() <= 1e-14 / smallest * expected.norm());
        }
      }
    }
  CHECK(negative >= 2);
}

TEST_CASE("a contact of which nothing is asked leaves a matrix that is not factorised") {
  LocalFrictionProblem problem = reduce(random_bodies_problem(1, 10, 40));
  problem.mass = problem.h = SparseMatrix();
  std::vector<ContactRelation<2>> relations(40);
  ContactMatrix<2> matrix(problem, problem.w);
  CHECK(matrix.factorise(relations));
  relations[7].p.setZero();
  CHECK_FALSE(matrix.factorise(relations));
}
