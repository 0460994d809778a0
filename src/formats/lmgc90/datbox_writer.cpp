// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_writer.hpp"

#include "core/fail.hpp"
#include "formats/lmgc90/datbox_text.hpp"

#include <numbers>

namespace nscdd {

bool turns(const Motion& motion) {
  return std::ranges::any_of(motion.velocity,
                             [](const RigidVelocity& v) { return v.spin != 0 || v.spin_x != 0 || v.spin_y != 0; });
}

namespace {

constexpr const char* ruler = "!-----------------------------------------------------------------------\n";
const std::string indent(27, ' ');

std::string head(const char* title, const GranularState& state) {
  return fmt::format("\n! {}\n\n$steps{:9}{:14}time={}\n\n{}", title, state.step, "", datbox_number(state.time), ruler);
}

constexpr const char *grains = datbox_grains, *boundaries = datbox_boundaries, *grain_bulk = datbox_grains;

const char* status_name(LocalVector<2> impulse, ContactStatus status) {
  if (status == ContactStatus::open) return "noctc";
  if (status == ContactStatus::stick) return "stick";
  return impulse.t > 0 ? "slifw" : "slibw";  // LMGC90's tangential impulse has the other sign
}

// How far the point that a wall turns about lies behind it, m.
double depth_of_centre(const GranularSystem& system, std::size_t wall) {
  const Wall& one = system.walls[wall];
  const std::array<double, 3>& centre = system.boundaries[at(one.boundary)].motion.centre;
  return (one.point[0] - centre[0]) * one.normal[0] + (one.point[1] - centre[1]) * one.normal[1];
}

}  // namespace

DatboxWriter::DatboxWriter(const Simulation& first) : first_(first) {
  const GranularSystem& system = first_.system;
  if (system.dimension != 2) fail("LMGC90: expected disks in the plane, met spheres in space");
  constexpr Index most = 99'999;  // their numbers have five columns
  if (const Index bodies = system.free_disks() + count(system.boundaries); bodies > most)
    fail("LMGC90: expected at most {} bodies, met {}", most, bodies);
  double mass = 0, area = 0, lowest = infinity, highest = -infinity, largest = 0;
  std::vector<Index> disks_of(system.boundaries.size(), 0);
  Index free = 0;
  for (std::size_t i = 0; i < system.radius.size(); ++i) {
    const Index boundary = system.driven_by[i];
    places_.push_back(boundary < 0 ? Place{++free, 1} : Place{body_of_boundary(boundary), ++disks_of[at(boundary)]});
    largest = std::max(largest, system.radius[i]);
    lowest = std::min({lowest, first_.state.x[i], first_.state.y[i]});
    highest = std::max({highest, first_.state.x[i], first_.state.y[i]});
    if (boundary >= 0) continue;
    mass += system.mass[i];
    area += std::numbers::pi * system.radius[i] * system.radius[i];
  }
  wall_of_.assign(system.boundaries.size(), -1);
  thickness_.assign(system.boundaries.size(), largest);
  for (std::size_t w = 0; w < system.walls.size(); ++w) {
    places_.push_back({body_of_boundary(system.walls[w].boundary), 1});
    const Index boundary = system.walls[w].boundary;
    wall_of_[at(boundary)] = static_cast<Index>(w);
    if (!turns(system.boundaries[at(boundary)].motion)) continue;
    // A wall that turns about a point on it is a plank so thin that its seven digits tell no difference.
    const double thin = 1e-7 * largest, depth = depth_of_centre(system, w);
    thickness_[at(boundary)] = depth > -thin ? std::max(depth, thin) : 0;
  }
  density_ = mass / area;
  margin_ = largest;
  lay_planks(highest - lowest);
}

// Walls have no ends: a plank reaches beyond all disks of the first step by the size of the packing. Where it does not
// turn its middle lies before that of the disks, wherever the point is that the wall is described by.
void DatboxWriter::lay_planks(double size) {
  const GranularState& state = first_.state;
  half_length_.assign(wall_of_.size(), 0);
  shift_.assign(wall_of_.size(), 0);
  for (Index b = 0; b < count(wall_of_); ++b) {
    if (wall_of_[at(b)] < 0) continue;
    const auto [x, y, angle] = position(b, state.poses[at(b)]);
    double low = infinity, high = -infinity;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      const double along = (state.x[i] - x) * std::cos(angle) + (state.y[i] - y) * std::sin(angle);
      low = std::min(low, along);
      high = std::max(high, along);
    }
    if (!turns(first_.system.boundaries[at(b)].motion)) shift_[at(b)] = (low + high) / 2;
    half_length_[at(b)] = std::max(std::abs(low - shift_[at(b)]), std::abs(high - shift_[at(b)])) + size + margin_;
  }
}

