// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_sphere_writer.hpp"

#include "core/fail.hpp"
#include "formats/lmgc90/datbox_text.hpp"
#include "formats/lmgc90/datbox_writer.hpp"
#include "mechanics/contact_frame.hpp"

#include <numbers>

namespace nscdd {
namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;

constexpr const char* ruler = "!-----------------------------------------------------------------------\n";
const std::string indent(27, ' ');

Vector3 vector(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }
std::array<double, 3> numbers(const Vector3& a) { return {a[0], a[1], a[2]}; }
Vector3 spin_of(const RigidVelocity& v) { return {v.spin_x, v.spin_y, v.spin}; }
Vector3 place_of(const Pose& pose) { return {pose.x, pose.y, pose.z}; }

std::string head(const char* title, const GranularState& state) {
  return fmt::format("\n! {}\n\n$steps{:9}{:14}time={}\n\n{}", title, state.step, "", datbox_number(state.time), ruler);
}

// A line of three numbers behind 27 columns, with names such as coo1, coo2, coo3.
std::string three(const std::array<const char*, 3>& names, const Vector3& values) {
  return indent + datbox_named({{names[0], values[0]}, {names[1], values[1]}, {names[2], values[2]}}) + "\n";
}

// The first three numbers of a node stand beside its name.
std::string node(const std::array<const char*, 3>& names, const Vector3& values) {
  return " NO6xx      1" + three(names, values).substr(13);
}

constexpr std::array<const char*, 3> coo{"coo1=", "coo2=", "coo3="}, angles{"coo4=", "coo5=", "coo6="};

double volume_of(double radius) { return 4.0 / 3 * std::numbers::pi * radius * radius * radius; }

// The tangent that LMGC90 takes for two spheres, which its impulses t and s go with. (Where exactly one component of
// the normal is 0 its formula is not orthogonal to the normal: another one stands here.)
Vector3 tangent_of(const Vector3& n) {
  const Index zeros = (n.array() == 0).count();
  if (zeros == 2) return {n[2], n[0], n[1]};
  if (zeros == 1) return vector(tangents_of(numbers(n)).first);
  return Vector3(-n[1] * n[2], -n[2] * n[0], 2 * n[0] * n[1]).normalized();
}

const char* status_name(ContactStatus status) {
  return status == ContactStatus::open ? "noctc" : status == ContactStatus::stick ? "stick" : "slide";
}

}  // namespace

