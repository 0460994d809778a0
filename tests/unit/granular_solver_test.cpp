// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Seidel on the contact problem of a step against direct solutions of small complementarity problems:
// every combination of statuses tried, matrices written down from the geometry alone.
#include "../support/dense.hpp"
#include "../support/granular.hpp"
#include "linalg/random.hpp"
#include "mechanics/contact_residual.hpp"
#include "two_stage/granular_two_stage.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <optional>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

// v = H^T V + bias with V = V_free + M^-1 H r over (x, y, spin) of every disk; columns n and t of each contact.
struct WrittenStep {
  Matrix h;
  Vector inverse_mass, free, bias;
  std::vector<double> friction;

  Matrix w() const { return h.transpose() * inverse_mass.asDiagonal() * h; }
  Vector free_relative() const { return h.transpose() * free + bias; }
  Vector velocities(const Vector& r) const { return free + inverse_mass.asDiagonal() * (h * r); }
};

// From positions, radii and velocities alone, in the order of step.geometry.
WrittenStep written_down(const Simulation& s, const GranularStep<2>& step) {
  const Index n = s.system.grains(), contacts = count(step.problem.geometry);
  const double h = s.dynamics.time.step;
  WrittenStep p;
  p.h = Matrix::Zero(3 * n, 2 * contacts);
  p.inverse_mass.resize(3 * n);
  p.free.resize(3 * n);
  std::vector<double> x, y;
  for (Index i = 0; i < n; ++i) {
    const double m = s.system.mass[at(i)], radius = s.system.radius[at(i)];
    p.inverse_mass.segment(3 * i, 3) << 1 / m, 1 / m, 2 / (m * radius * radius);
    p.free.segment(3 * i, 3) << s.state.velocity_x[at(i)], s.state.velocity_y[at(i)] - h * g, s.state.spin[at(i)];
    x.push_back(s.state.x[at(i)] + h / 2 * s.state.velocity_x[at(i)]);
    y.push_back(s.state.y[at(i)] + h / 2 * s.state.velocity_y[at(i)]);
  }
  p.bias = Vector::Zero(2 * contacts);
  for (Index c = 0; c < contacts; ++c) {
    const Index a = step.problem.geometry[at(c)].a, b = step.problem.geometry[at(c)].b;
    double nx = 0, ny = -1, gap = y[at(a)] - s.system.radius[at(a)];  // the floor y = 0
    if (b < n) {
      const double dx = x[at(b)] - x[at(a)], dy = y[at(b)] - y[at(a)], d = std::hypot(dx, dy);
      nx = dx / d;
      ny = dy / d;
      gap = d - s.system.radius[at(a)] - s.system.radius[at(b)];
      p.h.block(3 * b, 2 * c, 3, 2) << nx, -ny, ny, nx, 0, -s.system.radius[at(b)];
    }
    p.h.block(3 * a, 2 * c, 3, 2) << -nx, ny, -ny, -nx, 0, -s.system.radius[at(a)];
    p.bias[2 * c] = gap / h;
    const auto& interaction = s.dynamics.interaction;
    p.friction.push_back(interaction.law == "frictionless" ? 0.0
                         : b < n                           ? interaction.friction
                                                           : interaction.boundary_friction);
  }
  return p;
}

enum class Status { open, stick, forward, backward };

// The impulses of one combination of statuses, where they obey every inequality.
std::optional<Vector> solution_of(const WrittenStep& p, const std::vector<Status>& statuses) {
  const Index m = p.bias.size();
  Matrix equations = Matrix::Zero(m, m);
  Vector right = Vector::Zero(m);
  const Matrix w = p.w();
  const Vector v0 = p.free_relative();
  for (Index c = 0; c < count(statuses); ++c) {
    const Status status = statuses[at(c)];
    if (status == Status::open) {
      equations(2 * c, 2 * c) = equations(2 * c + 1, 2 * c + 1) = 1;
      continue;
    }
    equations.row(2 * c) = w.row(2 * c);  // v_n = 0
    right[2 * c] = -v0[2 * c];
    if (status == Status::stick) {
      equations.row(2 * c + 1) = w.row(2 * c + 1);  // v_t = 0
      right[2 * c + 1] = -v0[2 * c + 1];
    } else {  // r_t = -+ mu r_n
      equations(2 * c + 1, 2 * c + 1) = 1;
      equations(2 * c + 1, 2 * c) = (status == Status::forward ? 1 : -1) * p.friction[at(c)];
    }
  }
  if (rank(equations) < m) return std::nullopt;
  const Vector r = solve(equations, right);
  const Vector v = w * r + v0;
  constexpr double hair = 1e-11;
  for (Index c = 0; c < count(statuses); ++c) {
    const double r_n = r[2 * c], r_t = r[2 * c + 1], v_n = v[2 * c], v_t = v[2 * c + 1];
    if (r_n < -hair || v_n < -hair) return std::nullopt;
    if (std::abs(r_t) > p.friction[at(c)] * r_n + hair) return std::nullopt;
    if (p.friction[at(c)] == 0) continue;  // no friction: it slides either way
    if (statuses[at(c)] == Status::forward && v_t < -hair) return std::nullopt;
    if (statuses[at(c)] == Status::backward && v_t > hair) return std::nullopt;
  }
  return r;
}

