// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_problem.hpp"

#include "linalg/sparse_entries.hpp"
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

// Adds one body per contact of a wall that impulses do not move. `first`: see first_motions. Returns its bodies.
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
    problem.numbers.push_back(static_cast<std::int32_t>(system.bodies() + count(problem.free) - given));
    const Wall& wall = where.walls[at(c.b - system.grains())];
    const std::size_t k = at(wall.boundary);
    const Place point = contact_point(system, where, c, c.b);
    const Place before = velocity_of_point(first[k], where.poses[k], point), now = where.velocity(wall, point);
    problem.free.push_back(with_motion<D>({now[0], now[1], now[2]}, 0));
    problem.start.push_back(with_motion<D>({before[0], before[1], before[2]}, 0));
  }
  return bodies;
}

template <int D>
GrainContact<D> solver_contact(const StepStart& start, const StepContact& c, const std::array<Index, 2>& bodies,
                               const StepProblem<D>& problem, double push, std::shared_ptr<const Levers<D>> levers,
                               bool slid) {
  const GrainVelocity<D>&a = problem.free[at(bodies[0])], &b = problem.free[at(bodies[1])];
  const Interaction& interaction = start.interaction;
  const double correction = start.scheme.penetration_correction;
  GrainContact<D> k{.a = static_cast<std::int32_t>(bodies[0]),
                    .b = static_cast<std::int32_t>(bodies[1]),
                    .normal = narrowed<D>(c.normal),
                    .inverse_mass_a = a.inverse_mass,
                    .inverse_mass_b = b.inverse_mass,
                    .bias = {c.gap > 0 ? (opens(problem.law) ? c.gap / problem.h : 0)
                                       : std::max(correction * c.gap / problem.h, -push),
                             {}},
                    .friction = problem.rubs && (levers == nullptr || levers->rubs()) ? friction_of(start, c, slid) : 0,
                    .levers = std::move(levers)};
  if (interaction.on_velocity() || problem.tangential_bias) {
    const PairRule& rule = start.system.pairs.of(c.a, c.b);
    const LocalVector<D> before = relative_velocity(k, problem.start);
    if (interaction.on_velocity())
      k.bias.n = rule.restitution.value_or(interaction.restitution) * std::min(0.0, before.n);
    k.bias.t = rule.tangential_restitution.value_or(interaction.tangential_restitution) * before.t;
  }
  return k;
}

// A bond obeys Coulomb's law at an impulse so large that it neither opens nor slides; `speed`, m/s: the largest of the
// step. `last`, N s: its impulse in the step before. `drift`, m: of its gap since it was made.
template <int D>
void make_bond(GrainContact<D>& contact, double strength, double speed, double last, double drift, double h) {
  constexpr double room = 10;
  contact.friction = 1;
  contact.bias = {drift / h, {}};
  contact.pull = std::max(strength * speed * inverse_normal_delassus(contact), room * last);
}

// The largest speed of a body in a step, rims included, and what gravity adds to it, m/s.
double largest_speed(const StepStart& start, const std::vector<Pose>& poses, const std::vector<RigidVelocity>& motions,
                     double boundary_speed) {
  double largest = boundary_speed;
  for (Index i = 0; i < start.system.bodies(); ++i) {
    const GrainVelocity<3> v = with_motion<3>(free_motion(start, poses, motions, i), 0);
    largest = std::max(largest, std::sqrt(squared_velocity(v) + squared_rim(v)));
  }
  const Place gravity = gravity_of(start.scheme, start.system.dimension);
  return largest + start.scheme.step * std::sqrt(dot(gravity, gravity));
}

// Solvers need a regular W of every contact. Tangential impulses that move no body, which are 0 without friction, move
// an unknown of their own, of mass 1/W_nn.
template <int D>
void add_idle_unknowns(GlobalFrictionProblem& problem, const std::vector<GrainContact<D>>& contacts) {
  SparseEntries h;
  std::vector<double> mass;
  const Index rows = problem.h.rows();
  for (std::size_t c = 0; c < contacts.size(); ++c)
    for (Index d = 1; d < D && contacts[c].levers != nullptr && !contacts[c].levers->rubs(); ++d) {
      h.add(rows + count(mass), D * static_cast<Index>(c) + d, 1);
      mass.push_back(inverse_normal_delassus(contacts[c]));
    }
  if (mass.empty()) return;
  h.add_block(problem.h, 0, 0);
  problem.h = h.matrix(rows + count(mass), problem.h.cols());
  Vector all(rows + count(mass));
  all << problem.mass.diagonal(), Vector::Map(mass.data(), count(mass));
  problem.mass = diagonal_matrix(all);
  problem.f.conservativeResizeLike(Vector::Zero(all.size()));
}

}  // namespace

