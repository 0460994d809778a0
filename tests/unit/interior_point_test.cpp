// SPDX-License-Identifier: GPL-3.0-or-later
// The interior point method on problems without friction whose solution is known by construction.
#include "contact_solvers/interior_point.hpp"

#include "../support/matrices.hpp"
#include "contact_solvers/stored_contacts.hpp"
#include "linalg/random.hpp"

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// W = H^T H with fewer rows of H than contacts that are pressed, so that impulses are not unique. Of three contacts one
// is pressed, one parts, and one does neither: r = u = 0.
template <int D>
LocalFrictionProblem pressed_contacts(std::uint64_t seed, Index contacts, bool bodies, Vector& impulses,
                                      Vector& velocities) {
  RandomStream random(seed);
  const Index rows = contacts / 4;
  const Matrix h = random_matrix(rows, D * contacts, random);
  impulses = Vector::Zero(D * contacts);
  velocities = random.normal_vector(D * contacts);  // along surfaces any
  for (Index c = 0; c < contacts; ++c) {
    impulses[D * c] = c % 3 == 0 ? 0.1 + random.uniform() : 0;
    velocities[D * c] = c % 3 == 1 ? 0.1 + random.uniform() : 0;
  }
  LocalFrictionProblem problem;
  problem.dimension = D;
  problem.w = Matrix(h.transpose() * h).sparseView();
  problem.q = velocities - h.transpose() * (h * impulses);
  problem.friction = Vector::Zero(contacts);
  if (bodies) {
    problem.h = h.sparseView();
    problem.mass = SparseMatrix(Vector::Ones(rows).asDiagonal());
  }
  return problem;
}

// Whether the iterations converge from r = 0; `found`: how they ended.
template <int D>
bool solves(const LocalFrictionProblem& problem, FrictionSolution& found) {
  const FrictionSolverOptions options{.tolerance = 1e-10};
  const FrictionObserver nobody;
  StoredContacts<D> held(problem);
  SolverRun<D> run(held, options, Vector::Zero(problem.size()), nobody);
  const bool over = !run.judge(run.now.impulses) && InteriorPointSteps<StoredContacts<D>>(held, run).finish();
  found = run.now;
  return over && found.status == FrictionStatus::converged;
}

template <int D>
void check_known_solutions() {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const bool bodies : {false, true}) {
      INFO("D = ", D, ", seed = ", seed, ", bodies = ", bodies);
      Vector impulses, velocities;
      const LocalFrictionProblem problem = pressed_contacts<D>(seed, 30, bodies, impulses, velocities);
      FrictionSolution found;
      REQUIRE(solves<D>(problem, found));
      CHECK(found.factorisations <= 20);
      const Vector met = problem.w * found.impulses + problem.q;
      for (Index c = 0; c < problem.contacts(); ++c) {
        CHECK(found.impulses[D * c] >= 0);
        CHECK(found.impulses[D * c + 1] == 0);
        CHECK(std::abs(met[D * c] - velocities[D * c]) < 1e-7 * velocities.norm());  // unique, unlike impulses
      }
    }
}

}  // namespace

TEST_CASE("interior point method: known solutions with too many contacts and some that neither press nor part") {
  check_known_solutions<2>();
  check_known_solutions<3>();
}

TEST_CASE("interior point method: it ends without a solution if two walls close on a disk") {
  const Matrix w = (Matrix(4, 4) << 1, 0, -1, 0, 0, 3, 0, 0, -1, 0, 1, 0, 0, 0, 0, 3).finished();
  LocalFrictionProblem problem;
  problem.w = w.sparseView();
  problem.q = (Vector(4) << -1, 0, -1, 0).finished();
  problem.friction = Vector::Zero(2);
  FrictionSolution found;
  CHECK(!solves<2>(problem, found));
  CHECK(found.factorisations < 100);
}
