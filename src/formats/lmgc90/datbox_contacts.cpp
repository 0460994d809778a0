// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox_writer.hpp"
#include "mechanics/contact_frame.hpp"

namespace nscdd {
namespace {

const char* status_name(ContactStatus status, const char* sliding) {
  return status == ContactStatus::open ? "noctc" : status == ContactStatus::stick ? "stick" : sliding;
}

// The tangent of LMGC90 for two spheres, or ours if one component of the normal is 0: its own is not orthogonal then.
Vector3 tangent_of(const Vector3& n) {
  const Index zeros = (n.array() == 0).count();
  if (zeros == 2) return {n[2], n[0], n[1]};
  if (zeros == 1) return datbox_vector(tangents_of({n[0], n[1], n[2]}).first);
  return Vector3(-n[1] * n[2], -n[2] * n[0], 2 * n[0] * n[1]).normalized();
}

}  // namespace

std::string DatboxWriter::disk_contact(const TrajectoryStep& step, const TrajectoryContact& c, WallKind kind,
                                       Index number) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  const StepContact& g = c.geometry;
  const bool wall = g.b >= system.grains();
  const auto velocity = [&](Index body) -> GrainVelocity<2> {
    if (body < system.grains())
      return {state.velocity_x[at(body)], state.velocity_y[at(body)], system.radius[at(body)] * state.spin[at(body)]};
    const Index boundary = system.walls[at(body - system.grains())].boundary;
    const RigidVelocity rigid = boundary_velocities(system, state, state.time)[at(boundary)];
    const auto v = velocity_of_point(rigid, state.poses[at(boundary)], g.point);
    return {v[0], v[1], 0};
  };
  const LocalVector<2> v = relative_velocity(Direction<2>{g.normal[0], g.normal[1]}, velocity(g.a), velocity(g.b));
  // To the point on the candidate a, from the foot on a wall or the middle of two centres.
  const double distance = wall ? g.gap : (g.gap + system.radius[at(g.b)] - system.radius[at(g.a)]) / 2;
  const double h = first_.dynamics.time.step;
  const Place &a = places_[at(g.a)], &b = places_[at(g.b)];
  const bool of_boundary = system.is_boundary(g.a) || system.is_boundary(g.b);
  // LMGC90's tangential impulse has the other sign.
  const char* status = status_name(c.status, c.impulse.t > 0 ? "slifw" : "slibw");
  return fmt::format(
             "$icdan  {}  {:7}\n cdbdy  numbr  cdtac  numbr  behav  anbdy  numbr  antac  numbr  sttus   iadj\n"
             " RBDY2  {:5}  DISKx  {:5}  {}  RBDY2  {:5}  {}  {:5}  {}  {:5}\n",
             kind.contact, number, a.body, a.contactor, of_boundary ? datbox_law_of_boundaries : datbox_law_of_grains,
             b.body, kind.contactor, b.contactor, status, b.body) +
         datbox_line({{"rlt/H", -c.impulse.t / h}, {"rln/H", c.impulse.n / h}, {"rls/H", 0}}) +
         datbox_line({{"vlt =", -v.t}, {"vln =", v.n}, {"vls =", 0}}) + datbox_line({{"gapTT", g.gap}}) +
         datbox_three("n({})=", {-g.normal[0], -g.normal[1], 0}) +
         datbox_three("coo{}=", {g.point[0] - distance * g.normal[0], g.point[1] - distance * g.normal[1], 0}) + "\n";
}