SphereDatboxWriter::SphereDatboxWriter(const Simulation& first) : first_(first) {
  const GranularSystem& system = first_.system;
  const GranularState& state = first_.state;
  if (system.dimension != 3) fail("LMGC90: expected spheres in space, met disks in the plane");
  constexpr Index most = 99'999;  // their numbers have five columns
  if (const Index bodies = system.disks() + count(system.walls); bodies > most)
    fail("LMGC90: expected at most {} bodies, met {}", most, bodies);
  for (const Wall& wall : system.walls)
    if (wall.radius != 0)
      fail("LMGC90: boundary '{}': expected walls that are planes, met a cylinder, which is not written",
           system.boundaries[at(wall.boundary)].name);
  double mass = 0, volume = 0;
  Index free = 0, driven = system.free_disks();
  Vector3 low = Vector3::Constant(infinity), high = -low;
  margin_ = 0;
  for (std::size_t i = 0; i < system.radius.size(); ++i) {
    const bool is_free = system.driven_by[i] < 0;
    body_.push_back(is_free ? ++free : ++driven);
    margin_ = std::max(margin_, system.radius[i]);
    const Vector3 centre = vector(centre_of<3>(state, i));
    low = low.cwiseMin(centre);
    high = high.cwiseMax(centre);
    if (!is_free) continue;
    mass += system.mass[i];
    volume += volume_of(system.radius[i]);
  }
  density_ = mass / volume;
  for (std::size_t w = 0; w < system.walls.size(); ++w) {
    const Wall& wall = system.walls[w];
    const Motion& motion = system.boundaries[at(wall.boundary)].motion;
    Plank plank{.body = system.disks() + static_cast<Index>(w) + 1};
    const Vector3 normal = vector(wall.normal), along = vector(tangents_of(wall.normal).first).normalized();
    plank.frame << along, normal.cross(along), normal;
    plank.thickness = margin_;
    if (nscdd::turns(motion)) {
      // A wall that turns about a point on it is a plank so thin that its seven digits tell no difference.
      const double thin = 1e-7 * margin_, depth = (vector(wall.point) - vector(motion.centre)).dot(normal);
      plank.thickness = depth > -thin ? std::max(depth, thin) : 0;
    }
    planks_.push_back(plank);
    // Walls have no ends: a plank reaches beyond all spheres of the first step by the size of the packing.
    const Pose& pose = state.poses[at(wall.boundary)];
    const Matrix3 frame = frame_of(w, pose);
    const Vector3 middle = middle_of(w, pose);
    Vector3 from = Vector3::Constant(infinity), to = -from;
    for (std::size_t i = 0; i < system.radius.size(); ++i) {
      const Vector3 place = frame.transpose() * (vector(centre_of<3>(state, i)) - middle);
      from = from.cwiseMin(place);
      to = to.cwiseMax(place);
    }
    Plank& laid = planks_.back();
    if (!nscdd::turns(motion)) {
      laid.shift_along = (from[0] + to[0]) / 2;
      laid.shift_across = (from[1] + to[1]) / 2;
    }
    const double beyond = (high - low).norm() + margin_;
    laid.length = std::max(std::abs(from[0] - laid.shift_along), std::abs(to[0] - laid.shift_along)) + beyond;
    laid.width = std::max(std::abs(from[1] - laid.shift_across), std::abs(to[1] - laid.shift_across)) + beyond;
  }
}

Matrix3 SphereDatboxWriter::frame_of(std::size_t wall, const Pose& pose) const {
  return pose.turn.toRotationMatrix() * planks_[wall].frame;
}

// A plank lies behind the face that is the wall. Where it turns its middle is the point that it turns about.
Vector3 SphereDatboxWriter::middle_of(std::size_t wall, const Pose& pose) const {
  const Wall& one = first_.system.walls[wall];
  const Motion& motion = first_.system.boundaries[at(one.boundary)].motion;
  if (nscdd::turns(motion)) return place_of(pose);
  const Plank& plank = planks_[wall];
  const Matrix3 frame = frame_of(wall, pose);
  return vector(moved<3>(one, motion, pose).point) +
         frame * Vector3(plank.shift_along, plank.shift_across, -plank.thickness);
}

std::string SphereDatboxWriter::bodies() const {
  const GranularSystem& system = first_.system;
  std::string text = "! File BODIES\n\n";
  const auto begin = [&](Index body, double average, const Vector3& inertia, const Vector3& place) {
    text += fmt::format("$bdyty\n RBDY3  {:7}\n$blmty\n PLAIN      1  behav  {}{}\n", body, datbox_grains,
                        datbox_named({{"avrd=", average}}));
    text += three({"I1  =", "I2  =", "I3  ="}, inertia) + "$nodty\n" + node(coo, place) + three(angles, {0, 0, 0});
  };
  std::vector<std::size_t> spheres(body_.size());  // in the order of their bodies
  for (std::size_t i = 0; i < body_.size(); ++i) spheres[at(body_[i] - 1)] = i;
  for (const std::size_t i : spheres) {
    const bool free = system.driven_by[i] < 0;
    const double radius = system.radius[i], volume = free ? system.mass[i] / density_ : volume_of(radius);
    begin(body_[i], std::cbrt(0.75 * volume / std::numbers::pi), Vector3::Constant(0.4 * radius * radius * volume),
          vector(centre_of<3>(first_.state, i)));
    text += fmt::format("$tacty\n SPHER      1  color  {}{}\n$$$$$$\n\n", free ? datbox_grains : datbox_boundaries,
                        datbox_named({{"byrd=", radius}}));
  }
  for (std::size_t w = 0; w < planks_.size(); ++w) {
    const Plank& plank = planks_[w];
    const Pose& pose = first_.state.poses[at(system.walls[w].boundary)];
    const Matrix3 frame = frame_of(w, pose);
    begin(plank.body, margin_, {0, 0, 0}, middle_of(w, pose));
    text += fmt::format("$tacty\n PLANx      1  color  {}", datbox_boundaries) +
            three({"axe1=", "axe2=", "axe3="}, {plank.length, plank.width, plank.thickness}).substr(27);
    text += fmt::format("{:29}localframe\n", "") + three({"alp1=", "alp2=", "alp3="}, frame.col(0)) +
            three({"bet1=", "bet2=", "bet3="}, frame.col(1)) + three({"gam1=", "gam2=", "gam3="}, frame.col(2)) +
            three(coo, {0, 0, 0}) + "$$$$$$\n\n";
  }
  return text;
}

