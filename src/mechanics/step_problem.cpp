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

// Adds one body per contact of a wall that impulses do not move. `first`: see first_motions. Returns the bodies of each
// contact.
template <int D>
std::vector<std::array<Index, 2>> add_wall_bodies(StepProblem<D>& problem, const GranularSystem& system,
                                                  const Configuration& where, const std::vector<RigidVelocity>& first) {
  std::vector<std::array<Index, 2>> bodies;
  bodies.reserve(problem.geometry.size());
  const Index given = count(problem.numbers);
  for (const StepContact& c : problem.geometry) {
    const Index a = body_of(problem, system.node_of(c.a)), node = system.node_of(c.b);
    if (node >= 0) {
      bodies.push_back({a, body_of(problem, node)});
      continue;
    }
    bodies.push_back({a, count(problem.free)});
    const Wall& wall = where.walls[at(c.b - system.grains())];
    const std::size_t k = at(wall.boundary);
    const Place before = velocity_of_point(first[k], where.poses[k], c.point), now = where.velocity(wall, c.point);
    problem.free.push_back(with_motion<D>({now[0], now[1], now[2]}, 0));
    problem.start.push_back(with_motion<D>({before[0], before[1], before[2]}, 0));
  }
  for (Index k = given; k < count(problem.free); ++k)
    problem.numbers.push_back(static_cast<std::int32_t>(system.bodies() + k - given));
  return bodies;
}

// The lever of a contact on the grain or wall `body`, sign -1 for a and +1 for b.
template <int D>
Lever<D> lever_on(const StepStart& start, const Configuration& where, const StepContact& c, Index body, double sign) {
  const auto& [system, state, interaction, scheme] = start;
  const Direction<D> normal = narrowed<D>(c.normal);
  const auto directions = contact_directions<D>();
  const Index node = system.node_of(body);
  Lever<D> lever;
  if (node < system.grains()) {  // a grain, a driven one or a wall
    for (std::size_t d = 0; d < D; ++d) lever.rows[d] = impulse_on_grain(normal, sign, directions[d]);
    lever.moves.fill(1);
    return lever;
  }
  const Index k = system.boundary_of(body);
  const FreeBody& own = *system.boundaries[at(k)].body;
  const Pose& pose = where.poses[at(k)];
  const Place point =
      body < system.grains() ? moved_along(where.centre(at(body)), -sign * system.radius[at(body)], c.normal) : c.point;
  const Place arm = difference(point, {pose.x, pose.y, pose.z});
  const std::array<double, 3> rims = own.rims(system.dimension);
  const Eigen::Matrix3d axes = principal_axes(own, turn_at_contacts(system, state, scheme, k));
  for (std::size_t d = 0; d < D; ++d) {
    const auto on_b = impulse_on_grain(normal, 1, directions[d]);  // its first D numbers are the direction
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    for (std::size_t j = 0; j < D; ++j) direction[static_cast<Index>(j)] = on_b[j];
    const Eigen::Vector3d turn = Eigen::Vector3d::Map(arm.data()).cross(direction);
    for (std::size_t j = 0; j < D; ++j) lever.rows[d][j] = sign * on_b[j];
    if constexpr (D == 2)
      lever.rows[d][2] = sign * turn[2] / rims[2];
    else
      for (Index j = 0; j < 3; ++j) lever.rows[d][at(3 + j)] = sign * axes.col(j).dot(turn) / rims[at(j)];
  }
  for (std::size_t j = 0; j < lever.moves.size(); ++j)
    lever.moves[j] = own.directions[j < D ? j : D == 2 ? 5 : j] ? 1 : 0;
  return lever;
}

// The levers of a contact with a body with free directions; null for others.
template <int D>
std::shared_ptr<const Levers<D>> levers_of(const StepStart& start, const Configuration& where, const StepContact& c) {
  const GranularSystem& system = start.system;
  if (std::max(system.node_of(c.a), system.node_of(c.b)) < system.grains()) return nullptr;
  return std::make_shared<const Levers<D>>(lever_on<D>(start, where, c, c.a, -1), lever_on<D>(start, where, c, c.b, 1));
}

template <int D>
GrainContact<D> solver_contact(const StepContact& c, const std::array<Index, 2>& bodies, const StepProblem<D>& problem,
                               const Interaction& interaction, double correction, double push,
                               std::shared_ptr<const Levers<D>> levers, bool boundary, const PairRule* rule) {
  const GrainVelocity<D>&a = problem.free[at(bodies[0])], &b = problem.free[at(bodies[1])];
  const bool driven = boundary || a.inverse_mass == 0 || b.inverse_mass == 0;
  GrainContact<D> k{.a = static_cast<std::int32_t>(bodies[0]),
                    .b = static_cast<std::int32_t>(bodies[1]),
                    .normal = narrowed<D>(c.normal),
                    .inverse_mass_a = a.inverse_mass,
                    .inverse_mass_b = b.inverse_mass,
                    .bias = {c.gap > 0 ? c.gap / problem.h : std::max(correction * c.gap / problem.h, -push), {}},
                    .friction = driven ? problem.boundary_friction : problem.friction,
                    .levers = std::move(levers)};
  if (rule != nullptr && rule->friction && problem.rubs) k.friction = *rule->friction;
  if (interaction.on_velocity() || problem.tangential_bias) {
    const auto own = [&](auto restitution) {
      return rule != nullptr && rule->*restitution ? *(rule->*restitution) : std::optional<double>();
    };
    const LocalVector<D> before = relative_velocity(k, problem.start);
    if (interaction.on_velocity())
      k.bias.n = own(&PairRule::restitution).value_or(interaction.restitution) * std::min(0.0, before.n);
    k.bias.t = own(&PairRule::tangential_restitution).value_or(interaction.tangential_restitution) * before.t;
  }
  return k;
}

