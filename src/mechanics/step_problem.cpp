// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/fail.hpp"
#include "mechanics/time_stepping.hpp"
#include "packing/grain_grid.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

// A grain that moves by more than so many of its radii in one step passes through others unseen.
constexpr double largest_move = 10;

// Where everything is when contacts are found.
template <int D>
struct Configuration {
  std::vector<double> x, y, z;         // of every grain at q_m, m
  std::vector<Wall> walls;             // at q_m
  std::vector<Pose> poses;             // of boundaries at q_m
  std::vector<RigidVelocity> motions;  // of boundaries in this step

  Direction<D> centre(std::size_t i) const {
    if constexpr (D == 2)
      return {x[i], y[i]};
    else
      return {x[i], y[i], z[i]};
  }
};

template <int D>
double dot(const Direction<D>& a, const Direction<D>& b) {
  double sum = a[0] * b[0] + a[1] * b[1];
  if constexpr (D == 3) sum += a[2] * b[2];
  return sum;
}

// a + factor b
template <int D>
Direction<D> moved_along(Direction<D> a, double factor, const Direction<D>& b) {
  for (std::size_t k = 0; k < D; ++k) a[k] += factor * b[k];
  return a;
}

// A direction of the dimension as the three numbers of StepContact, and back.
template <int D>
std::array<double, 3> widened(const Direction<D>& a) {
  if constexpr (D == 2)
    return {a[0], a[1], 0};
  else
    return a;
}
template <int D>
Direction<D> narrowed(const std::array<double, 3>& a) {
  if constexpr (D == 2)
    return {a[0], a[1]};
  else
    return a;
}

template <int D>
Direction<D> velocity_of(const GrainVelocity<D>& v) {
  if constexpr (D == 2)
    return {v.x, v.y};
  else
    return {v.x, v.y, v.z};
}

template <int D>
double speed_of(const GrainVelocity<D>& v) {
  if constexpr (D == 2)
    return std::hypot(v.x, v.y);
  else
    return std::hypot(v.x, v.y, v.z);
}

template <int D>
GrainVelocity<D> driven_velocity(const Direction<D>& v) {
  GrainUnknowns<D> u{};
  std::copy(v.begin(), v.end(), u.begin());
  return with_unknowns(u, 0);
}

// Velocities of all grains. The state knows those of free ones; a boundary gives those of the grains it drives.
template <int D>
std::vector<GrainVelocity<D>> start_velocities(const GranularSystem& system, const GranularState& state,
                                               const std::vector<RigidVelocity>& motions) {
  std::vector<GrainVelocity<D>> result(at(system.disks()));
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double radius = system.radius[i];
    if (system.driven_by[i] < 0) {
      result[i] = with_unknowns(unknowns_of<D>(state, i, radius), 1 / system.mass[i]);
      continue;
    }
    const auto k = at(system.driven_by[i]);
    result[i] = driven_velocity<D>(velocity_of_point(motions[k], state.poses[k], centre_of<D>(state, i)));
    if (system.boundaries[k].orientation != Orientation::turning) continue;
    if constexpr (D == 2) {
      result[i].rim = radius * motions[k].spin;
    } else {
      result[i].rim_x = radius * motions[k].spin_x;
      result[i].rim_y = radius * motions[k].spin_y;
      result[i].rim_z = radius * motions[k].spin;
    }
  }
  return result;
}

template <int D>
void check_moves(const GranularSystem& system, const GranularState& state, const std::vector<GrainVelocity<D>>& v,
                 double h) {
  const auto finite = [](double number) { return std::isfinite(number); };
  for (std::size_t i = 0; i < at(system.disks()); ++i) {
    const auto name = [&] { return body_name(system, static_cast<Index>(i)); };
    const Direction<D> centre = centre_of<D>(state, i), velocity = velocity_of<D>(v[i]);
    if (!std::ranges::all_of(centre, finite))
      fail("{}: expected a finite position, met ({}) m", name(), fmt::join(centre, ", "));
    const double move = h * speed_of<D>(v[i]);
    if (!(move <= largest_move * system.radius[i]) || !std::isfinite(squared_rim(v[i])))
      fail("{}: expected to move by at most {} of its radii in a step, met a velocity of ({}) m/s and a step of {} s",
           name(), largest_move, fmt::join(velocity, ", "), h);
  }
}