// A plank lies behind the face that is the wall. The node of a body is the point that it turns about: a plank that
// turns is so thick that its middle lies there. The others are shifted along the wall, see lay_planks. (The node of
// several disks must not be 0: LMGC90 would work out another one.)
std::array<double, 3> DatboxWriter::position(Index boundary, const Pose& pose) const {
  const Index number = wall_of_[at(boundary)];
  if (number < 0) {
    constexpr double almost_none = 1e-30;
    return {pose.x, pose.y, pose.x == 0 && pose.y == 0 && pose.angle == 0 ? almost_none : pose.angle};
  }
  const Motion& motion = first_.system.boundaries[at(boundary)].motion;
  const Wall wall = moved<2>(first_.system.walls[at(number)], motion, pose);
  const double thickness = thickness_[at(boundary)], angle = std::atan2(-wall.normal[0], wall.normal[1]);
  if (turns(motion)) return {pose.x, pose.y, angle};
  const double shift = shift_[at(boundary)];
  return {wall.point[0] - thickness * wall.normal[0] + shift * std::cos(angle),
          wall.point[1] - thickness * wall.normal[1] + shift * std::sin(angle), angle};
}

std::string DatboxWriter::bodies() const {
  const GranularSystem& system = first_.system;
  const GranularState& state = first_.state;
  std::string text = "! File BODIES\n\n";
  const auto begin = [&](Index body, double average, double gyration, const std::array<double, 3>& place) {
    text +=
        fmt::format("$bdyty\n RBDY2{:7}\n$blmty\n PLAIN      1  behav  {}{}\n$nodty\n NO3xx      1{:14}{}\n$tacty\n",
                    body, grain_bulk, datbox_named({{"avrd=", average}, {"gyrd=", gyration}}), "",
                    datbox_named({{"coo1=", place[0]}, {"coo2=", place[1]}, {"coo3=", place[2]}}));
  };
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    if (!system.free(static_cast<Index>(i))) continue;
    const double radius = system.radius[i];
    begin(places_[i].body, std::sqrt(system.mass[i] / (density_ * std::numbers::pi)), radius / std::numbers::sqrt2,
          {state.x[i], state.y[i], 0});
    text += fmt::format(" DISKx      1  color  {}{}\n$$$$$$\n\n", grains, datbox_named({{"byrd=", radius}}));
  }
  for (Index b = 0; b < count(system.boundaries); ++b) {
    const std::array<double, 3> place = position(b, state.poses[at(b)]);
    const double thickness = thickness_[at(b)], c = std::cos(place[2]), sine = std::sin(place[2]);
    begin(body_of_boundary(b), margin_, margin_, place);
    if (wall_of_[at(b)] >= 0)
      text += fmt::format(" JONCx      1  color  {}{}\n", boundaries,
                          datbox_named({{"ax1 =", half_length_[at(b)]}, {"ax2 =", thickness}}));
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      if (system.driven_by[i] != b) continue;
      const double x = state.x[i] - place[0], y = state.y[i] - place[1];  // in the axes of the body
      text += fmt::format(" DISKb  {:5}  color  {}{}\n{}{}\n", places_[i].contactor, boundaries,
                          datbox_named({{"byrd=", system.radius[i]}}), indent,
                          datbox_named({{"coo1=", c * x + sine * y}, {"coo2=", c * y - sine * x}}));
    }
    text += "$$$$$$\n\n";
  }
  return text;
}

std::string DatboxWriter::bulk() const {
  const auto [x, y] = gravity_of<2>(first_.dynamics.time);
  return fmt::format("! File BEHAVIOUR\n\n$gravy\n{:17}{}\n\n$behav  lawty\n {}  {:30}{}\n", "",
                     datbox_named({{"grv1=", x}, {"grv2=", y}, {"grv3=", 0}}), grain_bulk, "RIGID",
                     datbox_named({{"Umas=", density_}}));
}

