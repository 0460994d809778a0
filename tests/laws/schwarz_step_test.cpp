// SPDX-License-Identifier: GPL-3.0-or-later
// Schwarz's method on a step against a literal block Jacobi on the W of the undivided packing, against its iteration
// matrix where the law is linear, and where more than two copies of a grain meet.
#include "../support/dense.hpp"
#include "../support/spheres.hpp"
#include "mechanics/contact_blocks.hpp"
#include "two_stage/granular_two_stage.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// v = W r + b of all contacts, and the contacts of each subdomain in the order of its sweeps.
struct UndividedStep {
  Matrix w, velocities;  // M^-1 H
  Vector b, friction, free;
  Index dimension;
  std::vector<std::vector<Index>> blocks;
};

template <int D>
UndividedStep undivided(const Simulation& simulation, const PreparedStep<D>& step) {
  const StepProblem<D>& problem = step.share.problem;
  const ReferenceProblem reference = reference_problem(problem, simulation.system.grains());
  const Matrix h(reference.h);
  Vector bias(h.cols()), friction(count(problem.contacts));
  for (Index c = 0; c < friction.size(); ++c) {
    set_component<D>(bias, c, problem.contacts[at(c)].bias);
    friction[c] = problem.contacts[at(c)].friction;
  }
  const Matrix velocities = reference.inertia.cwiseInverse().asDiagonal() * h;
  UndividedStep result{.w = h.transpose() * velocities,
                       .velocities = velocities,
                       .b = h.transpose() * reference.arriving_velocity + bias,
                       .friction = friction,
                       .free = reference.arriving_velocity,
                       .dimension = D,
                       .blocks = {}};
  for (const GranularSubdomain<D>& subdomain : step.iteration.parts().subdomains)
    result.blocks.push_back(subdomain.numbers);
  return result;
}

// Every block sweeps with the impulses of the others as they were exchanged.
void block_jacobi(const UndividedStep& u, Index sweeps, double omega, Vector& r, Vector& exchanged) {
  const Index d = u.dimension;
  Vector next = r;
  for (const std::vector<Index>& block : u.blocks) {
    Vector z = exchanged;
    for (const Index c : block) z.segment(d * c, d) = r.segment(d * c, d);
    for (Index k = 0; k < sweeps; ++k)
      for (const Index c : block) {
        auto own = z.segment(d * c, d);
        const Vector v = u.w.middleRows(d * c, d) * z + u.b.segment(d * c, d);
        Vector now = own - v.cwiseQuotient(u.w.diagonal().segment(d * c, d));
        now[0] = std::max(0.0, now[0]);
        const double edge = u.friction[c] * now[0], size = now.tail(d - 1).norm();
        if (size > edge) now.tail(d - 1) *= edge / size;
        own = now;
      }
    for (const Index c : block) next.segment(d * c, d) = z.segment(d * c, d);
  }
  r = next;
  exchanged += omega * (r - exchanged);
}

Dynamics by_schwarz(Index sweeps = 1, double omega = 1) {
  Dynamics dynamics = tight();
  dynamics.interaction.friction = 0.4;
  dynamics.solver.algorithm = "schwarz";
  dynamics.solver.gauss_seidel_sweeps = sweeps;
  dynamics.solver.interface_relaxation = omega;
  dynamics.solver.warm_start = true;
  return dynamics;
}

template <int D>
Index most_copies(const GranularDecomposition<D>& parts) {
  Index most = 0;
  for (const Gluing& row : parts.interface.gluing()) most = std::max(most, parts.interface.multiplicity(row.grain));
  return most;
}