template <int D>
Configuration<D> middle(const GranularSystem& system, const GranularState& state,
                        const std::vector<RigidVelocity>& motions, double time) {
  Configuration<D> where{state.x, state.y, state.z, system.walls, state.poses, motions};
  for (std::size_t k = 0; k < where.poses.size(); ++k) where.poses[k] = advanced<D>(where.poses[k], motions[k], time);
  for (std::size_t i = 0; i < where.x.size(); ++i) {
    Direction<D> centre = where.centre(i);
    if (system.driven_by[i] < 0) {
      const GrainUnknowns<D> v = unknowns_of<D>(state, i, system.radius[i]);
      for (std::size_t k = 0; k < D; ++k) centre[k] += time * v[k];
    } else {
      const auto k = at(system.driven_by[i]);
      centre = carried(centre, state.poses[k], where.poses[k]);
    }
    where.x[i] = centre[0];
    where.y[i] = centre[1];
    if constexpr (D == 3) where.z[i] = centre[2];
  }
  for (Wall& wall : where.walls)
    wall = moved<D>(wall, system.boundaries[at(wall.boundary)].motion, where.poses[at(wall.boundary)]);
  return where;
}

// Where a grain meets a wall: the nearest point of the wall, and how far from it the centre is on the side of grains.
template <int D>
struct WallPoint {
  Direction<D> foot, normal;  // the normal points to the grain
  double height;
};

template <int D>
WallPoint<D> nearest_point(const Wall& wall, const Direction<D>& centre) {
  const Direction<D> point = narrowed<D>(wall.point), normal = narrowed<D>(wall.normal);
  const double along = dot<D>(moved_along<D>(centre, -1, point), normal);
  const Direction<D> below = moved_along<D>(centre, -along, normal);
  if (wall.radius == 0) return {below, normal, along};
  // A cylinder: from here `normal` is its axis and `outwards` the direction away from it.
  const Direction<D> axis_point = moved_along<D>(point, along, normal);
  Direction<D> outwards = moved_along<D>(centre, -1, axis_point);
  const double distance = std::sqrt(dot<D>(outwards, outwards));
  if (distance > 0) {
    for (double& one : outwards) one /= distance;
  } else {  // all points are as near as this one
    if constexpr (D == 3) outwards = tangents_of(normal).first;
  }
  const double radius = std::abs(wall.radius), inwards = wall.radius > 0 ? -1 : 1;
  const Direction<D> foot = moved_along<D>(axis_point, radius, outwards);
  for (double& one : outwards) one *= inwards;
  return {foot, outwards, inwards * (distance - radius)};
}

// Pairs of a free grain and a grain or wall, ascending by (a, b), whose gap is within the alert distance, or would be
// after the step at the velocities V^- + h g and those of the boundaries. `least_alert`, m, replaces an alert distance
// of the scheme that is smaller. Throws Error naming both grains if two have the same centre.
template <int D>
std::vector<StepContact> find_contacts(const GranularSystem& system, const Configuration<D>& where,
                                       const std::vector<GrainVelocity<D>>& free, const TimeStepping& scheme,
                                       double least_alert) {
  double fastest = 0;
  for (Index i = 0; i < system.disks(); ++i) fastest = std::max(fastest, speed_of<D>(free[at(i)]));
  const double smallest = *std::min_element(system.radius.begin(), system.radius.end());
  const double alert = std::max(scheme.alert * smallest, least_alert);
  const double range = std::max(alert, 2 * fastest * scheme.step);  // the fastest pair may close so much
  std::vector<StepContact> found;
  found.reserve(at(3 * system.disks()));
  const auto add_if_near = [&](Index a, Index b, const Direction<D>& normal, const Direction<D>& point, double gap,
                               const Direction<D>& v) {  // of b
    const double closing = dot<D>(normal, moved_along<D>(v, -1, velocity_of<D>(free[at(a)])));
    const bool far = gap > alert && gap + scheme.step * closing > alert;
    if (!far) found.push_back({a, b, widened<D>(normal), widened<D>(point), gap});
  };
  const GrainGrid grid({where.x, where.y, where.z}, system.radius, 1, range);
  grid.for_each_pair([&](Index a, Index b) {
    const Direction<D> from = where.centre(at(a)), to = where.centre(at(b));
    Direction<D> apart = moved_along<D>(to, -1, from);
    const double touch = system.radius[at(a)] + system.radius[at(b)];
    const double near = touch + range;
    const double square = dot<D>(apart, apart);
    if (square > near * near || (!system.free(a) && !system.free(b))) return;
    const double distance = std::sqrt(square);
    if (!(distance > 0))
      fail("{} and {}: expected distinct centres, met one", body_name(system, a), body_name(system, b));
    Direction<D> half{};
    for (std::size_t k = 0; k < D; ++k) {
      apart[k] /= distance;
      half[k] = (from[k] + to[k]) / 2;
    }
    add_if_near(a, b, apart, half, distance - touch, velocity_of<D>(free[at(b)]));
  });
  for (Index w = 0; w < count(where.walls); ++w) {
    const Wall& wall = where.walls[at(w)];
    for (Index i = 0; i < system.disks(); ++i) {
      if (!system.free(i)) continue;
      const auto [foot, normal, height] = nearest_point<D>(wall, where.centre(at(i)));
      const Direction<D> v = velocity_of_point(where.motions[at(wall.boundary)], where.poses[at(wall.boundary)], foot);
      Direction<D> down = normal;
      for (double& one : down) one = -one;
      add_if_near(i, system.disks() + w, down, foot, height - system.radius[at(i)], v);
    }
  }
  return sorted_by_bodies(found, system.disks());
}