template <int D>
StepProblem<D> step_of_contacts(const StepStart& start, std::vector<StepContact> geometry, double boundary_speed,
                                std::vector<std::int32_t> numbers, const std::vector<RememberedImpulse>& last,
                                bool warm_start) {
  const auto& [system, state, interaction, scheme] = start;
  const auto first = first_motions(start);
  StepProblem<D> problem;
  problem.h = scheme.step;
  set_scale(problem, interaction, 1);
  const auto [rubs, pulls, pull] =
      std::visit([](const auto& law) { return std::tuple(law.rubs, law.pulls, law.pull()); }, problem.law);
  problem.friction = rubs ? interaction.friction_of(false, true) : 0;
  problem.boundary_friction = rubs ? interaction.friction_of(true, true) : 0;
  problem.pulls = pulls;
  problem.rubs = rubs;
  problem.tangential_bias = interaction.tangential_restitution > 0;
  problem.own_frictions = rubs && interaction.static_friction >= 0;
  for (const auto& [colours, rule] : system.pairs.rules) {
    problem.own_frictions = problem.own_frictions || rule.bond || (rubs && (rule.friction || rule.static_friction));
    problem.tangential_bias = problem.tangential_bias || rule.tangential_restitution.value_or(0) > 0;
  }
  problem.geometry = std::move(geometry);
  problem.numbers = std::move(numbers);
  const Configuration where = where_contacts_are(start);
  problem.start.reserve(problem.numbers.size());
  problem.free.reserve(problem.numbers.size());
  for (const std::int32_t i : problem.numbers) {
    problem.start.push_back(with_motion<D>(start_motion(start, where.poses, first, i), system.inverse_mass(i)));
    problem.free.push_back(with_motion<D>(free_motion(start, where.poses, where.motions, i), system.inverse_mass(i)));
  }
  const auto bodies = add_wall_bodies<D>(problem, system, where, first);
  const auto known = remembered(last, problem.geometry);
  const bool bonds = system.pairs.bonds(), levers = !system.free_bodies.empty();
  const double speed = bonds ? largest_speed(start, where.poses, where.motions, boundary_speed) : 0;
  const double alert = bonds ? alert_distance(system, scheme) : 0;
  double scale = 0;
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    GrainContact<D>& contact = problem.contacts.emplace_back(solver_contact<D>(
        start, c, bodies[k], problem, push_speed(scheme, system.smaller_radius(c.a, c.b), boundary_speed),
        levers ? levers_of<D>(start, where, c) : nullptr, known[k] != nullptr && known[k]->slid));
    if (problem.pulls && hold(system, interaction, c)) contact.pull = pull;
    if (const auto bond = bonds ? bond_of(start, c, alert) : std::nullopt) {
      const auto& [x, y, z] = known[k] != nullptr ? known[k]->impulse : std::array<double, 3>{};
      make_bond(contact, interaction.bond_strength, speed, std::hypot(x, y, z), c.gap - bond->gap, problem.h);
    }
    if (warm_start && known[k] != nullptr) contact.impulse = recalled<D>(known[k]->impulse, contact.normal);
    scale += 1 / inverse_normal_delassus(contact);
  }
  set_scale(problem, interaction, scale / std::max(1.0, static_cast<double>(problem.contacts.size())));
  return problem;
}

template <int D>
StepProblem<D> prepare_step(const StepStart& start, bool warm_start, bool shallow) {
  std::vector<StepContact> found;
  found.reserve(at(3 * start.system.grains()));
  const auto considered = for_each_step_contact(start, [&](const StepContact& c) { found.push_back(c); });
  if (shallow) check_overlaps(start, considered.deep);
  return step_of_contacts<D>(start, sorted_by_bodies(found, start.system.grains()), considered.boundary_speed,
                             natural_order<std::int32_t>(start.system.bodies()), start.state.impulses, warm_start);
}

template <int D>
GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<D>>& bodies,
                                       const std::vector<GrainContact<D>>& contacts, const Rims& rims) {
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
  problem.mass = diagonal_matrix(Vector::Map(inertia.data(), rows));
  problem.f = Vector::Map(momentum.data(), rows);
  problem.w.resize(D * size);
  problem.friction.resize(size);
  ConnectivityBuilder<D> h(rows, D * contacts.size());
  for (Index c = 0; c < size; ++c) {
    const GrainContact<D>& k = contacts[at(c)];
    const BodyRows &a = rows_of[at(k.a)], &b = rows_of[at(k.b)];
    std::optional<Levers<D>> levers;
    if (k.levers) levers = Levers<D>{k.levers->a.on_spins(rims_of[at(k.a)]), k.levers->b.on_spins(rims_of[at(k.b)])};
    for (const LocalVector<D>& direction : contact_directions<D>())
      h.add(k.normal, a, b, direction, levers ? &*levers : nullptr);
    const LocalVector<D> carried = relative_velocity(k, driven) + k.bias;
    set_component<D>(problem.w, c, k.levers ? carried + driven_part(k, bodies) : carried);
    problem.friction[c] = k.friction;
  }
  problem.h = h.matrix();
  add_idle_unknowns(problem, contacts);
  return problem;
}

template StepProblem<2> step_of_contacts(const StepStart&, std::vector<StepContact>, double, std::vector<std::int32_t>,
                                         const std::vector<RememberedImpulse>&, bool);
template StepProblem<3> step_of_contacts(const StepStart&, std::vector<StepContact>, double, std::vector<std::int32_t>,
                                         const std::vector<RememberedImpulse>&, bool);
template StepProblem<2> prepare_step(const StepStart&, bool, bool);
template StepProblem<3> prepare_step(const StepStart&, bool, bool);
template GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<2>>&,
                                                const std::vector<GrainContact<2>>&, const Rims&);
template GlobalFrictionProblem friction_problem(const std::vector<GrainVelocity<3>>&,
                                                const std::vector<GrainContact<3>>&, const Rims&);

}  // namespace nscdd
