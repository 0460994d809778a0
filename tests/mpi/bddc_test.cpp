// SPDX-License-Identifier: GPL-3.0-or-later
// PCBDDC of PETSc, one subdomain per process, against our solutions and our spectra.
#include "../support/dense.hpp"
#include "../support/problems.hpp"
#include "../support/spectra.hpp"
#include "ddm/primal_interface.hpp"
#include "linalg/pencil.hpp"
#include "linalg/random.hpp"
#include "spectra/balanced_spectrum.hpp"
#include <nscdd/mpi/bddc.hpp>
#include <nscdd/mpi/processes.hpp>
#include <nscdd/study/sweep.hpp>

#include <doctest/doctest.h>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// A deposit with one subdomain per process, whole and shared.
struct BddcProblem {
  Processes processes = mpi::processes_of(MPI_COMM_WORLD);
  Model whole = build(deposit(400, {processes.size > 1 ? processes.size / 2 : 1, processes.size > 1 ? 2 : 1}));
  Model own = of_process(whole, processes);
  double scale = flexibility_scale(whole);
  Bddc bddc = mpi::bddc(MPI_COMM_WORLD);

  static SparseMatrix system(const Subdomain& one, double epsilon) {
    SparseMatrix m = one.h * SparseMatrix(one.h.transpose()) / epsilon;
    m += SparseMatrix(one.inertia.asDiagonal());
    return m;
  }

  struct Found : BddcSolution {
    Index coarse_size;
  };
  // Checked: two right-hand sides converge to the solutions of the undivided packing.
  Found solve(double epsilon, const BddcParameters& parameters) const {
    const BddcSystem glued =
        bddc(own.parts, system(own.parts.subdomains[at(own_subdomain(own.parts))], epsilon), parameters);
    const SparseMatrix m = system(reassemble(whole.parts), epsilon);
    REQUIRE(glued.size == m.rows());
    BddcSolution found;
    for (const std::uint64_t seed : {2U, 1U}) {
      // What every rank adds is another vector.
      const Vector share = RandomStream(seed + 10 * static_cast<std::uint64_t>(processes.rank))
                               .normal_vector(static_cast<Index>(glued.unknowns.size()));
      Vector right = Vector::Zero(glued.size);
      right(glued.unknowns) = share;
      processes.add_up({right.data(), at(right.size())});
      found = glued.solve(share);
      CHECK(found.converged);
      CHECK(found.lambda_min > 0.99);
      CHECK(found.lambda_min < 1.1);
      CHECK(found.flops > 0);
      const Vector known = testing::solve(Dense(m), right);
      Vector met = known;
      met(glued.unknowns) = found.velocities;
      const Vector error = met - known;
      CHECK(error.dot(m * error) < 1e-8 * known.dot(m * known));
    }
    return {found, glued.coarse_size};
  }
};

// Eigenvalues of N C, ascending: one-level Neumann-Neumann.
Vector one_level(const Model& model, double epsilon, Scaling scaling) {
  PrimalInterface interface = condense(model.parts, epsilon);
  weigh(interface, scaling);
  const Matrix lower = cholesky_factor(interface.sparse());
  return symmetric_values(lower.transpose() * interface.dense_preconditioner() * lower);
}

}  // namespace

TEST_CASE("bddc: solutions are ours; two subdomains have the spectrum of Neumann-Neumann, or 1 with deluxe weights") {
  const BddcProblem problem;
  const double epsilon = 1e-2 * problem.scale;
  const auto sharing = condense(problem.whole.parts, epsilon).sharing;
  const auto vertices = std::ranges::count_if(
      sharing, [&](const auto& one) { return one.size() > 2 || std::ranges::count(sharing, one) == 1; });
  for (const Scaling scaling : {Scaling::multiplicity, Scaling::stiffness, Scaling::deluxe}) {
    CAPTURE(to_string(scaling));
    const auto found = problem.solve(epsilon, {scaling});
    CHECK(found.coarse_size == 2 * vertices);
    if (problem.processes.size != 2) continue;
    const Vector known = one_level(problem.whole, epsilon, scaling);
    CHECK(found.lambda_max == doctest::Approx(known[known.size() - 1]).epsilon(1e-3));
    CHECK((found.iterations <= 2) == (scaling == Scaling::deluxe));
  }
}

TEST_CASE("bddc: adaptive constraints keep the condition number to a factor, and are as many as laws ask for") {
  const BddcProblem problem;
  const double wanted = 30;
  for (const double relative : {1e-6, 1e-3}) {
    CAPTURE(relative);
    const double epsilon = relative * problem.scale;
    const auto found = problem.solve(epsilon, {Scaling::deluxe, wanted});
    CHECK(found.lambda_max <= 2 * wanted);  // theory allows a factor that grows with the edges of a subdomain
    if (problem.processes.size < 4) continue;
    // A primal velocity removes as many dimensions as it has copies less one, a constraint of an edge one.
    const Interface& glued = problem.whole.parts.interface;
    const Index cross = cross_points(problem.whole.parts);
    Index removed = found.coarse_size - 2 * cross;
    for (Index grain = 0; grain < glued.grains(); ++grain)
      if (glued.multiplicity(grain) > 2) removed += 2 * (glued.multiplicity(grain) - 1);
    const Vector known = one_level(problem.whole, epsilon, Scaling::deluxe);
    CHECK((known.array() > 1.05 * found.lambda_max).count() <= removed);
    PrimalInterface interface = condense(problem.whole.parts, epsilon);
    weigh(interface, Scaling::deluxe);
    const CoarseProblem candidates(interface,
                                   geneo_vectors(interface, static_cast<double>(interface.most_neighbours()) / wanted));
    const std::optional<Index> ours = BalancedSpectrum(interface, candidates).fewest(wanted);
    CAPTURE(found.coarse_size);
    REQUIRE(ours);
    CAPTURE(*ours);
    CHECK(found.coarse_size <= 4 * *ours + 2 * cross);
    CHECK(4 * found.coarse_size >= *ours);
  }
}

TEST_CASE("bddc: other numbers of processes than of subdomains are refused") {
  const Processes processes = mpi::processes_of(MPI_COMM_WORLD);
  const Model own = of_process(build(random_lattice(3, 12, 12, {3, 3})), processes);
  CHECK_THROWS_WITH_AS(
      mpi::bddc(MPI_COMM_WORLD)(own.parts, {}, {}),
      ("bddc: expected as many processes as subdomains, 9, met " + std::to_string(processes.size)).c_str(), Error);
}