// Adds one body per wall contact, which moves as the wall does under the grain. Returns the second body of each
// contact.
template <int D>
std::vector<Index> add_wall_bodies(StepProblem<D>& problem, const GranularSystem& system,
                                   const Configuration<D>& where) {
  std::vector<Index> second;
  for (const StepContact& c : problem.geometry) {
    second.push_back(c.b);
    if (c.b < system.disks()) continue;
    const Index boundary = where.walls[at(c.b - system.disks())].boundary;
    second.back() = count(problem.free);
    problem.free.push_back(driven_velocity<D>(
        velocity_of_point(where.motions[at(boundary)], where.poses[at(boundary)], narrowed<D>(c.point))));
    problem.start.push_back(problem.free.back());
  }
  return second;
}

// Of the bodies whose motion is prescribed, m/s.
template <int D>
double fastest_boundary(const std::vector<GrainVelocity<D>>& velocities) {
  double fastest = 0;
  for (const GrainVelocity<D>& v : velocities)
    if (v.inverse_mass == 0) fastest = std::max(fastest, speed_of<D>(v));
  return fastest;
}

double smaller_radius(const GranularSystem& system, const StepContact& c) {
  const double a = system.radius[at(c.a)];
  return c.b < system.disks() ? std::min(a, system.radius[at(c.b)]) : a;
}

bool touches(const GranularSystem& system, const StepContact& c) {
  return c.gap <= touching_gap * smaller_radius(system, c);
}

template <int D>
GrainContact<D> solver_contact(const StepContact& c, Index second, const StepProblem<D>& problem,
                               const Interaction& interaction, double correction, double push) {
  const GrainVelocity<D>&a = problem.free[at(c.a)], &b = problem.free[at(second)];
  const bool driven = a.inverse_mass == 0 || b.inverse_mass == 0;
  GrainContact<D> k{.a = static_cast<std::int32_t>(c.a),
                    .b = static_cast<std::int32_t>(second),
                    .normal = narrowed<D>(c.normal),
                    .inverse_w = grain_delassus(a, b),
                    .bias = {c.gap > 0 ? c.gap / problem.h : std::max(correction * c.gap / problem.h, -push), {}},
                    .friction = driven ? problem.boundary_friction : problem.friction};
  if (interaction.restitution > 0 || interaction.tangential_restitution > 0) {
    const LocalVector<D> before = relative_velocity(k, problem.start);
    if (interaction.restitution > 0) k.bias.n = interaction.restitution * std::min(0.0, before.n);
    k.bias.t = interaction.tangential_restitution * before.t;
  }
  return k;
}

}  // namespace

double push_speed(const TimeStepping& scheme, double smaller_radius, double boundary_speed) {
  if (scheme.maximum_push_speed >= 0) return scheme.maximum_push_speed;
  const double gravity = std::hypot(scheme.gravity[0], scheme.gravity[1], scheme.gravity[2]);
  return natural_push_speed * (std::sqrt(gravity * smaller_radius) + boundary_speed);
}

