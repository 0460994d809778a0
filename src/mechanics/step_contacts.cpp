// SPDX-License-Identifier: GPL-3.0-or-later
#include "mechanics/step_contacts.hpp"

#include "core/fail.hpp"
#include "packing/grain_grid.hpp"

#include <fmt/ranges.h>

namespace nscdd {
namespace {

// Relative motion of two grains in a step, times the smaller radius, above which the normal where they meet is sought.
// Below it the normal when contacts are found is off by at most half of this, rad.
constexpr double far_in_a_step = 0.5;

// The speed of a grain at the velocity V^- + h M^-1 F, m/s. Throws Error if it moves too far in the step.
double checked_speed(const StepStart& start, Index grain, const GrainMotion& v) {
  const auto& [system, state, interaction, scheme] = start;
  const auto finite = [](double number) { return std::isfinite(number); };
  const auto numbers = [d = at(system.dimension)](const Place& a) {
    return fmt::format("{}", fmt::join(a.data(), a.data() + d, ", "));
  };
  const Place centre = centre_of(state, at(grain));
  if (!std::ranges::all_of(centre, finite))
    fail("{}: expected a finite position, met ({}) m", body_name(system, grain), numbers(centre));
  const double speed = system.length(velocity_of(v)), far = largest_move * system.radius[at(grain)];
  if (scheme.step * speed <= far && std::isfinite(v[3] * v[3] + v[4] * v[4] + v[5] * v[5])) return speed;
  const std::string expected = fmt::format(
      "{}: expected to move by at most {} of its radii in a step, met a velocity of ({}) m/s and a step of "
      "{} s",
      body_name(system, grain), largest_move, numbers(velocity_of(v)), scheme.step);
  const double safe = safe_step(start);
  if (safe > 0) fail("{}; dynamics.step: expected at most {:g} s", expected, safe);
  throw Error(expected);
}

class ContactSearch {
 public:
  ContactSearch(const StepStart& start, const std::function<void(const StepContact&)>& visit)
      : start_(start), visit_(visit) {
    const std::vector<double>& radius = system_.radius;
    double fastest = 0;
    for (Index i = 0; i < system_.grains(); ++i) {
      const double speed = checked_speed(start, i, motion_of(i));
      fastest = std::max(fastest, speed);
      if (system_.is_boundary(i)) considered_.boundary_speed = std::max(considered_.boundary_speed, speed);
    }
    const ContactLaw law = contact_law(start.interaction, start.scheme.step, 1);
    std::visit([&](const auto& one) { pulls_ = one.pulls, opens_ = one.opens; }, law);
    on_touch_ = start.interaction.on_velocity() || !opens_;
    // Bodies that hold each other are found even if the alert distance is shorter.
    const double range = start.interaction.cohesion_range;
    const double touch = touching_gap * std::ranges::max(radius);
    const double held = pulls_ ? (range >= 0 ? range : touch) : opens_ ? 0 : touch;
    alert_ = std::max(bond_distance_, held);
    foreseen_ = std::max(alert_, 2 * fastest * start.scheme.step);  // largest approach of two grains
    for (const RememberedBond& one : start.state.bonds) foreseen_ = std::max(foreseen_, 2 * one.gap);
  }

  ConsideredContacts run() {
    visit_pairs();
    visit_walls();
    return std::move(considered_);
  }

 private:
  GrainMotion motion_of(Index grain) const { return free_motion(start_, where_.poses, where_.motions, grain); }

  bool bonded(const StepContact& c) const { return bonds_ && bond_of(start_, c, bond_distance_); }

  Place velocity_of_second(const StepContact& c) const {
    if (c.b < system_.grains()) return velocity_of(motion_of(c.b));
    return where_.velocity(where_.walls[at(c.b - system_.grains())], contact_point(system_, where_, c, c.b));
  }