// The largest jumps of velocity between copies over their speeds, if those of a block have its impulses r and the
// exchanged ones of all others.
template <int D>
double jumps_of_copies(const UndividedStep& u, const Interface& interface, const Vector& r, const Vector& exchanged) {
  std::vector<Vector> v;
  for (const std::vector<Index>& block : u.blocks) {
    Vector z = exchanged;
    for (const Index c : block) z.segment(D * c, D) = r.segment(D * c, D);
    v.emplace_back(u.free + u.velocities * z);
  }
  const auto of = [](const Vector& values, Index grain) {
    return values.segment(unknowns_of_grain<D> * grain, unknowns_of_grain<D>);
  };
  double jumps = 0, speeds = 0, free = 0;
  for (const Gluing& row : interface.gluing())
    jumps += (of(v[at(row.first.subdomain)], row.grain) - of(v[at(row.second.subdomain)], row.grain)).squaredNorm();
  for (Index grain = 0; grain < interface.grains(); ++grain)
    for (const GrainCopy& copy : interface.copies(grain)) {
      if (interface.multiplicity(grain) < 2 || unknowns_of_grain<D> * grain >= u.free.size()) continue;
      speeds += of(v[at(copy.subdomain)], grain).squaredNorm();
      free += of(u.free, grain).squaredNorm();
    }
  return std::sqrt(jumps / std::max(speeds, free));
}

// Two steps, the second from the impulses of the first, next to the literal iteration.
template <int D>
void check_block_jacobi(Simulation simulation, Index copies) {
  const StepSolver& solver = simulation.dynamics.solver;
  simulation.dynamics.solver.maximum_iterations = 15;
  simulation.dynamics.solver.criterion = "none";
  for (int number = 0; number < 2; ++number) {
    PreparedStep<D> step = prepare_solution<D>(simulation);
    const UndividedStep u = undivided(simulation, step);
    CHECK(most_copies(step.iteration.parts()) >= copies);
    Vector r = step.iteration.state().head(u.b.size()), exchanged = r;
    CHECK((r.norm() > 0) == (number > 0));
    for (int k = 0; k < 15; ++k) {
      step.iteration.iterate();
      const Vector before = exchanged;
      block_jacobi(u, solver.gauss_seidel_sweeps, solver.interface_relaxation, r, exchanged);
      CHECK(step.iteration.record().gluing ==
            doctest::Approx(jumps_of_copies<D>(u, step.iteration.parts().interface, r, before)).epsilon(1e-6));
    }
    REQUIRE(r.norm() > 0.1);
    CHECK((step.iteration.state().head(r.size()) - r).norm() < 1e-11 * r.norm());
    const GranularStep<D> solved = solve_step<D>(simulation);
    // Momentum, whether copies agree yet or not.
    CHECK(largest_difference(solved.velocities, velocities_of(solved.problem, solved.contacts),
                             simulation.system.grains()) < 1e-12);
    take_step(simulation, solved);
  }
}

constexpr double linear_flexibility = 0.05;  // 1/kg

// The matrix of one iteration with a linear law, from the formula with T.
Matrix iteration_matrix(const UndividedStep& u, double epsilon, Index sweeps) {
  const Index size = u.w.rows(), d = u.dimension;
  Matrix block = Matrix::Zero(size, size), lower = block;
  for (const std::vector<Index>& contacts : u.blocks) {
    std::vector<Index> rows;
    for (const Index c : contacts)
      for (Index k = 0; k < d; ++k) rows.push_back(d * c + k);
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < rows.size(); ++j) {
        block(rows[i], rows[j]) = u.w(rows[i], rows[j]) + (i == j ? epsilon : 0);
        if (j <= i) lower(rows[i], rows[j]) = block(rows[i], rows[j]);
      }
  }
  const Dense one = identity(size), t = one - solve(lower, block);
  Dense power = one;
  for (Index k = 0; k < sweeps; ++k) power = t * power;
  return power + (one - power) * (one - solve(block, Dense(u.w) + epsilon * one));
}

Index dominant(const Eigen::VectorXcd& eigenvalues) {
  Index place = 0;
  eigenvalues.cwiseAbs().maxCoeff(&place);
  return place;
}

Simulation linear_lattice(std::array<Index, 2> grid, Index sweeps, double omega) {
  Dynamics dynamics = by_schwarz(sweeps, omega);
  dynamics.interaction.law = "linear_viscous";
  dynamics.interaction.epsilon = Flexibility{linear_flexibility};
  dynamics.time.step = 1e-5;  // disks touch
  return shaken_lattice(4, 3, dynamics, grid);
}

}  // namespace