std::vector<Vector> every_solution(const WrittenStep& p, int statuses_per_contact) {
  std::vector<Vector> result;
  const auto contacts = p.friction.size();
  std::vector<int> digits(contacts, 0);
  for (;;) {
    std::vector<Status> statuses;
    for (const int digit : digits)  // without friction: open, or sliding at mu = 0
      statuses.push_back(statuses_per_contact == 2 && digit == 1 ? Status::forward : static_cast<Status>(digit));
    if (auto r = solution_of(p, statuses)) result.push_back(*r);
    std::size_t k = 0;
    while (k < contacts && ++digits[k] == statuses_per_contact) digits[k++] = 0;
    if (k == contacts) return result;
  }
}

Vector velocities_of(const Simulation& s, const GranularStep<2>& step) {
  Vector v(3 * s.system.grains());
  for (Index i = 0; i < s.system.grains(); ++i) {
    const GrainVelocity<2>& one = step.velocities[at(i)];
    v.segment(3 * i, 3) << one.x, one.y, one.rim / s.system.radius[at(i)];
  }
  return v;
}

struct Cluster {
  std::string name;
  std::vector<Grain> grains;
  bool floor = false;
};

std::vector<Cluster> clusters() {
  const double up = std::sqrt(0.75);
  return {{"pair", {{.x = 0, .y = 5}, {.x = 1, .y = 5}}},
          {"one on the floor", {{.y = 0.5}}, true},
          {"triangle", {{.y = 5}, {.x = 1, .y = 5}, {.x = 0.5, .y = 5 + up}}},
          {"two on the floor", {{.y = 0.5}, {.x = 1, .y = 0.5}}, true},
          {"bent chain", {{.y = 5}, {.x = 1, .y = 5}, {.x = 1.5, .y = 5 + up}, {.x = 1.2, .y = 6 + up}}},
          {"rhombus", {{.y = 5}, {.x = 1, .y = 5}, {.x = 0.5, .y = 5 + up}, {.x = 1.5, .y = 5 + up}}},
          {"arch", {{.x = -0.5, .y = 0.5}, {.x = 0.5, .y = 0.5}, {.x = 0, .y = 0.5 + up}}, true}};
}

// The cluster with random masses, velocities of its disks and gaps of some tenths of h V.
Simulation shaken(const Cluster& cluster, const std::string& law, double friction, std::uint64_t seed) {
  RandomStream random(seed);
  Dynamics dynamics = tight();
  dynamics.time.maximum_push_speed = infinity;  // overlaps are in the problem as gaps are
  dynamics.interaction.law = law;
  dynamics.interaction.friction = friction;
  dynamics.interaction.boundary_friction = friction / 2;
  if (cluster.floor) dynamics.boundaries = {floor_wall()};
  std::vector<Grain> grains = cluster.grains;
  for (Grain& grain : grains) {
    grain.mass = 0.3 + 2 * random.uniform();
    grain.radius -= 0.001 * random.uniform() - 0.0003;
    grain.velocity_x = random.uniform() - 0.5;
    grain.velocity_y = random.uniform() - 0.5;
    grain.spin = 2 * random.uniform() - 1;
  }
  return simulation_of(grains, dynamics);
}

}  // namespace

