// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_problem.hpp"

#include "mechanics/contact_blocks.hpp"
#include "packing/grain_grid.hpp"
#include <nscdd/mechanics/friction_problem.hpp>

namespace nscdd {
namespace {

// Largest speed at which overlapping bodies are pushed apart, m/s: `maximum_push_speed` or, if that is negative,
// c (sqrt(g r) + w), c = natural_push_speed, with the smaller radius r, g = |gravity| and the speed w of the fastest
// boundary. A push of bodies at rest brings at most c^2/2 of the energy m g r that lifts a grain by its radius. Speeds
// of N overlaps above each other add up: a column gains c^2 N/12 of its weight times its height, 0.3 % for a hundred
// grains, for any overlaps, grains and step. Without gravity, and with boundaries at rest, overlaps stay.
double push_speed(const TimeStepping& scheme, double smaller_radius, double boundary_speed) {
  constexpr double natural_push_speed = 0.02;
  if (scheme.maximum_push_speed >= 0) return scheme.maximum_push_speed;
  const double gravity = std::hypot(scheme.gravity[0], scheme.gravity[1], scheme.gravity[2]);
  return natural_push_speed * (std::sqrt(gravity * smaller_radius) + boundary_speed);
}

// Adds one body per wall contact, which moves as the wall does under the grain. `first`: see first_motions. Returns the
// bodies of each contact.
template <int D>
std::vector<std::array<Index, 2>> add_wall_bodies(StepProblem<D>& problem, const GranularSystem& system,
                                                  const Configuration& where, const std::vector<RigidVelocity>& first) {
  std::vector<std::array<Index, 2>> bodies;
  bodies.reserve(problem.geometry.size());
  const Index grains = count(problem.numbers);
  for (const StepContact& c : problem.geometry) {
    const Index a = body_of(problem, c.a);
    if (c.b < system.grains()) {
      bodies.push_back({a, body_of(problem, c.b)});
      continue;
    }
    bodies.push_back({a, count(problem.free)});
    const Wall& wall = where.walls[at(c.b - system.grains())];
    const std::size_t k = at(wall.boundary);
    const Place before = velocity_of_point(first[k], where.poses[k], c.point), now = where.velocity(wall, c.point);
    problem.free.push_back(with_motion<D>({now[0], now[1], now[2]}, 0));
    problem.start.push_back(with_motion<D>({before[0], before[1], before[2]}, 0));
  }
  for (Index k = grains; k < count(problem.free); ++k)
    problem.numbers.push_back(static_cast<std::int32_t>(system.grains() + k - grains));
  return bodies;
}

template <int D>
GrainContact<D> solver_contact(const StepContact& c, const std::array<Index, 2>& bodies, const StepProblem<D>& problem,
                               const Interaction& interaction, double correction, double push) {
  const GrainVelocity<D>&a = problem.free[at(bodies[0])], &b = problem.free[at(bodies[1])];
  const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
  GrainContact<D> k{.a = static_cast<std::int32_t>(bodies[0]),
                    .b = static_cast<std::int32_t>(bodies[1]),
                    .normal = narrowed<D>(c.normal),
                    .inverse_w = grain_delassus(a, b),
                    .bias = {c.gap > 0 ? c.gap / problem.h : std::max(correction * c.gap / problem.h, -push), {}},
                    .friction = driven ? problem.boundary_friction : problem.friction};
  if (interaction.on_velocity() || interaction.tangential_restitution > 0) {
    const LocalVector<D> before = relative_velocity(k, problem.start);
    if (interaction.on_velocity()) k.bias.n = interaction.restitution * std::min(0.0, before.n);
    k.bias.t = interaction.tangential_restitution * before.t;
  }
  return k;
}

}  // namespace

template <int D>
StepProblem<D> step_of_contacts(const StepStart& start, std::vector<StepContact> geometry, double boundary_speed,
                                std::vector<std::int32_t> grains, const std::vector<RememberedImpulse>& last) {
  const auto& [system, state, interaction, scheme] = start;
  const auto first = first_motions(system, state, scheme), motions = step_motions(system, state, scheme);
  StepProblem<D> problem;
  problem.h = scheme.step;
  set_scale(problem, interaction, 1);
  const auto [rubs, pulls, pull] =
      std::visit([](const auto& law) { return std::tuple(law.rubs, law.pulls, law.pull()); }, problem.law);
  problem.friction = rubs ? interaction.friction : 0;
  problem.boundary_friction = rubs ? interaction.friction_at_boundaries() : 0;
  problem.pulls = pulls;
  problem.tangential_bias = interaction.tangential_restitution > 0;
  problem.geometry = std::move(geometry);
  problem.numbers = std::move(grains);
  problem.start.reserve(problem.numbers.size());
  problem.free.reserve(problem.numbers.size());
  for (const std::int32_t i : problem.numbers) {
    problem.start.push_back(with_motion<D>(start_motion(start, first, i), system.inverse_mass(i)));
    problem.free.push_back(with_motion<D>(free_motion(start, motions, i), system.inverse_mass(i)));
  }
  const auto bodies = add_wall_bodies<D>(problem, system, where_contacts_are(start), first);
  double scale = 0;
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    problem.contacts.push_back(solver_contact<D>(c, bodies[k], problem, interaction, scheme.penetration_correction,
                                                 push_speed(scheme, system.smaller_radius(c.a, c.b), boundary_speed)));
    if (problem.pulls && touches(system, c)) problem.contacts.back().pull = pull;
    scale += 1 / problem.contacts.back().inverse_w.inverse_n;
  }
  set_scale(problem, interaction, scale / std::max(1.0, static_cast<double>(problem.contacts.size())));
  const auto impulses = remembered(last, problem.geometry);
  for (std::size_t k = 0; k < impulses.size(); ++k)
    if (impulses[k] != nullptr)
      problem.contacts[k].impulse = recalled<D>(impulses[k]->impulse, problem.contacts[k].normal);
  return problem;
}