TEST_CASE("schwarz: impulses are those of block Jacobi on the undivided W, with friction, at cross points, in space") {
  for (const double omega : {1.0, 0.6})
    for (const Index sweeps : {1, 3}) {
      INFO("omega = ", omega, ", sweeps = ", sweeps);
      check_block_jacobi<2>(shaken_lattice(6, 5, by_schwarz(sweeps, omega), {2, 1}), 2);
      check_block_jacobi<2>(shaken_lattice(6, 5, by_schwarz(sweeps, omega), {2, 2}), 3);
      check_block_jacobi<3>(shaken_cube(3, by_schwarz(sweeps, omega), {2, 1, 1}), 2);
      check_block_jacobi<3>(shaken_cube(3, by_schwarz(sweeps, omega), {2, 2, 1}), 3);
    }
}

TEST_CASE("schwarz: with a linear law changes of the impulses follow J_n, and an error shrinks at its radius") {
  int real = 0;
  for (const Index sweeps : {1, 4})
    for (const std::array<Index, 2> grid : {std::array<Index, 2>{2, 1}, {2, 2}}) {
      INFO("sweeps = ", sweeps, ", grid[1] = ", grid[1]);
      const Simulation simulation = linear_lattice(grid, sweeps, 1);
      PreparedStep<2> step = prepare_solution<2>(simulation);
      const UndividedStep u = undivided(simulation, step);
      const Index size = u.b.size();
      const Matrix j = iteration_matrix(u, linear_flexibility, sweeps);
      Vector before = step.iteration.state().head(size), change;
      for (int k = 0; k < 20; ++k) {
        step.iteration.iterate();
        const Vector now = step.iteration.state().head(size);
        if (k > 0) CHECK((now - before - j * change).norm() < 1e-11 * change.norm());
        change = now - before;
        before = now;
      }
      const Eigen::VectorXcd eigenvalues = general_eigenvalues(j);
      const std::complex<double> value = eigenvalues[dominant(eigenvalues)];
      if (value.imag() != 0) continue;
      ++real;
      const double radius = std::abs(value);
      const Vector solution = solve(Dense(u.w) + linear_flexibility * identity(size), Vector(-u.b));
      const LinearMap inverse = solver(Dense(j) - (1 + 1e-12) * value.real() * identity(size));
      const Vector mode = inverse(inverse(Vector::Ones(size)).normalized());
      Vector z = Vector::Zero(size + step.iteration.parts().interface_size());
      z.head(size) = solution + solution.norm() / mode.norm() * mode;
      step.iteration.restart(z);  // resultants follow from the jumps
      z.tail(z.size() - size) =
          step.iteration.parts().generic_interface_solve(step.iteration.parts().interface_jumps());
      step.iteration.restart(z);
      for (int k = 0; k < 50; ++k) step.iteration.iterate();
      const double error = (step.iteration.state().head(size) - solution).norm() / solution.norm();
      CHECK(std::abs(std::pow(error, 1 / 50.0) - radius) < 1e-7 * std::abs(1 - radius));
    }
  CHECK(real > 1);
}

TEST_CASE("schwarz: many sweeps diverge where q copies meet, and a relaxation below 2/q repairs it") {
  for (const double omega : {1.0, 0.45}) {
    INFO("omega = ", omega);
    Simulation simulation = linear_lattice({2, 2}, 20, omega);
    simulation.dynamics.solver.maximum_iterations = 20'000;
    simulation.dynamics.solver.tolerance = 1e-9;
    const PreparedStep<2> prepared = prepare_solution<2>(simulation);
    CHECK(most_copies(prepared.iteration.parts()) == 4);
    const Eigen::VectorXcd modes =
        general_eigenvalues(iteration_matrix(undivided(simulation, prepared), linear_flexibility, 20));
    CHECK(std::abs(modes[dominant(modes)]) > 2);
    const StepReport report = solve_step(simulation).report;
    CHECK(report.status == (omega == 1 ? SolverStatus::diverged : SolverStatus::converged));
  }
}
