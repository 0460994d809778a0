// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mechanics/rigid_body.hpp"
#include <nscdd/packing/packing.hpp>

#include <map>

namespace nscdd {

/// What holds for contacts of two colours in place of the parameters of an Interaction.
struct PairRule {
  bool touch = true;  ///< false: their bodies go through each other
  bool bond = false;  ///< they hold each other as if glued, see bond_of
  std::optional<double> friction = {}, static_friction = {}, restitution = {}, tangential_restitution = {};
};

/// Colours of grains and walls, and rules for pairs of colours.
struct ContactPairs {
  std::vector<Index> colour = {};                       ///< of every grain and then of every wall; empty: no rules
  std::map<std::array<Index, 2>, PairRule> rules = {};  ///< by two colours, the smaller first

  /// The rule of two bodies; one that changes nothing if there is none.
  const PairRule& of(Index a, Index b) const {
    static constexpr PairRule none;
    if (colour.empty()) return none;
    const auto [low, high] = std::minmax(colour[at(a)], colour[at(b)]);
    const auto found = rules.find({low, high});
    return found == rules.end() ? none : found->second;
  }
  bool bonds() const {
    return std::ranges::any_of(rules, [](const auto& one) { return one.second.bond; });
  }
};

/// Disks in the plane or spheres in space, walls, and boundaries that drive them. Grains of a packing come first.
struct GranularSystem {
  Index dimension = 2;           ///< 2 in the plane, 3 in space
  std::vector<double> radius;    ///< m
  std::vector<double> mass;      ///< kg; that of a driven grain has no effect
  std::vector<Index> driven_by;  ///< boundary that moves a grain, -1 for a free one
  std::vector<Wall> walls;
  std::vector<Boundary> boundaries;
  ContactPairs pairs = {};
  Period period = {};
  std::vector<Index> free_bodies = {};  ///< boundaries with free directions, by number_bodies