std::string SphereDatboxWriter::bulk() const {
  const auto [x, y, z] = gravity_of<3>(first_.dynamics.time);
  return fmt::format("! File BEHAVIOUR\n\n$gravy\n{:17}{}\n\n$behav  lawty\n {}  {:30}{}\n", "",
                     datbox_named({{"grv1=", x}, {"grv2=", y}, {"grv3=", z}}), datbox_grains, "RIGID",
                     datbox_named({{"Umas=", density_}}));
}

std::string SphereDatboxWriter::dof(const TrajectoryStep& step) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  std::vector<std::string> texts(at(count_bodies()));
  const auto set = [&](Index body, const Vector3& moved, const Vector3& velocity, const Vector3& spin,
                       const Matrix3& frame) {
    texts[at(body - 1)] =
        fmt::format("$bdyty\n RBDY3  {:7}\n$nodty\n", body) + node({"X(1)=", "X(2)=", "X(3)="}, moved) +
        three({"X(4)=", "X(5)=", "X(6)="}, {0, 0, 0}) + three({"V(1)=", "V(2)=", "V(3)="}, velocity) +
        three({"V(4)=", "V(5)=", "V(6)="}, frame.transpose() * spin) +
        three({"a(1)=", "a(2)=", "a(3)="}, frame.col(0)) + three({"b(1)=", "b(2)=", "b(3)="}, frame.col(1)) +
        three({"g(1)=", "g(2)=", "g(3)="}, frame.col(2)) + "$$$$$$\n\n";
  };
  const std::vector<RigidVelocity> motions = boundary_velocities(system, state.time);
  for (std::size_t i = 0; i < body_.size(); ++i) {
    const Direction<3> centre = centre_of<3>(state, i);
    const Matrix3 frame =
        Eigen::Quaterniond(state.turn_w[i], state.turn_x[i], state.turn_y[i], state.turn_z[i]).toRotationMatrix();
    Vector3 velocity(state.velocity_x[i], state.velocity_y[i], state.velocity_z[i]);
    Vector3 spin(state.spin_x[i], state.spin_y[i], state.spin[i]);
    if (const Index b = system.driven_by[i]; b >= 0) {
      velocity = vector(velocity_of_point(motions[at(b)], state.poses[at(b)], centre));
      spin = system.boundaries[at(b)].orientation == Orientation::turning ? spin_of(motions[at(b)]) : Vector3::Zero();
    }
    set(body_[i], vector(centre) - vector(centre_of<3>(first_.state, i)), velocity, spin, frame);
  }
  for (std::size_t w = 0; w < planks_.size(); ++w) {
    const auto b = at(system.walls[w].boundary);
    const Vector3 now = middle_of(w, state.poses[b]);
    set(planks_[w].body, now - middle_of(w, first_.state.poses[b]),
        vector(velocity_of_point(motions[b], state.poses[b], Direction<3>(numbers(now)))), spin_of(motions[b]),
        frame_of(w, state.poses[b]));
  }
  std::string text = head("DOF", state);
  for (const std::string& one : texts) text += one;
  return text + ruler;
}

