// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/datbox_writer.hpp"

#include "core/fail.hpp"

#include <numbers>

namespace nscdd {
namespace {

using Named = std::initializer_list<std::pair<const char*, double>>;

// D14.7 of Fortran: 0.1234567D+01, with its sign or a blank before it.
std::string number(double value) {
  std::string text = fmt::format("{:.6e}", std::abs(value));  // 1.234567e+00
  const int exponent = value == 0 ? 0 : std::stoi(text.substr(text.find('e') + 1)) + 1;
  const std::string digits = text.substr(0, 1) + text.substr(2, 6);
  return fmt::format("{}0.{}{}{}{:02d}", std::signbit(value) && value != 0 ? '-' : ' ', digits,
                     std::abs(exponent) < 100 ? "D" : "", exponent < 0 ? '-' : '+', std::abs(exponent));
}

std::string named(Named values) {
  std::string text;
  for (const auto& [name, value] : values) text += fmt::format("  {:5}{}", name, number(value));
  return text;
}

constexpr const char* ruler = "!-----------------------------------------------------------------------\n";
const std::string indent(27, ' ');

std::string head(const char* title, const GranularState& state) {
  return fmt::format("\n! {}\n\n$steps{:9}{:14}time={}\n\n{}", title, state.step, "", number(state.time), ruler);
}

// The colour of a contactor: G of free grains, B of boundaries.
constexpr const char *grains = "GRAIN", *boundaries = "BOUND", *grain_bulk = "GRAIN", *law = "CLB__";

const char* status_name(LocalVector impulse, ContactStatus status) {
  if (status == ContactStatus::open) return "noctc";
  if (status == ContactStatus::stick) return "stick";
  return impulse.t > 0 ? "slifw" : "slibw";  // LMGC90's tangential impulse has the other sign
}

}  // namespace

DatboxWriter::DatboxWriter(const Simulation& first) : first_(first) {
  const GranularSystem& system = first_.system;
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
  for (std::size_t w = 0; w < system.walls.size(); ++w) {
    places_.push_back({body_of_boundary(system.walls[w].boundary), 1});
    wall_of_[at(system.walls[w].boundary)] = static_cast<Index>(w);
  }
  density_ = mass / area;
  thickness_ = largest;
  length_ = 2 * (highest - lowest) + largest;  // walls have no ends: a plank reaches beyond all that is there
}

// A plank lies behind the face that is the wall.
std::array<double, 3> DatboxWriter::position(Index boundary, const Pose& pose) const {
  const Index number = wall_of_[at(boundary)];
  if (number < 0) return {pose.x, pose.y, pose.angle};
  const Wall wall = moved(first_.system.walls[at(number)], first_.system.boundaries[at(boundary)].motion, pose);
  return {wall.point[0] - thickness_ * wall.normal[0], wall.point[1] - thickness_ * wall.normal[1],
          std::atan2(-wall.normal[0], wall.normal[1])};
}

std::string DatboxWriter::bodies() const {
  const GranularSystem& system = first_.system;
  const GranularState& state = first_.state;
  std::string text = "! File BODIES\n\n";
  const auto begin = [&](Index body, double average, double gyration, const std::array<double, 3>& place) {
    text +=
        fmt::format("$bdyty\n RBDY2{:7}\n$blmty\n PLAIN      1  behav  {}{}\n$nodty\n NO3xx      1{:14}{}\n$tacty\n",
                    body, grain_bulk, named({{"avrd=", average}, {"gyrd=", gyration}}), "",
                    named({{"coo1=", place[0]}, {"coo2=", place[1]}, {"coo3=", place[2]}}));
  };
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    if (!system.free(static_cast<Index>(i))) continue;
    const double radius = system.radius[i];
    begin(places_[i].body, std::sqrt(system.mass[i] / (density_ * std::numbers::pi)), radius / std::numbers::sqrt2,
          {state.x[i], state.y[i], 0});
    text += fmt::format(" DISKx      1  color  {}{}\n$$$$$$\n\n", grains, named({{"byrd=", radius}}));
  }
  for (Index b = 0; b < count(system.boundaries); ++b) {
    const std::array<double, 3> place = position(b, state.poses[at(b)]);
    begin(body_of_boundary(b), thickness_, thickness_, place);
    if (wall_of_[at(b)] >= 0)
      text +=
          fmt::format(" JONCx      1  color  {}{}\n", boundaries, named({{"ax1 =", length_}, {"ax2 =", thickness_}}));
    for (std::size_t i = 0; i < state.x.size(); ++i)
      if (system.driven_by[i] == b)
        text += fmt::format(" DISKb  {:5}  color  {}{}\n{}{}\n", places_[i].contactor, boundaries,
                            named({{"byrd=", system.radius[i]}}), indent,
                            named({{"coo1=", state.x[i] - place[0]}, {"coo2=", state.y[i] - place[1]}}));
    text += "$$$$$$\n\n";
  }
  return text;
}