  Index grains() const { return count(radius); }
  /// Grains, then bodies with free directions: the bodies of a step but for walls.
  Index bodies() const { return grains() + count(free_bodies); }
  const Boundary& body(Index number) const { return boundaries[at(free_bodies[at(number - grains())])]; }
  /// The boundary of a grain, or of wall grains() + w; -1 for a free grain.
  Index boundary_of(Index body) const {
    return body < grains() ? driven_by[at(body)] : walls[at(body - grains())].boundary;
  }
  /// The body of a step that a grain or wall belongs to: itself or one with free directions; -1 for any other wall.
  Index node_of(Index body) const {
    const Index k = boundary_of(body), node = k < 0 ? -1 : boundaries[at(k)].node;
    return node >= 0 || body >= grains() ? node : body;
  }
  /// Whether a number of node_of is that of a body that impulses move.
  bool is_free_node(Index node) const { return node >= grains() || (node >= 0 && free(node)); }
  /// Whether impulses can move what a grain or wall belongs to.
  bool moves(Index body) const { return is_free_node(node_of(body)); }
  /// Whether a grain or wall has the friction of boundaries: those of bodies that are free in all directions have not.
  bool is_boundary(Index body) const {
    const Index k = boundary_of(body);
    return k >= 0 && !(boundaries[at(k)].body && boundaries[at(k)].body->wholly_free(dimension));
  }
  /// Whether grain a and grain or wall b are of two bodies, not both driven, and of colours that touch.
  bool may_touch(Index a, Index b) const {
    const Index k = boundary_of(a), l = boundary_of(b);
    if ((k >= 0 || l >= 0) && (!(moves(a) || moves(b)) || k == l || waits(a) || waits(b))) return false;
    return pairs.of(a, b).touch;
  }
  /// Whether a grain waits in a source.
  bool waits(Index body) const {
    const Index k = boundary_of(body);
    return k >= 0 && boundaries[at(k)].source.has_value();
  }
  Index free_grains() const { return std::count(driven_by.begin(), driven_by.end(), Index{-1}); }
  bool free(Index grain) const { return driven_by[at(grain)] < 0; }
  /// Of a number of node_of, 1/kg; 0 for a body that impulses do not move.
  double inverse_mass(Index node) const {
    if (node >= grains()) return 1 / body(node).body->mass;
    return node >= 0 && free(node) ? 1 / mass[at(node)] : 0;
  }
  /// Of a body of a step: its radius three times, or FreeBody::rims.
  std::array<double, 3> rims(Index number) const {
    if (number >= grains()) return body(number).body->rims(dimension);
    return {radius[at(number)], radius[at(number)], radius[at(number)]};
  }
  /// The smaller radius of grain a and body b, m: that of the grain where b is a wall.
  double smaller_radius(Index a, Index b) const {
    return b < grains() ? std::min(radius[at(a)], radius[at(b)]) : radius[at(a)];
  }
  /// From one place to another, in a periodic cell to its nearest image, m.
  Place apart(const Place& from, const Place& to) const {
    const Place d = difference(to, from);
    return period.any() ? period.shortest(d) : d;
  }
  double length(const Place& a) const { return dimension == 2 ? std::hypot(a[0], a[1]) : std::hypot(a[0], a[1], a[2]); }
};

/// The bodies (a, b) of a contact or of what is remembered of one: lists ascend by them.
inline constexpr auto body_pair = [](const auto& one) { return std::pair(one.a, one.b); };

/// Impulse of a contact in the last step. Bodies a < b: grains by their number, wall w as grains() + w.
struct RememberedImpulse {
  Index a = 0, b = 0;
  /// N s: in the plane (n, t, 0) in the frame of the contact, in space (x, y, z) on b, since tangents may jump.
  std::array<double, 3> impulse{};
  bool slid = false;  ///< see Interaction::static_friction
};

/// The impulse of a contact with that normal as it is remembered, and back, at a normal that may have turned since.
template <int D>
std::array<double, 3> to_remember(const LocalVector<D>& impulse, const Direction<D>& normal) {
  if constexpr (D == 2)
    return {impulse.n, impulse.t, 0};
  else
    return along_axes(normal, impulse);
}
template <int D>
LocalVector<D> recalled(const std::array<double, 3>& impulse, const Direction<D>& normal) {
  if constexpr (D == 2)
    return {impulse[0], impulse[1]};
  else
    return in_frame(normal, impulse);
}

/// Interface impulse on the copy of a grain in a subdomain, (A_E^T F_Gamma) of that copy.
struct RememberedGluing {
  Index grain = 0, subdomain = 0;
  std::array<double, 6> impulse{};  ///< on the unknowns of a grain, N s: (x, y, rim), in space (x, y, z, three rims)
};

/// Subdomain of a contact at the last decomposition.
struct RememberedSubdomain {
  Index a = 0, b = 0, subdomain = 0;
};

/// A bond (PairRule::bond), which keeps its gap.
struct RememberedBond {
  Index a = 0, b = 0;
  double gap = 0;  ///< m, when it was made
};

/// Model of a subdomain in the last step of a run that switches models.
struct RememberedModel {
  Index switched = 0;             ///< 1 if it ended the step with the simpler model, 0 if with the law itself
  Index standing = 0;             ///< iterations, over steps, for which none of its statuses has changed
  Index switched_iterations = 0;  ///< of the step, in which it had the simpler model
  Index switch_backs = 0;         ///< of the step
  /// Largest distance of the simpler model from the law, at a switch back and at the end, see ModelSwitch.
  double velocity_distance = 0;  ///< m/s
  double impulse_distance = 0;   ///< relative to the interface impulses
};

/// Everything that changes in a run; a restart from it repeats every bit. If ranks share steps, each remembers the
/// contacts of its own subdomains (share_step); the rest is replicated.
struct GranularState {
  Index step = 0;                              ///< steps done
  double time = 0;                             ///< s
  std::vector<double> x, y, angle;             ///< of every disk, m and rad
  std::vector<double> velocity_x, velocity_y;  ///< m/s
  std::vector<double> spin;                    ///< rad/s, about z
  std::vector<double> z, velocity_z;           ///< only in space, m and m/s
  std::vector<double> spin_x, spin_y;          ///< only in space, rad/s
  /// In space, in place of `angle`: the rotation of every sphere since time 0, unit quaternions w + x i + y j + z k.
  std::vector<double> turn_w, turn_x, turn_y, turn_z;
  std::vector<Pose> poses;                      ///< of every boundary
  std::vector<RigidVelocity> body_velocities;   ///< of every boundary, along its free directions; 0 along the others
  std::vector<Index> released;                  ///< grains, by all sources so far, in this order
  std::vector<RememberedBond> bonds;            ///< on all ranks, ascending by (a, b)
  std::vector<RememberedImpulse> impulses;      ///< of the last step, ascending by (a, b)
  std::vector<RememberedGluing> gluing;         ///< of the last step, ascending by (grain, subdomain)
  std::vector<RememberedSubdomain> subdomains;  ///< of the contacts of the last step, ascending by (a, b)
  std::vector<RememberedModel> models;          ///< of the subdomains, in their order; empty unless they are switched
  std::vector<Index> process_of_subdomain;      ///< its owner, if ranks share steps; empty at the beginning of a run
  Index decomposed_at = -1;                     ///< last step whose contacts were partitioned afresh
  double eta = 0;                               ///< best flexibility at that step, 1/kg; 0 if none was asked for
};

constexpr std::string_view shape_of_grains(Index dimension) { return dimension == 2 ? "disk" : "sphere"; }

/// Numbers the bodies with free directions, behind the grains.
void number_bodies(GranularSystem& system);

/// Velocities of boundaries at a time: along free directions those of the state, along the others those of motions.
std::vector<RigidVelocity> boundary_velocities(const GranularSystem& system, const GranularState& state, double time);

/// The state at time 0: grains at rest at their places, boundaries at their centres. z is empty in the plane.
GranularState initial_state(const GranularSystem& system, std::vector<double> x, std::vector<double> y,
                            std::vector<double> z = {});

/// The arrays of the state with a number per grain in a system of that dimension.
std::vector<std::vector<double> GranularState::*> numbers_of_grains(Index dimension);

inline Place centre_of(const GranularState& state, std::size_t grain) {
  return {state.x[grain], state.y[grain], state.z.empty() ? 0 : state.z[grain]};
}

/// Gets and sets the velocity of a grain; the speed of the rim is `radius` x spin.
inline GrainMotion motion_of(const GranularState& state, std::size_t i, double radius) {
  if (state.z.empty()) return {state.velocity_x[i], state.velocity_y[i], 0, 0, 0, radius * state.spin[i]};
  return {state.velocity_x[i],      state.velocity_y[i],      state.velocity_z[i],
          radius * state.spin_x[i], radius * state.spin_y[i], radius * state.spin[i]};
}
void set_motion(GranularState& state, std::size_t grain, const GrainMotion& velocity, double radius);

/// Moves the centre of a grain there, m, and turns the grain by an axis times an angle, rad.
void move_grain(GranularState& state, std::size_t grain, const Place& centre, const Place& angle);

/// Releases the next grain of every source (Boundary::source) whose point is free: no grain would be touched, and
/// behind the first state no centre of a grain that impulses move is within GrainSource::distance. The grain, which
/// waited as a driven one, is at rest at the point then, and free. Grains leave in the order of their numbers.
void release_grains(GranularSystem& system, GranularState& state);

/// Frees the grains of a system that are released in a state of it.
void free_released_grains(GranularSystem& system, const GranularState& state);

/// "disk 3", "sphere 3", "disk 130 of boundary 'left'", or "the wall of boundary 'right'" (grains() + its number).
std::string body_name(const GranularSystem& system, Index body);

/// Throws Error naming the grain or boundary for wrong sizes, numbers not finite, a missing boundary, no free grain.
void check(const GranularSystem& system, const GranularState& state);

}  // namespace nscdd