std::string DatboxWriter::dof(const TrajectoryStep& step) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  std::string text = head("DOF", state);
  const auto add = [&](Index body, const std::array<double, 3>& x, const std::array<double, 3>& v) {
    text += fmt::format("$bdyty\n RBDY2  {:7}\n$nodty\n NO3xx      1{:14}{}\n{}{}\n$$$$$$\n\n", body, "",
                        datbox_named({{"X(1)=", x[0]}, {"X(2)=", x[1]}, {"X(3)=", x[2]}}), indent,
                        datbox_named({{"V(1)=", v[0]}, {"V(2)=", v[1]}, {"V(3)=", v[2]}}));
  };
  for (std::size_t i = 0; i < state.x.size(); ++i)
    if (system.free(static_cast<Index>(i)))
      add(places_[i].body, {state.x[i] - first_.state.x[i], state.y[i] - first_.state.y[i], state.angle[i]},
          {state.velocity_x[i], state.velocity_y[i], state.spin[i]});
  const std::vector<RigidVelocity> velocities = boundary_velocities(system, state.time);
  for (Index b = 0; b < count(system.boundaries); ++b) {
    const std::array<double, 3> start = position(b, first_.state.poses[at(b)]), now = position(b, state.poses[at(b)]);
    const Direction<2> v = velocity_of_point(velocities[at(b)], state.poses[at(b)], Direction<2>{now[0], now[1]});
    const double turned = state.poses[at(b)].angle - first_.state.poses[at(b)].angle;
    add(body_of_boundary(b), {now[0] - start[0], now[1] - start[1], turned}, {v[0], v[1], velocities[at(b)].spin});
  }
  return text + ruler;
}

std::string DatboxWriter::contact(const TrajectoryStep& step, const TrajectoryContact& c, Index number) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  const StepContact& g = c.geometry;
  const bool wall = g.b >= system.disks();
  const auto velocity = [&](Index body) -> GrainVelocity<2> {
    if (body < system.disks())
      return {state.velocity_x[at(body)], state.velocity_y[at(body)], system.radius[at(body)] * state.spin[at(body)]};
    const Index boundary = system.walls[at(body - system.disks())].boundary;
    const RigidVelocity rigid = boundary_velocities(system, state.time)[at(boundary)];
    const std::array<double, 2> v =
        velocity_of_point(rigid, state.poses[at(boundary)], Direction<2>{g.point[0], g.point[1]});
    return {v[0], v[1], 0};
  };
  const LocalVector<2> v = relative_velocity(Direction<2>{g.normal[0], g.normal[1]}, velocity(g.a), velocity(g.b));
  // The point on the candidate a: from the foot on a wall, or from the middle of two centres.
  const double distance = wall ? g.gap : (g.gap + system.radius[at(g.b)] - system.radius[at(g.a)]) / 2;
  const double h = first_.dynamics.time.step;
  const Place &a = places_[at(g.a)], &b = places_[at(g.b)];
  const bool of_boundary = wall || !system.free(g.a) || !system.free(g.b);
  return fmt::format(
      "$icdan  {}  {:7}\n cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus   iadj\n"
      " RBDY2  {:5}  DISKx  {:5}  {}  RBDY2  {:5}  {}  {:5}  {}  {:5}\n{}{}\n{}{}\n{}{}\n{}{}\n{}{}\n\n",
      wall ? "DKJCx" : "DKDKx", number, a.body, a.contactor,
      of_boundary ? datbox_law_of_boundaries : datbox_law_of_grains, b.body, wall ? "JONCx" : "DISKx", b.contactor,
      status_name(c.impulse, c.status), b.body, indent,
      datbox_named({{"rlt/H", -c.impulse.t / h}, {"rln/H", c.impulse.n / h}, {"rls/H", 0}}), indent,
      datbox_named({{"vlt =", -v.t}, {"vln =", v.n}, {"vls =", 0}}), indent, datbox_named({{"gapTT", g.gap}}), indent,
      datbox_named({{"n(1)=", -g.normal[0]}, {"n(2)=", -g.normal[1]}, {"n(3)=", 0}}), indent,
      datbox_named({{"coo1=", g.point[0] - distance * g.normal[0]},
                    {"coo2=", g.point[1] - distance * g.normal[1]},
                    {"coo3=", 0}}));
}

std::string DatboxWriter::vloc_rloc(const TrajectoryStep& step) const {
  std::string text = head("Vloc_Rloc", step.state);
  Index number = 0;
  for (const bool wall : {false, true}) {
    number = 0;
    for (const TrajectoryContact& c : step.contacts)
      if ((c.geometry.b >= first_.system.disks()) == wall) text += contact(step, c, ++number);
  }
  return text;
}

}  // namespace nscdd