TEST_CASE("frictionless: velocities and impulses are those of the only solution of the complementarity problem") {
  int solved = 0, with_impulse = 0;
  for (const Cluster& cluster : clusters())
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      INFO("name = ", cluster.name, ", seed = ", seed);
      Simulation simulation = shaken(cluster, "frictionless", 0.4, seed);
      const GranularStep<2> step = solve_step(simulation);
      REQUIRE(step.report.status == SolverStatus::converged);
      const WrittenStep problem = written_down(simulation, step);
      REQUIRE(problem.friction.size() <= 5);
      const std::vector<Vector> solutions = every_solution(problem, 2);
      REQUIRE_FALSE(solutions.empty());
      const Vector v = velocities_of(simulation, step);
      for (const Vector& r : solutions) CHECK((problem.velocities(r) - v).norm() < 1e-9);
      for (const double relaxation : {0.7, 1.5}) {  // other iterates, the same end
        CAPTURE(relaxation);
        simulation.dynamics.solver.contact_relaxation = relaxation;
        const GranularStep<2> relaxed = solve_step(simulation);
        REQUIRE(relaxed.report.status == SolverStatus::converged);
        CHECK((velocities_of(simulation, relaxed) - v).norm() < 1e-9);
      }
      ++solved;
      with_impulse += solutions.front().norm() > 1e-6;
    }
  CHECK(solved == 280);
  CHECK(with_impulse > 140);
}

TEST_CASE("Coulomb friction: the result is a solution with one status per contact, and its status is reported") {
  int sliding = 0, sticking = 0, several = 0;
  for (const Cluster& cluster : clusters())
    for (const double friction : {0.0, 0.15, 0.6, 2.0})
      for (std::uint64_t seed = 1; seed <= 15; ++seed) {
        INFO("name = ", cluster.name, ", friction = ", friction, ", seed = ", seed);
        const Simulation simulation = shaken(cluster, "coulomb", friction, seed);
        const GranularStep<2> step = solve_step(simulation);
        REQUIRE(step.report.status == SolverStatus::converged);
        const WrittenStep problem = written_down(simulation, step);
        if (problem.friction.size() > 3) continue;
        const std::vector<Vector> solutions = every_solution(problem, 4);
        REQUIRE_FALSE(solutions.empty());
        const Vector v = velocities_of(simulation, step);
        double nearest = infinity;
        for (const Vector& r : solutions) nearest = std::min(nearest, (problem.velocities(r) - v).norm());
        CHECK(nearest < 1e-9);
        for (const Vector& r : solutions)
          if ((problem.velocities(r) - problem.velocities(solutions.front())).norm() > 1e-6) ++several;
        sliding += static_cast<int>(step.report.residual.slide);
        sticking += static_cast<int>(step.report.residual.stick);
      }
  MESSAGE("contacts that slide: ", sliding, ", that stick: ", sticking, ", further solutions: ", several);
  CHECK(sliding > 50);
  CHECK(sticking > 50);
}

TEST_CASE("relaxation: a resting disk is given that part of what its weight still lacks in every sweep") {
  for (const double relaxation : {0.7, 1.0, 1.5})
    for (const Index sweeps : {Index{1}, Index{2}, Index{5}}) {
      INFO("relaxation = ", relaxation, ", sweeps = ", sweeps);
      Dynamics dynamics = tight();
      dynamics.boundaries = {floor_wall()};
      dynamics.solver.contact_relaxation = relaxation;
      dynamics.solver.criterion = "none";
      dynamics.solver.maximum_iterations = sweeps;
      const GranularStep<2> step = solve_step(simulation_of({{.y = 0.5, .mass = 2}}, dynamics));
      const double lacking = std::pow(1 - relaxation, static_cast<double>(sweeps));
      CHECK(step.contacts.at(0).impulse.n == doctest::Approx((1 - lacking) * 2 * g * 0.005).epsilon(1e-13));
    }
}

TEST_CASE("residual: sums of parts add up entry by entry, and both ways to slide are slides") {
  const ContactResidual sum = added_up(
      {{1, 2, 3, 4, 5, 6, 7, 8, 90, 10, 11, 12, 13}, {10, 20, 30, 40, 50, 60, 70, 80, 9, 100, 110, 120, 130}}, {});
  CHECK(std::array{sum.natural_map, sum.impulses, sum.violation, sum.work, sum.scale_work, sum.scale_velocity,
                   sum.squared_work} == std::array{11.0, 22.0, 33.0, 44.0, 55.0, 66.0, 77.0});
  CHECK(std::array{sum.largest_violation, sum.largest_squared_work} == std::array{80.0, 90.0});
  CHECK(std::array{sum.active, sum.stick, sum.slide, sum.loaded} == std::array<Index, 4>{110, 121, 132, 143});

  Dynamics dynamics = tight();
  dynamics.boundaries = {floor_wall()};
  dynamics.interaction.friction = 0.3;
  for (const double speed : {-3.0, 3.0}) {
    const GranularStep<2> step =
        solve_step(simulation_of({{.y = 0.5, .velocity_x = speed, .velocity_y = -1}}, dynamics));
    CHECK((step.report.residual.slide == 1 && step.report.residual.stick == 0));
  }
}

