// SPDX-License-Identifier: GPL-3.0-or-later
// Subdomains that become linear while their statuses stand still: what they answer, when they go back, and that a run
// comes to the same end with them.
#include "two_stage/model_switch.hpp"

#include "../support/dense.hpp"
#include "../support/granular.hpp"
#include "linalg/threads.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace nscdd;
using namespace nscdd::testing;

namespace {

Dynamics divided(SwitchedModel model) {
  Dynamics dynamics = tight();
  dynamics.interaction.friction = 0.4;
  dynamics.solver = switching(model);
  return dynamics;
}

// A crooked column of disks that is about to topple: every contact sticks, and there is one way to carry the loads.
Simulation column(SwitchedModel model) {
  std::vector<Grain> grains;
  for (Index k = 0; k < 8; ++k)
    grains.push_back({k % 2 == 0 ? 0.0 : 0.2, 0.5 + std::sqrt(0.96) * static_cast<double>(k), 0.5,
                      1 + 0.1 * static_cast<double>(k)});
  Dynamics dynamics = divided(model);
  dynamics.interaction.friction = 2;
  dynamics.boundaries.push_back(floor_wall());
  return simulation_of(grains, dynamics, {1, 4});
}

// M, G, N and the biases of a subdomain at frozen statuses, dense, in (x, y, rim) of all bodies, written out from the
// definitions of GrainContact<2>. A driven body has rows, but no power: those of G are zero.
struct DenseNetwork {
  Vector mass, velocities, bias;
  Matrix g, rest;
};

DenseNetwork dense_network(const GranularSubdomain<2>& subdomain, const std::vector<ContactStatus>& statuses) {
  const Index n = 3 * count(subdomain.velocities);
  std::vector<Vector> g, rest;
  std::vector<double> bias;
  for (std::size_t k = 0; k < statuses.size(); ++k) {
    if (statuses[k] == ContactStatus::open) continue;
    const GrainContact<2> c = subdomain.contacts.contact(k, subdomain.velocities);
    const auto [x, y] = c.normal;
    Vector normal = Vector::Zero(n), tangent = Vector::Zero(n);
    normal.segment<3>(3 * c.a) << -x, -y, 0;
    normal.segment<3>(3 * c.b) << x, y, 0;
    tangent.segment<3>(3 * c.a) << y, -x, -1;
    tangent.segment<3>(3 * c.b) << -y, x, -1;
    const bool stick = statuses[k] == ContactStatus::stick;
    const double mu = stick ? 0 : statuses[k] == ContactStatus::slide_backward ? c.friction : -c.friction;
    g.emplace_back(normal + mu * tangent);
    rest.push_back(normal);
    bias.push_back(c.bias.n);
    if (!stick) continue;
    g.push_back(tangent);
    rest.push_back(tangent);
    bias.push_back(c.bias.t);
  }
  DenseNetwork dense{Vector(n), Vector(n), Vector::Map(bias.data(), count(bias)), Matrix(n, count(g)),
                     Matrix(n, count(g))};
  for (Index column = 0; column < count(g); ++column) {
    dense.g.col(column) = g[at(column)];
    dense.rest.col(column) = rest[at(column)];
  }
  for (Index i = 0; i < count(subdomain.velocities); ++i) {
    const GrainVelocity<2>& v = subdomain.velocities[at(i)];
    const double mass = v.inverse_mass > 0 ? 1 / v.inverse_mass : 1;
    dense.mass.segment<3>(3 * i) << mass, mass, mass / 2;
    dense.velocities.segment<3>(3 * i) << v.x, v.y, v.rim;
    if (v.inverse_mass == 0) dense.g.middleRows(3 * i, 3).setZero();
  }
  return dense;
}

std::vector<GrainVelocity<2>> moved(std::vector<GrainVelocity<2>> v, const Vector& change) {
  for (Index i = 0; i < count(v); ++i) {
    v[at(i)].x += change[3 * i];
    v[at(i)].y += change[3 * i + 1];
    v[at(i)].rim += change[3 * i + 2];
  }
  return v;
}

// M (V - V_0) = G d, N^T V + bias = -alpha d as one dense system in V and d. Returns the velocities.
std::vector<GrainVelocity<2>> frozen_by_hand(const GranularSubdomain<2>& subdomain,
                                             const std::vector<ContactStatus>& statuses, double alpha) {
  const DenseNetwork dense = dense_network(subdomain, statuses);
  const Index n = dense.mass.size(), columns = dense.g.cols();
  Matrix system = Matrix::Zero(n + columns, n + columns);
  system.topLeftCorner(n, n).diagonal() = dense.mass;
  system.topRightCorner(n, columns) = -dense.g;
  system.bottomLeftCorner(columns, n) = dense.rest.transpose();
  system.bottomRightCorner(columns, columns).diagonal().setConstant(alpha);
  Vector right = Vector::Zero(n + columns);
  right.tail(columns) = -dense.bias - dense.rest.transpose() * dense.velocities;
  return moved(subdomain.velocities, solve(system, right).head(n));
}

// (S^T (M + G N^T / alpha) S) U = -S^T G (N^T V_0 + bias) / alpha, V = V_0 + S U, dense, with the functions S of a mesh
// over the box of the bodies that are not kept.
std::vector<GrainVelocity<2>> homogenised_by_hand(const GranularSubdomain<2>& subdomain,
                                                  const std::vector<ContactStatus>& statuses, double alpha,
                                                  const std::vector<PlacedBody>& bodies, Index cells) {
  const DenseNetwork dense = dense_network(subdomain, statuses);
  double left = infinity, right = -infinity, low = infinity, high = -infinity;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].kept || subdomain.velocities[i].inverse_mass == 0) continue;
    left = std::min(left, bodies[i].centre[0]);
    right = std::max(right, bodies[i].centre[0]);
    low = std::min(low, bodies[i].centre[1]);
    high = std::max(high, bodies[i].centre[1]);
  }
  const auto hat = [&](double s, Index node) {  // s from 0 to 1
    return std::max(0.0, 1 - std::abs(s * static_cast<double>(cells) - static_cast<double>(node)));
  };
  std::vector<Vector> shapes;
  const Index n = dense.mass.size();
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (Index k = 0; bodies[i].kept && k < 3; ++k) shapes.push_back(Vector::Unit(n, static_cast<Index>(3 * i) + k));
  for (Index across = 0; across <= cells; ++across)
    for (Index up = 0; up <= cells; ++up)
      for (Index k = 0; k < 3; ++k) {
        Vector shape = Vector::Zero(n);
        for (std::size_t i = 0; i < bodies.size(); ++i) {
          if (bodies[i].kept || subdomain.velocities[i].inverse_mass == 0) continue;
          shape[static_cast<Index>(3 * i) + k] = hat((bodies[i].centre[0] - left) / (right - left), across) *
                                                 hat((bodies[i].centre[1] - low) / (high - low), up) *
                                                 (k == 2 ? bodies[i].radius : 1);
        }
        shapes.push_back(shape);
      }
  Matrix s(n, count(shapes));
  for (Index column = 0; column < s.cols(); ++column) s.col(column) = shapes[at(column)];
  const Dense g = dense.g, n_transposed = Dense(dense.rest).transpose(), shape = s;
  const Dense whole = diagonal(dense.mass) + g * n_transposed / alpha;
  const Vector load = -(g * Vector(n_transposed * dense.velocities + dense.bias)) / alpha;
  const Vector amplitudes = least_norm_solution(shape.transpose() * whole * shape, shape.transpose() * load);
  return moved(subdomain.velocities, shape * amplitudes);
}