  void visit_pairs() {
    const double range = path_.followed() ? std::max(foreseen_, path_.reach) : foreseen_;  // bodies may have parted
    const bool flat = where_.z.empty(), periodic = system_.period.any();
    const Places places{where_.x, where_.y, where_.z};
    const std::span<const double> radius = system_.radius;
    for_each_near_pair(places, radius, system_.period, 1, range, [=, this](Index a, Index b) {
      const std::size_t i = at(a), j = at(b);
      Place apart{places.x[j] - places.x[i], places.y[j] - places.y[i], flat ? 0 : places.z[j] - places.z[i]};
      if (periodic) apart = system_.period.shortest(apart);
      const double square = dot(apart, apart), near = radius[i] + radius[j] + range;
      if (square <= near * near) visit_pair(a, b, apart, square);  // most of these pairs are too far apart
    });
  }

  // Apart from the loop over all pairs, which then needs few registers.
  [[gnu::noinline]] void visit_pair(Index a, Index b, Place apart, double square) {
    if (!system_.may_touch(a, b)) return;
    const bool periodic = system_.period.any();
    const Place from = where_.centre(at(a)), to = periodic ? moved_along(from, 1, apart) : where_.centre(at(b));
    const double touch = system_.radius[at(a)] + system_.radius[at(b)], in_reach = touch + foreseen_;
    const double distance = std::sqrt(square);
    if (!(distance > 0)) return visit_concentric(a, b, touch);
    Place half = divided(moved_along(from, 1, to), 2);
    if (periodic) half = moved_along(half, 1, system_.period.into_cell(half));
    visit_if_near({a, b, divided(apart, distance), half, distance - touch}, square <= in_reach * in_reach);
  }

  void visit_concentric(Index a, Index b, double touch) {
    if (path_.followed())
      if (const auto overlap = Passage::of(path_, a, b, -touch).deep; overlap && overlap->before < touch)
        return considered_.deep.push_back(*overlap);
    fail("{} and {}: expected distinct centres, met equal ones", body_name(system_, a), body_name(system_, b));
  }

  void visit_walls() {
    for (Index w = 0; w < count(where_.walls); ++w)
      for (Index i = 0; i < system_.grains(); ++i) {
        if (!system_.may_touch(i, system_.grains() + w)) continue;
        const auto [foot, normal, height] = nearest_point(system_, where_.walls[at(w)], where_.centre(at(i)));
        StepContact contact{i, system_.grains() + w, {}, foot, height - system_.radius[at(i)]};
        for (std::size_t k = 0; k < at(system_.dimension); ++k) contact.normal[k] = -normal[k];
        visit_if_near(contact, true);
      }
  }

  // `in_reach`: whether they may come near in this step, not only on the path.
  void visit_if_near(StepContact c, bool in_reach) {
    const double gap = c.gap, step = start_.scheme.step;
    if (gap < 0 || path_.followed()) {
      const auto [overlap, met] = Passage::of(path_, c.a, c.b, gap);
      if (overlap) considered_.deep.push_back(*overlap);
      if (met) return visit({c.a, c.b, *met, c.point, std::min(gap, 0.0)});
    }
    if (gap > alert_ && !bonded(c)) {
      const Place move = difference(velocity_of_second(c), velocity_of(motion_of(c.a)));
      if (gap + step * dot(c.normal, move) > alert_) return;
      if (!on_touch_ && c.b < system_.grains() &&
          step * system_.length(move) > far_in_a_step * system_.smaller_radius(c.a, c.b)) {
        // The line of centres turns until they meet. Grains that miss each other are no contact.
        const Place line = system_.apart(where_.centre(at(c.a)), where_.centre(at(c.b)));
        const double touch = system_.length(line) - gap;
        const auto meeting = part_until(line, move, touch, step);
        if (!meeting) return;
        const Place normal = divided(moved_along(line, *meeting, move), touch);
        if (dot(c.normal, normal) < std::cos(largest_turn)) {
          c.normal = normal;
          c.gap = 0;
        }
      }
    }
    if (in_reach) visit(c);
  }

  bool holds(const StepContact& c) const {
    if (pulls_) return hold(system_, start_.interaction, c);
    return !opens_ && c.gap <= touching_gap * system_.smaller_radius(c.a, c.b);
  }