TEST_CASE("glued copies: their masses add up, and in their speed rims count as much as centres") {
  const Simulation simulation = simulation_of({{.x = 0, .y = 0.5}, {.x = 1, .y = 0.5}, {.x = 2, .y = 0.5}}, tight());
  const GranularStep<2> step = solve_step(simulation);
  REQUIRE(step.contacts.size() == 2);
  GranularDecomposition<2> parts =
      decompose(step.problem, {.subdomains = 2, .subdomain_of_contact = {0, 1}}, "natural", 1);
  REQUIRE(parts.interface.gluing().size() == 1);
  double mass = 0;  // of all copies together
  for (const GranularSubdomain<2>& subdomain : parts.subdomains)
    for (const GrainVelocity<2>& v : subdomain.velocities) mass += 1 / v.inverse_mass;
  CHECK(mass == doctest::Approx(3));
  for (GranularSubdomain<2>& subdomain : parts.subdomains)
    for (GrainVelocity<2>& v : subdomain.velocities) v.x = v.y = v.rim = 2;
  CHECK(parts.glued_speed_squared(0) + parts.glued_speed_squared(1) == 2 * (4 + 4 + 4));
}

TEST_CASE("natural map: zero on every status, positive as soon as a law is broken") {
  const double mu = 0.5, rho = 0.7;
  const auto size = [&](LocalVector<2> r, LocalVector<2> v) {
    const LocalVector<2> residual = natural_map(r, v, mu, rho);
    return std::hypot(residual.n, residual.t);
  };
  CHECK(size({0, 0}, {0.3, -2}) == 0);     // open
  CHECK(size({0, 0}, {0, 4}) < 1e-15);     // touching, sliding without pressure
  CHECK(size({2, 0.9}, {0, 0}) == 0);      // stick inside the cone
  CHECK(size({2, -1}, {0, 3}) < 1e-15);    // slides forward, friction backward
  CHECK(size({2, 1}, {0, -0.2}) < 1e-15);  // slides backward
  CHECK(size({2, 1}, {0, 3}) > 0.1);       // friction that pushes
  CHECK(size({2, -0.5}, {0, 3}) > 0.1);    // slides inside the cone
  CHECK(size({2, -1.5}, {0, 0}) > 0.1);    // outside the cone
  CHECK(size({0, 0}, {-0.3, 0}) > 0.1);    // penetrates
  CHECK(size({1, 0}, {0.3, 0}) > 0.1);     // pushes at a distance
  CHECK(size({-1, 0}, {0, 0}) > 0.1);      // pulls
}

TEST_CASE("residual: a resting disk whose reaction lacks d is off by d, by d / m in velocity") {
  Dynamics dynamics = tight();
  dynamics.boundaries = {floor_wall()};
  const Simulation simulation = simulation_of({{.y = 0.5, .mass = 2}}, dynamics);
  const GranularStep<2> step = solve_step(simulation);
  REQUIRE(step.contacts.size() == 1);
  const double whole = 2 * g * 0.005, d = 0.3 * whole;
  StepProblem<2> lacking = step.problem;
  lacking.contacts[0].impulse.n = whole - d;
  const GranularDecomposition<2> parts =
      decompose(lacking, {.subdomains = 1, .subdomain_of_contact = {0}}, "natural", 1);
  const std::vector<GrainVelocity<2>> v = velocities_of(lacking, lacking.contacts);
  const ContactResidual off = contact_residual(Coulomb{}, parts.subdomains[0].contacts, v);
  CHECK(std::sqrt(off.natural_map) == doctest::Approx(d).epsilon(1e-12));
  CHECK(off.relative_natural_map() == doctest::Approx(0.3 / 0.7).epsilon(1e-12));
  CHECK(std::sqrt(off.violation) == doctest::Approx(d / 2).epsilon(1e-12));
  // mean of |W r|^2 and |W r'|^2 with r' = whole
  CHECK(off.quad_dv() == doctest::Approx(0.3 / std::sqrt((0.49 + 1) / 2)).epsilon(1e-12));
  // (r' + r)/2 W (r' - r) over the mean of r W r and r' W r'
  CHECK(off.mean_dv_over_r() == doctest::Approx(0.85 * 0.3 / ((0.49 + 1) / 2)).epsilon(1e-12));
  CHECK((off.active == 1 && off.stick == 1));
}