std::string SphereDatboxWriter::contact(const TrajectoryStep& step, const TrajectoryContact& c, Index number,
                                        bool wide) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  const StepContact& g = c.geometry;
  const bool wall = g.b >= system.disks();
  const std::size_t plank = wall ? at(g.b - system.disks()) : 0;
  const Vector3 towards_b = vector(g.normal), n = -towards_b;
  Vector3 t = tangent_of(n);
  if (wall) {  // the first axis of the plank, when the contact was found
    const Vector3 along = frame_of(plank, state.poses[at(system.walls[plank].boundary)]).col(0);
    t = (along - along.dot(n) * n).normalized();
  }
  const Vector3 s = t.cross(n);
  // Where the velocity of a body counts: its point at the contact.
  const std::vector<RigidVelocity> motions = boundary_velocities(system, state.time);
  const auto velocity = [&](Index body, double lever) -> Vector3 {
    if (body >= system.disks() || !system.free(body)) {
      const Index b = body >= system.disks() ? system.walls[plank].boundary : system.driven_by[at(body)];
      const Vector3 point = body >= system.disks() ? vector(g.point) : vector(centre_of<3>(state, at(body)));
      const bool turning = body >= system.disks() || system.boundaries[at(b)].orientation == Orientation::turning;
      const Vector3 moved = vector(velocity_of_point(motions[at(b)], state.poses[at(b)], Direction<3>(numbers(point))));
      if (body >= system.disks() || !turning) return moved;
      return moved + spin_of(motions[at(b)]).cross(lever * towards_b);
    }
    const auto i = at(body);
    return Vector3(state.velocity_x[i], state.velocity_y[i], state.velocity_z[i]) +
           Vector3(state.spin_x[i], state.spin_y[i], state.spin[i]).cross(lever * towards_b);
  };
  const double radius_a = system.radius[at(g.a)], radius_b = wall ? 0 : system.radius[at(g.b)];
  const Vector3 v = velocity(g.a, radius_a) - velocity(g.b, -radius_b);
  const Vector3 r = -vector(along_axes(g.normal, c.local<3>())) / first_.dynamics.time.step;  // on a
  // The middle between the two faces: from the foot on a wall, or from the middle of two centres.
  const Vector3 point = vector(g.point) + n * (wall ? 0.5 * g.gap : 0.5 * (radius_b - radius_a));
  const bool of_boundary = wall || !system.free(g.a) || !system.free(g.b);
  const Index body_a = body_[at(g.a)], body_b = wall ? planks_[plank].body : body_[at(g.b)];
  const int digits = wide ? 7 : 5;
  const std::string blanks(wide ? 4 : 2, ' ');
  std::string text =
      fmt::format("$icdan  {}  {:7}\n cdbdy{}numbr  cdtac{}numbr  CDVER  behav  anbdy{}numbr  antac{}numbr  sttus\n",
                  wall ? "SPPLx" : "SPSPx", number, blanks, blanks, blanks, blanks);
  text += fmt::format(" RBDY3  {:{}}  SPHER  {:{}}         {}  RBDY3  {:{}}  {}  {:{}}  {}", body_a, digits, 1, digits,
                      of_boundary ? datbox_law_of_boundaries : datbox_law_of_grains, body_b, digits,
                      wall ? "PLANx" : "SPHER", 1, digits, status_name(c.status));
  if (!wall) text += fmt::format("  {:{}}", body_b, digits);
  text += "\n" + three({"rls/H", "rlt/H", "rln/H"}, {r.dot(s), r.dot(t), r.dot(n)}) +
          three({"vls =", "vlt =", "vln ="}, {v.dot(s), v.dot(t), v.dot(n)}) + indent +
          datbox_named({{"gTT =", g.gap}}) + "\n" + three({"s(1)=", "s(2)=", "s(3)="}, s) +
          three({"t(1)=", "t(2)=", "t(3)="}, t) + three({"n(1)=", "n(2)=", "n(3)="}, n) + three(coo, point) + "\n";
  return text;
}