  // Whether impulses along the normal of a contact move one of its bodies: not so if both are driven along it.
  bool moves_apart(const StepContact& c) const {
    constexpr double part = 1e-6;  // of directions, whose numbers may have seven digits
    if (system_.free_bodies.empty()) return true;
    for (const Index body : {c.a, c.b}) {
      const Index node = system_.node_of(body);
      if (!system_.is_free_node(node)) continue;
      if (node < system_.grains()) return true;
      const Index k = system_.boundary_of(body);
      const FreeBody& own = *system_.boundaries[at(k)].body;
      const Place arm = difference(contact_point(system_, where_, c, body), where_.poses[at(k)].place());
      const Place turn = cross(arm, c.normal);
      for (std::size_t j = 0; j < 3; ++j)
        if ((own.directions[j] && std::abs(c.normal[j]) > part) ||
            (own.directions[3 + j] && std::abs(turn[j]) > part * system_.length(arm)))
          return true;
    }
    return false;
  }

  void visit(const StepContact& c) {
    if (!moves_apart(c)) return;
    // Under a condition on the velocity a contact acts once it touches: the predicted gap would swallow the impact. So
    // does one that never opens: it would pull over the gap.
    if (on_touch_ && c.gap > 0 && !holds(c) && !bonded(c)) return;
    ++considered_.number;
    if (c.b >= system_.grains() && system_.is_boundary(c.b))
      considered_.boundary_speed = std::max(considered_.boundary_speed, system_.length(velocity_of_second(c)));
    visit_(c);
  }

  const StepStart& start_;
  const GranularSystem& system_ = start_.system;
  const std::function<void(const StepContact&)>& visit_;
  const Path path_ = Path::to_contacts(start_);
  const Configuration& where_ = path_.places.back();
  bool pulls_ = false, opens_ = true;  // of the law
  bool on_touch_ = false;              // contacts act only where bodies touch
  const bool bonds_ = system_.pairs.bonds();
  const double bond_distance_ = alert_distance(system_, start_.scheme);  // m, see bond_of
  double alert_ = 0, foreseen_ = 0;  // largest gaps of contacts, m: at any velocity, and at the velocities of the step
  ConsideredContacts considered_;
};

}  // namespace

ConsideredContacts for_each_step_contact(const StepStart& start, const std::function<void(const StepContact&)>& visit) {
  return ContactSearch(start, visit).run();
}

Place contact_point(const GranularSystem& system, const Configuration& where, const StepContact& c, Index body) {
  if (body >= system.grains())
    return difference(c.point, image_step(system, where.walls[at(body - system.grains())], where.centre(at(c.a))));
  return moved_along(where.centre(at(body)), (body == c.a ? 1 : -1) * system.radius[at(body)], c.normal);
}

double friction_of(const StepStart& start, const StepContact& c, bool slid) {
  const PairRule& rule = start.system.pairs.of(c.a, c.b);
  if (rule.static_friction && !slid) return *rule.static_friction;
  if (rule.friction) return *rule.friction;
  return start.interaction.friction_of(start.system.is_boundary(c.a) || start.system.is_boundary(c.b), slid);
}

bool hold(const GranularSystem& system, const Interaction& interaction, const StepContact& contact) {
  if (interaction.cohesion_range >= 0) return contact.gap <= interaction.cohesion_range;
  return contact.gap <= touching_gap * system.smaller_radius(contact.a, contact.b);
}

std::optional<RememberedBond> bond_of(const StepStart& start, const StepContact& contact, double alert_distance) {
  if (!start.system.pairs.of(contact.a, contact.b).bond) return std::nullopt;
  const auto known = std::ranges::lower_bound(start.state.bonds, body_pair(contact), {}, body_pair);
  if (known != start.state.bonds.end() && body_pair(*known) == body_pair(contact)) return *known;
  const double near = std::max(alert_distance, touching_gap * start.system.smaller_radius(contact.a, contact.b));
  if (contact.gap > near) return std::nullopt;
  return RememberedBond{contact.a, contact.b, contact.gap};
}

double alert_distance(const GranularSystem& system, const TimeStepping& scheme) {
  return scheme.alert * std::ranges::min(system.radius);
}

}  // namespace nscdd