// A lever on spins in place of the speeds of rims.
template <int D>
Lever<D> on_spins(Lever<D> lever, const std::array<double, 3>& rims) {
  for (auto& row : lever.rows)
    for (std::size_t k = D; k < row.size(); ++k) row[k] *= rims[D == 2 ? k : k - D];
  return lever;
}

// Relative velocity of a contact by the driven unknowns of bodies with free directions.
template <int D>
LocalVector<D> driven_part(const GrainContact<D>& c, const std::vector<GrainVelocity<D>>& bodies) {
  LocalVector<D> sum;
  for (const auto& [lever, body] : {std::pair(&c.levers->a, c.a), std::pair(&c.levers->b, c.b)}) {
    const GrainVelocity<D>& v = bodies[at(body)];
    if (v.inverse_mass == 0) continue;  // counted whole
    GrainUnknowns<D> own = unknowns(v);
    for (std::size_t k = 0; k < own.size(); ++k) own[k] *= 1 - lever->moves[k];
    sum = sum + lever->velocity(own);
  }
  return sum;
}

}  // namespace

template <int D>
StepProblem<D> step_of_contacts(const StepStart& start, std::vector<StepContact> geometry, double boundary_speed,
                                std::vector<std::int32_t> numbers, const std::vector<RememberedImpulse>& last) {
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
  problem.rubs = rubs;
  problem.tangential_bias = interaction.tangential_restitution > 0;
  for (const auto& [colours, rule] : system.pairs.rules) {
    problem.own_frictions = problem.own_frictions || (rubs && rule.friction);
    problem.tangential_bias = problem.tangential_bias || rule.tangential_restitution.value_or(0) > 0;
  }
  problem.geometry = std::move(geometry);
  problem.numbers = std::move(numbers);
  problem.start.reserve(problem.numbers.size());
  problem.free.reserve(problem.numbers.size());
  for (const std::int32_t i : problem.numbers) {
    problem.start.push_back(with_motion<D>(start_motion(start, first, i), system.inverse_mass(i)));
    problem.free.push_back(with_motion<D>(free_motion(start, motions, i), system.inverse_mass(i)));
  }
  const Configuration where = where_contacts_are(start);
  const auto bodies = add_wall_bodies<D>(problem, system, where, first);
  const bool levers = !system.free_bodies.empty();
  double scale = 0;
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    problem.contacts.push_back(solver_contact<D>(c, bodies[k], problem, interaction, scheme.penetration_correction,
                                                 push_speed(scheme, system.smaller_radius(c.a, c.b), boundary_speed),
                                                 levers ? levers_of<D>(start, where, c) : nullptr,
                                                 system.is_boundary(c.a) || system.is_boundary(c.b),
                                                 system.pairs.of(c.a, c.b)));
    if (problem.pulls && hold(system, interaction, c)) problem.contacts.back().pull = pull;
    scale += 1 / inverse_normal_delassus(problem.contacts.back());
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
  std::vector<StepContact> found;
  found.reserve(at(3 * start.system.grains()));
  const auto considered = for_each_step_contact(start, [&](const StepContact& c) { found.push_back(c); });
  if (shallow) check_overlaps(start, considered.deep);
  std::vector<std::int32_t> numbers(at(start.system.bodies()));
  std::iota(numbers.begin(), numbers.end(), 0);
  return step_of_contacts<D>(start, sorted_by_bodies(found, start.system.grains()), considered.boundary_speed,
                             std::move(numbers), warm_start ? start.state.impulses : std::vector<RememberedImpulse>{});
}

template <int D>
GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<D>>& bodies,
                                       const std::vector<GrainContact<D>>& contacts,
                                       const std::function<std::array<double, 3>(Index)>& rims) {
  std::vector<BodyRows> rows_of(bodies.size());  // lever arms are radii; driven bodies, such as walls, have no rows
  std::vector<std::array<double, 3>> rims_of(bodies.size());
  std::vector<double> inertia, momentum;
  std::vector<GrainVelocity<D>> driven = bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].inverse_mass == 0) continue;
    rims_of[i] = rims(static_cast<Index>(i));
    rows_of[i] = {count(inertia), rims_of[i][2]};
    const double m = 1 / bodies[i].inverse_mass;
    const GrainUnknowns<D> v = unknowns(bodies[i]);
    for (Index k = 0; k < unknowns_of_grain<D>; ++k) {
      const double mass = m * inertia_ratio<D>(k), arm = k < D ? 1 : rims_of[i][at(D == 2 ? k : k - D)];
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
    const BodyRows &a = rows_of[at(k.a)], &b = rows_of[at(k.b)];
    std::optional<Levers<D>> levers;
    if (k.levers) levers = Levers<D>{on_spins(k.levers->a, rims_of[at(k.a)]), on_spins(k.levers->b, rims_of[at(k.b)])};
    for (const LocalVector<D>& direction : contact_directions<D>())
      levers ? h.add_levers(*levers, a, b, direction) : h.add(k.normal, a, b, direction);
    const LocalVector<D> carried = relative_velocity(k, driven) + k.bias;
    set_component<D>(problem.w, c, k.levers ? carried + driven_part(k, bodies) : carried);
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
                                                const std::vector<GrainContact<2>>&,
                                                const std::function<std::array<double, 3>(Index)>&);
template GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<3>>&,
                                                const std::vector<GrainContact<3>>&,
                                                const std::function<std::array<double, 3>(Index)>&);

}  // namespace nscdd