std::string SphereDatboxWriter::vloc_rloc(const TrajectoryStep& step) const {
  std::string text = head("Vloc_Rloc", step.state);
  const auto of_wall = [&](const TrajectoryContact& c) { return c.geometry.b >= first_.system.disks(); };
  // Beyond so many contacts LMGC90 has wider columns for those of two spheres.
  constexpr Index most = 99'999;
  const bool wide = count(step.contacts) - std::ranges::count_if(step.contacts, of_wall) > most;
  for (const bool wall : {false, true}) {
    Index number = 0;
    for (const TrajectoryContact& c : step.contacts)
      if (of_wall(c) == wall) text += contact(step, c, ++number, wide && !wall);
  }
  return text;
}

std::string SphereDatboxWriter::without_datbox() const {
  const GranularSystem& system = first_.system;
  if (const std::string reason = without_datbox_law(first_.dynamics.interaction); !reason.empty()) return reason;
  for (const Index b : system.driven_by)
    if (b >= 0 && nscdd::turns(system.boundaries[at(b)].motion))
      return fmt::format("boundary '{}': expected spheres of boundaries that do not turn",
                         system.boundaries[at(b)].name);
  for (std::size_t w = 0; w < planks_.size(); ++w) {
    const Boundary& boundary = system.boundaries[at(system.walls[w].boundary)];
    if (!nscdd::turns(boundary.motion)) continue;
    if (!(planks_[w].thickness > 0))
      return fmt::format("boundary '{}': expected a wall that turns about a point on it or behind it, as a plank does",
                         boundary.name);
    // Spins are along the axes of the plank, which turn with it, but for that about which it turns.
    const Vector3 first = spin_of(*std::ranges::max_element(boundary.motion.velocity, {},
                                                            [](const RigidVelocity& v) { return spin_of(v).norm(); }));
    for (const RigidVelocity& v : boundary.motion.velocity)
      if (first.cross(spin_of(v)).norm() > 1e-12 * first.squaredNorm())
        return fmt::format("boundary '{}': expected a wall that turns about one axis", boundary.name);
  }
  return {};
}

std::string SphereDatboxWriter::tact() const {
  const double alert = first_.dynamics.time.alert * *std::ranges::min_element(first_.system.radius);
  std::string text = "! File TACT_BEHAV\n\n" + datbox_law_texts(first_.dynamics.interaction);
  text += datbox_sight("RBDY3", "SPHER", datbox_law_of_grains, "SPHER", datbox_grains, alert);
  text += datbox_sight("RBDY3", "SPHER", datbox_law_of_boundaries, "SPHER", datbox_boundaries, alert);
  return text + datbox_sight("RBDY3", "SPHER", datbox_law_of_boundaries, "PLANx", datbox_boundaries, alert);
}

std::vector<DatboxDriven> SphereDatboxWriter::driven_bodies() const {
  const GranularSystem& system = first_.system;
  std::vector<DatboxDriven> all;
  const auto add = [&](Index body, Index boundary, const Matrix3& frame) {
    const Motion& motion = system.boundaries[at(boundary)].motion;
    DatboxDriven one{body, motion.time, std::vector<std::vector<double>>(6)};
    for (const RigidVelocity& v : motion.velocity.empty() ? std::vector<RigidVelocity>{{}} : motion.velocity) {
      const Vector3 spin = frame.transpose() * spin_of(v);
      const std::array<double, 6> components{v.x, v.y, v.z, spin[0], spin[1], spin[2]};
      for (std::size_t k = 0; k < 6; ++k) one.velocity[k].push_back(components[k]);
    }
    all.push_back(std::move(one));
  };
  for (std::size_t i = 0; i < body_.size(); ++i)
    if (system.driven_by[i] >= 0) add(body_[i], system.driven_by[i], Matrix3::Identity());
  for (std::size_t w = 0; w < planks_.size(); ++w) {
    const Index b = system.walls[w].boundary;
    add(planks_[w].body, b, frame_of(w, first_.state.poses[at(b)]));
  }
  return all;
}

std::string SphereDatboxWriter::driven() const { return datbox_driven_text("RBDY3", "NO6xx", driven_bodies()); }

std::vector<std::pair<std::string, std::string>> SphereDatboxWriter::tables() const {
  return datbox_tables(driven_bodies());
}

}  // namespace nscdd