void check_overlaps(const GranularSystem& system, const std::vector<StepContact>& contacts, double largest) {
  for (const StepContact& c : contacts)
    if (c.gap < -largest * smaller_radius(system, c))
      fail("{} and {}: expected an overlap of at most {} of the smaller radius, met {} m", body_name(system, c.a),
           body_name(system, c.b), largest, -c.gap);
}

template <int D>
StepProblem<D> prepare_step(const GranularSystem& system, const GranularState& state, const Interaction& interaction,
                            const TimeStepping& scheme, bool warm_start) {
  const double h = scheme.step;
  const auto motions = boundary_velocities(system, state.time + h / 2);
  StepProblem<D> problem;
  problem.h = h;
  double pull = 0;
  const auto take_from = [&](const auto& law) {
    problem.friction = law.rubs ? interaction.friction : 0;
    problem.boundary_friction = law.rubs ? interaction.friction_at_boundaries() : 0;
    problem.pulls = law.pulls;
    pull = law.pull();
  };
  std::visit(take_from, contact_law(interaction, h, 1));  // the scale, yet unknown, matters to none of these
  problem.tangential_bias = interaction.tangential_restitution > 0;
  problem.start = start_velocities<D>(system, state, motions);
  problem.free = problem.start;
  const Direction<D> gravity = gravity_of<D>(scheme);
  for (Index i = 0; i < system.disks(); ++i) {
    if (!system.free(i)) continue;
    GrainVelocity<D>& v = problem.free[at(i)];
    v.x += h * gravity[0];
    v.y += h * gravity[1];
    if constexpr (D == 3) v.z += h * gravity[2];
  }
  check_moves<D>(system, state, problem.free, h);
  const Configuration<D> where = middle<D>(system, state, motions, (1 - scheme.theta) * h);
  // Bodies that hold each other are found however short the alert distance.
  const double hold = problem.pulls ? touching_gap * *std::max_element(system.radius.begin(), system.radius.end()) : 0;
  problem.geometry = find_contacts<D>(system, where, problem.free, scheme, hold);
  // With restitution a contact acts once it touches: the predicted gap would swallow the impact.
  if (interaction.restitution > 0)
    std::erase_if(problem.geometry,
                  [&](const StepContact& c) { return c.gap > 0 && !(problem.pulls && touches(system, c)); });
  const std::vector<Index> second = add_wall_bodies<D>(problem, system, where);
  const double boundary_speed = fastest_boundary<D>(problem.start);
  problem.contacts.reserve(problem.geometry.size());
  for (std::size_t k = 0; k < problem.geometry.size(); ++k) {
    const StepContact& c = problem.geometry[k];
    problem.contacts.push_back(solver_contact<D>(c, second[k], problem, interaction, scheme.penetration_correction,
                                                 push_speed(scheme, smaller_radius(system, c), boundary_speed)));
    if (problem.pulls && touches(system, c)) problem.contacts.back().pull = pull;
    problem.scale += 1 / problem.contacts.back().inverse_w.inverse_n;
  }
  problem.scale /= std::max(1.0, static_cast<double>(problem.contacts.size()));
  problem.law = contact_law(interaction, h, problem.scale);
  if (!warm_start) return problem;
  const auto last = remembered(state.impulses, problem.geometry);
  for (std::size_t k = 0; k < last.size(); ++k)
    if (last[k] != nullptr) problem.contacts[k].impulse = recalled<D>(last[k]->impulse, problem.contacts[k].normal);
  return problem;
}

template StepProblem<2> prepare_step(const GranularSystem&, const GranularState&, const Interaction&,
                                     const TimeStepping&, bool);
template StepProblem<3> prepare_step(const GranularSystem&, const GranularState&, const Interaction&,
                                     const TimeStepping&, bool);

Interpenetration interpenetration(const GranularSystem& system, const std::vector<StepContact>& contacts) {
  Interpenetration result;
  Index overlaps = 0;
  for (const StepContact& c : contacts) {
    if (c.gap >= 0) continue;
    result.maximum = std::max(result.maximum, -c.gap);
    result.relative = std::max(result.relative, -c.gap / smaller_radius(system, c));
    result.mean -= c.gap;
    ++overlaps;
  }
  if (overlaps > 0) result.mean /= static_cast<double>(overlaps);
  return result;
}

}  // namespace nscdd