// A disk on a wall and a second beside it, gap 0.1 at a step of 0.005 s, as one subdomain: after some sweeps the first
// sticks with a normal impulse, and the second touches nothing.
struct OnTheFloor {
  GranularDecomposition<2> parts;
  ContactLaw law = Coulomb{};
  ModelSwitch<2>::Sweeps sweeps = [this](GranularSubdomain<2>& one) {
    return gauss_seidel_sweep(law, one.contacts, one.velocities);
  };
  Vector none = Vector::Zero(0);
  ModelSwitch<2> model;

  static GranularDecomposition<2> parts_of() {
    Dynamics dynamics = tight();
    dynamics.interaction.friction = 0.5;
    dynamics.time.alert = 1;
    dynamics.boundaries.push_back(floor_wall());
    const PreparedStep<2> step = prepare_solution(simulation_of({{0, 0.5}, {1.1, 0.5}}, dynamics));
    return decompose(step.share.problem, step.share.partition, ContactOrder::natural, 0);
  }
  OnTheFloor() : parts(parts_of()), model(parts, 0, law, {.after = 3, .flexibility = 1e-6}, 0) {
    for (int k = 0; k < 6; ++k) model.stage_one(parts, sweeps, none);
  }
  GranularSubdomain<2>& subdomain() { return parts.subdomains[0]; }
  RememberedModel report() { return model.report(parts, sweeps, none); }
};

}  // namespace