template <int D>
StepProblem<D> prepare_step(const StepStart& start, bool warm_start, bool shallow) {
  const Index grains = start.system.grains();
  std::vector<StepContact> found;
  found.reserve(at(3 * grains));
  const auto considered = for_each_step_contact(start, [&](const StepContact& c) { found.push_back(c); });
  if (shallow) check_overlaps(start, considered.deep);
  std::vector<std::int32_t> numbers(at(grains));
  std::iota(numbers.begin(), numbers.end(), 0);
  return step_of_contacts<D>(start, sorted_by_bodies(found, grains), considered.boundary_speed, std::move(numbers),
                             warm_start ? start.state.impulses : std::vector<RememberedImpulse>{});
}

template <int D>
GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<D>>& bodies,
                                       const std::vector<GrainContact<D>>& contacts, std::span<const double> radius) {
  std::vector<BodyRows> rows_of(bodies.size());  // lever arms are radii; driven bodies, such as walls, have no rows
  std::vector<double> inertia, momentum;
  std::vector<GrainVelocity<D>> driven = bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].inverse_mass == 0) continue;
    rows_of[i] = {count(inertia), radius[i]};
    const double m = 1 / bodies[i].inverse_mass;
    const GrainUnknowns<D> v = unknowns(bodies[i]);
    for (Index k = 0; k < unknowns_of_grain<D>; ++k) {
      const double mass = m * inertia_ratio<D>(k), arm = k < D ? 1 : radius[i];  // v is the speed of the rim
      inertia.push_back(mass * arm * arm);
      momentum.push_back(mass * arm * v[at(k)]);
    }
    driven[i] = with_unknowns(GrainUnknowns<D>{}, bodies[i].inverse_mass);
  }
  const Index rows = count(inertia), size = static_cast<Index>(contacts.size());
  GlobalFrictionProblem problem;
  problem.dimension = D;
  problem.mass = SparseMatrix(Vector::Map(inertia.data(), rows).asDiagonal());
  problem.f = Vector::Map(momentum.data(), rows);
  problem.w.resize(D * size);
  problem.friction.resize(size);
  ConnectivityBuilder<D> h(rows, D * contacts.size());
  for (Index c = 0; c < size; ++c) {
    const GrainContact<D>& k = contacts[at(c)];
    for (const LocalVector<D>& direction : contact_directions<D>())
      h.add(k.normal, rows_of[at(k.a)], rows_of[at(k.b)], direction);
    set_component<D>(problem.w, c, relative_velocity(k, driven) + k.bias);
    problem.friction[c] = k.friction;
  }
  problem.h = h.matrix();
  return problem;
}

template StepProblem<2> step_of_contacts(const StepStart&, std::vector<StepContact>, double, std::vector<std::int32_t>,
                                         const std::vector<RememberedImpulse>&);
template StepProblem<3> step_of_contacts(const StepStart&, std::vector<StepContact>, double, std::vector<std::int32_t>,
                                         const std::vector<RememberedImpulse>&);
template StepProblem<2> prepare_step(const StepStart&, bool, bool);
template StepProblem<3> prepare_step(const StepStart&, bool, bool);
template GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<2>>&,
                                                const std::vector<GrainContact<2>>&, std::span<const double>);
template GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<3>>&,
                                                const std::vector<GrainContact<3>>&, std::span<const double>);

}  // namespace nscdd