std::string DatboxWriter::bulk() const {
  const auto& [x, y] = first_.dynamics.time.gravity;
  return fmt::format("! File BEHAVIOUR\n\n$gravy\n{:17}{}\n\n$behav  lawty\n {}  {:30}{}\n", "",
                     named({{"grv1=", x}, {"grv2=", y}, {"grv3=", 0}}), grain_bulk, "RIGID",
                     named({{"Umas=", density_}}));
}

std::string DatboxWriter::dof(const TrajectoryStep& step) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  std::string text = head("DOF", state);
  const auto add = [&](Index body, const std::array<double, 3>& x, const std::array<double, 3>& v) {
    text += fmt::format("$bdyty\n RBDY2  {:7}\n$nodty\n NO3xx      1{:14}{}\n{}{}\n$$$$$$\n\n", body, "",
                        named({{"X(1)=", x[0]}, {"X(2)=", x[1]}, {"X(3)=", x[2]}}), indent,
                        named({{"V(1)=", v[0]}, {"V(2)=", v[1]}, {"V(3)=", v[2]}}));
  };
  for (std::size_t i = 0; i < state.x.size(); ++i)
    if (system.free(static_cast<Index>(i)))
      add(places_[i].body, {state.x[i] - first_.state.x[i], state.y[i] - first_.state.y[i], state.angle[i]},
          {state.velocity_x[i], state.velocity_y[i], state.spin[i]});
  const std::vector<RigidVelocity> velocities = boundary_velocities(system, state.time);
  for (Index b = 0; b < count(system.boundaries); ++b) {
    const std::array<double, 3> start = position(b, first_.state.poses[at(b)]), now = position(b, state.poses[at(b)]);
    const std::array<double, 2> v = velocity_of_point(velocities[at(b)], state.poses[at(b)], {now[0], now[1]});
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
  const auto velocity = [&](Index body) -> DiskVelocity {
    if (body < system.disks())
      return {state.velocity_x[at(body)], state.velocity_y[at(body)], system.radius[at(body)] * state.spin[at(body)]};
    const Index boundary = system.walls[at(body - system.disks())].boundary;
    const RigidVelocity rigid = boundary_velocities(system, state.time)[at(boundary)];
    const std::array<double, 2> v = velocity_of_point(rigid, state.poses[at(boundary)], g.point);
    return {v[0], v[1], 0};
  };
  const std::array<DiskVelocity, 2> bodies{velocity(g.a), velocity(g.b)};
  const LocalVector v = relative_velocity({.a = 0, .b = 1, .normal = g.normal, .inverse_w = {}}, bodies);
  // The point on the candidate a: from the foot on a wall, or from the middle of two centres.
  const double distance = wall ? g.gap : (g.gap + system.radius[at(g.b)] - system.radius[at(g.a)]) / 2;
  const double h = first_.dynamics.time.step;
  const Place &a = places_[at(g.a)], &b = places_[at(g.b)];
  return fmt::format(
      "$icdan  {}  {:7}\n cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus   iadj\n"
      " RBDY2  {:5}  DISKx  {:5}  {}  RBDY2  {:5}  {}  {:5}  {}  {:5}\n{}{}\n{}{}\n{}{}\n{}{}\n{}{}\n\n",
      wall ? "DKJCx" : "DKDKx", number, a.body, a.contactor, law, b.body, wall ? "JONCx" : "DISKx", b.contactor,
      status_name(c.impulse, c.status), b.body, indent,
      named({{"rlt/H", -c.impulse.t / h}, {"rln/H", c.impulse.n / h}, {"rls/H", 0}}), indent,
      named({{"vlt =", -v.t}, {"vln =", v.n}, {"vls =", 0}}), indent, named({{"gapTT", g.gap}}), indent,
      named({{"n(1)=", -g.normal[0]}, {"n(2)=", -g.normal[1]}, {"n(3)=", 0}}), indent,
      named({{"coo1=", g.point[0] - distance * g.normal[0]},
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