TEST_CASE("a linear subdomain answers what a dense solve of its frozen network does, sliding or not, pushed or not") {
  Dynamics dynamics = divided(SwitchedModel::none);
  PreparedStep<2> step = prepare_solution(box_of_grains(60, dynamics, {2, 1}));
  for (int k = 0; k < 300; ++k) step.iteration.iterate();
  for (GranularSubdomain<2> subdomain : step.iteration.parts().subdomains) {
    const auto statuses = statuses_of(step.share.problem.law, subdomain);
    REQUIRE(std::ranges::count(statuses, ContactStatus::stick) > 3);
    REQUIRE(std::ranges::count(statuses, ContactStatus::open) > 0);
    REQUIRE(std::ranges::count_if(statuses, [](auto s) { return s > ContactStatus::stick; }) > 3);
    for (const double alpha : {1e-2, 1e-6}) {
      LinearSubdomain<2> linear(subdomain, step.share.problem.law, statuses, alpha * step.share.problem.scale);
      REQUIRE(linear.regular());
      for (int push = 0; push < 2; ++push) {
        GranularSubdomain<2> pushed = subdomain;  // as Stage 2 does
        if (push == 1) pushed.velocities[1].x += pushed.velocities[1].inverse_mass > 0 ? 0.01 : 0;
        const LinearAnswer<2> answer = linear.answer(pushed);
        const auto by_hand = frozen_by_hand(pushed, statuses, alpha * step.share.problem.scale);
        const Index bodies = count(by_hand);
        CHECK(largest_difference(answer.velocities, by_hand, bodies) < 1e-8 * largest_speed(by_hand, bodies));
      }
    }
  }
}

TEST_CASE("a homogenised subdomain is the dense Galerkin projection, and on a fine mesh the linear one") {
  const Simulation simulation = box_of_grains(60, divided(SwitchedModel::none), {2, 1});
  PreparedStep<2> step = prepare_solution(simulation);
  for (int k = 0; k < 300; ++k) step.iteration.iterate();
  const double alpha = 1e-2 * step.share.problem.scale;
  for (const GranularSubdomain<2>& subdomain : step.iteration.parts().subdomains) {
    const auto statuses = statuses_of(step.share.problem.law, subdomain);
    std::vector<PlacedBody> bodies;
    for (const Index i : subdomain.bodies) {
      const bool grain = i < simulation.system.grains();
      bodies.push_back({{grain ? simulation.state.x[at(i)] : 0, grain ? simulation.state.y[at(i)] : 0},
                        grain ? simulation.system.radius[at(i)] : 0,
                        step.iteration.parts().interface.multiplicity(i) > 1});
    }
    const auto homogenised = [&](const std::vector<PlacedBody>& placed, Index cells) {
      LinearSubdomain<2> model(subdomain, step.share.problem.law, statuses, alpha, [&](const FrozenNetwork& network) {
        return coarse_velocities(network, placed, {cells, cells});
      });
      REQUIRE(model.regular());
      return model.answer(subdomain).velocities;
    };
    const auto linear =
        LinearSubdomain<2>(subdomain, step.share.problem.law, statuses, alpha).answer(subdomain).velocities;
    const Index n = count(linear);
    const double speed = largest_speed(linear, n);
    for (const Index cells : {1, 2, 3}) {
      CAPTURE(cells);
      const auto coarse = homogenised(bodies, cells);
      CHECK(largest_difference(coarse, homogenised_by_hand(subdomain, statuses, alpha, bodies, cells), n) <
            1e-8 * speed);
      CHECK(largest_difference(coarse, linear, n) > 1e-4 * speed);
    }
    CHECK(largest_difference(homogenised(bodies, 40), linear, n) < 1e-8 * speed);
    for (PlacedBody& body : bodies) body.kept = true;
    CHECK(largest_difference(homogenised(bodies, 1), linear, n) < 1e-8 * speed);
  }
}