std::string DatboxWriter::sphere_contact(const TrajectoryStep& step, const TrajectoryContact& c, WallKind kind,
                                         Index number, bool wide) const {
  const GranularSystem& system = first_.system;
  const GranularState& state = step.state;
  const StepContact& g = c.geometry;
  const bool wall = g.b >= system.grains();
  const std::size_t plank = wall ? at(g.b - system.grains()) : 0;
  const Vector3 towards_b = datbox_vector(g.normal), n = -towards_b;
  Vector3 t = tangent_of(n);
  const bool round = wall && system.walls[plank].round();
  if (wall && !round) {  // the first axis of the plank, when the contact was found
    const Vector3 along = plank_node(plank, state.poses[at(system.walls[plank].boundary)]).frame.col(0);
    t = (along - along.dot(n) * n).normalized();
  }
  const Vector3 s = round ? n.cross(t) : t.cross(n);  // as the sources of LMGC90 have them
  const std::vector<RigidVelocity> motions = boundary_velocities(system, state, state.time);
  const auto velocity = [&](Index body, double lever) -> Vector3 {
    const auto i = at(body);
    const bool on_wall = body >= system.grains();
    if (!on_wall && system.free(body))
      return Vector3(state.velocity_x[i], state.velocity_y[i], state.velocity_z[i]) +
             Vector3(state.spin_x[i], state.spin_y[i], state.spin[i]).cross(lever * towards_b);
    const auto k = at(on_wall ? system.walls[plank].boundary : system.driven_by[i]);
    const Vector3 moved =
        datbox_vector(velocity_of_point(motions[k], state.poses[k], on_wall ? g.point : centre_of(state, i)));
    if (on_wall || system.boundaries[k].orientation != Orientation::turning) return moved;
    return moved + spin_vector(motions[k]).cross(lever * towards_b);
  };
  const double radius_a = system.radius[at(g.a)], radius_b = wall ? 0 : system.radius[at(g.b)];
  const Vector3 v = velocity(g.a, radius_a) - velocity(g.b, -radius_b);
  const Vector3 r = -datbox_vector(along_axes(g.normal, c.local<3>())) / first_.dynamics.time.step;  // on a
  // The middle between the surfaces, from the foot on a wall or the middle of two centres; at a cylinder the sphere's.
  const Vector3 point = datbox_vector(g.point) + n * (round ? g.gap : wall ? g.gap / 2 : (radius_b - radius_a) / 2);
  const bool of_boundary = system.is_boundary(g.a) || system.is_boundary(g.b);
  const Place &a = places_[at(g.a)], &b = places_[at(g.b)];
  const int digits = wide ? 7 : 5;
  const std::string blanks(wide ? 4 : 2, ' ');
  std::string text =
      fmt::format("$icdan  {}  {:7}\n cdbdy{}numbr  cdtac{}numbr  CDVER  behav  anbdy{}numbr  antac{}numbr  sttus\n",
                  kind.contact, number, blanks, blanks, blanks, blanks);
  text += fmt::format(" RBDY3  {:{}}  SPHER  {:{}}         {}  RBDY3  {:{}}  {}  {:{}}  {}", a.body, digits,
                      a.contactor, digits, of_boundary ? datbox_law_of_boundaries : datbox_law_of_grains, b.body,
                      digits, kind.contactor, b.contactor, digits, status_name(c.status, "slide"));
  if (!wall) text += fmt::format("  {:{}}", b.body, digits);
  text += "\n" + datbox_line({{"rls/H", r.dot(s)}, {"rlt/H", r.dot(t)}, {"rln/H", r.dot(n)}}) +
          datbox_line({{"vls =", v.dot(s)}, {"vlt =", v.dot(t)}, {"vln =", v.dot(n)}}) +
          datbox_line({{"gTT =", g.gap}}) + (round ? "" : datbox_three("s({})=", s)) + datbox_three("t({})=", t) +
          datbox_three("n({})=", n) + (round ? datbox_three("s({})=", s) : "") + datbox_three("coo{}=", point) + "\n";
  return text;
}

std::string DatboxWriter::vloc_rloc(const TrajectoryStep& step) const {
  std::string text = datbox_head("Vloc_Rloc", step.state.step, step.state.time);
  const auto at_wall = [&](const TrajectoryContact& c) { return c.geometry.b >= first_.system.grains(); };
  constexpr Index most = 99'999;  // contacts of two spheres for which LMGC90 has narrow columns
  const bool wide = count(step.contacts) - std::ranges::count_if(step.contacts, at_wall) > most;
  std::vector<WallKind> kinds = wall_kinds();
  const WallKind of_grains = space_ ? WallKind{"SPHER", "SPSPx"} : WallKind{"DISKx", "DKDKx"};
  kinds.insert(kinds.begin(), of_grains);
  for (const WallKind& kind : kinds) {
    Index number = 0;
    for (const TrajectoryContact& c : step.contacts) {
      const WallKind own = at_wall(c) ? wall_kind(at(c.geometry.b - first_.system.grains())) : of_grains;
      if (own.contact == kind.contact)
        text += space_ ? sphere_contact(step, c, kind, ++number, wide && !at_wall(c))
                       : disk_contact(step, c, kind, ++number);
    }
  }
  return text;
}

}  // namespace nscdd