TEST_CASE("where statuses stand still, a run that switches comes to the velocities and impulses of one that does not") {
  Simulation plain = column(SwitchedModel::none), switched = column(SwitchedModel::linear);
  Index linear_iterations = 0, iterations = 0;
  for (int k = 0; k < 12; ++k) {
    const GranularStep<2> a = solve_step(plain), b = solve_step(switched);
    REQUIRE(a.report.status == SolverStatus::converged);
    REQUIRE(b.report.status == SolverStatus::converged);
    const Index disks = plain.system.grains();
    CHECK(largest_difference(a.velocities, b.velocities, disks) < 1e-6);
    for (std::size_t c = 0; c < a.contacts.size(); ++c)
      CHECK(std::hypot(a.contacts[c].impulse.n - b.contacts[c].impulse.n,
                       a.contacts[c].impulse.t - b.contacts[c].impulse.t) < 1e-6);
    for (const RememberedModel& model : b.models) linear_iterations += model.switched_iterations;
    iterations += b.report.last.iteration;
    take_step(plain, a);
    take_step(switched, b);
  }
  CHECK(linear_iterations > iterations);  // of four subdomains
}

TEST_CASE("a subdomain that is switched goes back in the iteration in which a contact would do what it cannot") {
  struct Push {
    const char* what;
    Index disk;
    double x, y;
  };
  for (const Push push : {Push{"pull", 0, 0, 1}, {"leave the cone", 0, 1, 0}, {"close a gap", 1, -50, 0}}) {
    CAPTURE(push.what);
    OnTheFloor one;
    REQUIRE(one.report().switched == 1);
    REQUIRE(one.report().switched_iterations == 2);
    GranularSubdomain<2>& subdomain = one.subdomain();
    const auto body = std::ranges::find(subdomain.bodies, push.disk) - subdomain.bodies.begin();
    subdomain.velocities[at(body)].x += push.x;
    subdomain.velocities[at(body)].y += push.y;
    GranularSubdomain<2> by_law = subdomain;
    one.sweeps(by_law);
    one.model.stage_one(one.parts, one.sweeps, one.none);
    CHECK(one.report().switched == 0);
    CHECK(one.report().switch_backs == 1);
    CHECK(one.report().standing == 0);
    for (std::size_t i = 0; i < by_law.velocities.size(); ++i) {
      CHECK(subdomain.velocities[i].x == by_law.velocities[i].x);
      CHECK(subdomain.velocities[i].y == by_law.velocities[i].y);
      CHECK(subdomain.velocities[i].rim == by_law.velocities[i].rim);
    }
  }
  OnTheFloor one;  // a push that friction holds
  const auto disk = std::ranges::find(one.subdomain().bodies, 0) - one.subdomain().bodies.begin();
  one.subdomain().velocities[at(disk)].x += 0.001;
  one.model.stage_one(one.parts, one.sweeps, one.none);
  CHECK(one.report().switched == 1);
  CHECK(one.report().switched_iterations == 3);
}

TEST_CASE("a run that switches has the same bits on any number of threads") {
  for (const SwitchedModel model : {SwitchedModel::linear, SwitchedModel::homogenised}) {
    std::vector<std::vector<double>> ends;
    Index switched = 0;
    for (const Index threads : {1, 2, 5}) {
      const ThreadLimit limit(threads);
      Dynamics dynamics = divided(model);
      dynamics.solver.warm_start = true;
      dynamics.solver.tolerance = 1e-6;
      dynamics.solver.maximum_iterations = 300;
      Simulation simulation = box_of_grains(80, dynamics, {3, 2});
      for (int k = 0; k < 3; ++k) {
        const GranularStep<2> step = solve_step(simulation);
        for (const RememberedModel& one : step.models) switched += one.switched_iterations;
        take_step(simulation, step);
      }
      ends.push_back(simulation.state.velocity_x);
      ends.back().insert(ends.back().end(), simulation.state.y.begin(), simulation.state.y.end());
    }
    CHECK(switched > 0);
    CHECK(ends[1] == ends[0]);
    CHECK(ends[2] == ends[0]);
  }
}
