// SPDX-License-Identifier: GPL-3.0-or-later
// Boundaries of a DATBOX: all bodies but free grains.
#include "formats/lmgc90/datbox.hpp"

#include <numbers>
#include <set>

namespace nscdd {
namespace {

// The velocity (m/s or rad/s) of a degree of freedom over time (s): linear between points, constant beyond.
using Course = std::vector<std::array<double, 2>>;

double value_at(const Course& course, double t) {
  if (t <= course.front()[0]) return course.front()[1];
  const auto to = std::ranges::find_if(course, [=](const auto& point) { return t <= point[0]; });
  if (to == course.end()) return course.back()[1];
  const auto& from = *(to - 1);
  return std::lerp(from[1], (*to)[1], (t - from[0]) / ((*to)[0] - from[0]));
}

// [CT + AMP cos(PHI)] min(1, RAMPI + RAMP t), the formula but for what oscillates.
Course formula_of(const DatboxDrive& drive, double start) {
  if (drive.rate < 0) refuse(drive.place, "RAMP: expected 0 or more, met {}", drive.rate);
  const double full = drive.constant + (drive.omega == 0 ? drive.amplitude * std::cos(drive.phase) : 0);
  const double initial = std::min(1.0, drive.initial + drive.rate * start);
  Course course(1, {0, full * initial});
  if (full != 0 && drive.rate > 0 && initial < 1) course.push_back({(1 - initial) / drive.rate, full});
  return course;
}

// A table is extrapolated linearly beyond its ends: by points so far away that no run reaches them.
Course table_of(const DatboxDrive& drive, double start) {
  constexpr double far = 1e6;  // times the span of the table
  const auto& rows = drive.table;
  const double span = rows.back()[0] - rows.front()[0];
  const auto beyond = [](const std::array<double, 2>& a, const std::array<double, 2>& b, double t) {
    return std::array<double, 2>{t, a[1] + (b[1] - a[1]) * ((t - a[0]) / (b[0] - a[0]))};
  };
  Course course = rows;
  if (rows[0][1] != rows[1][1]) course.insert(course.begin(), beyond(rows[0], rows[1], rows[0][0] - far * span));
  if (rows.back()[1] != rows[rows.size() - 2][1])
    course.push_back(beyond(rows[rows.size() - 2], rows.back(), rows.back()[0] + far * span));
  for (auto& point : course) point[0] -= start;
  return course;
}

// The velocity of a body with these degrees of freedom. Spins in space are along axes of the body, which are those of
// the beginning only if it turns about one `axis`. Null for its loads: moments are along its axes, too.
RigidVelocity velocity_of(const DatboxBody& body, Index dimension, const std::array<double, 6>& v, Vector3* axis) {
  if (dimension == 2) return {v[0], v[1], v[2]};
  if (axis == nullptr) return {v[0], v[1], v[5], v[2], v[3], v[4]};
  const Vector3 own(v[3], v[4], v[5]), spin = body.frame * own;
  if (axis->isZero(0)) *axis = own;
  if (axis->cross(own).norm() > 1e-5 * axis->norm() * own.norm())
    refuse(body.place, "expected a body that turns about one axis, met one that does not: not modelled");
  return {v[0], v[1], spin[2], v[2], spin[0], spin[1]};
}

// Oscillations of one frequency, phase and ramp are one.
void add_oscillation(Motion& motion, const DatboxDrive& drive, double start, const RigidVelocity& amplitude) {
  const double ramp = drive.initial + drive.rate * start;
  if (drive.rate < 0 || ramp < 0)
    refuse(drive.place, "RAMPI, RAMP: expected numbers >= 0 for an oscillation, met {} and {}", drive.initial,
           drive.rate);
  Oscillation one{amplitude, drive.omega, drive.phase + drive.omega * start, std::min(1.0, ramp),
                  ramp < 1 ? drive.rate : 0};
  const auto time_of = [](const Oscillation& o) { return std::tuple(o.omega, o.phase, o.ramp, o.growth); };
  const auto same = std::ranges::find(motion.oscillations, time_of(one), time_of);
  if (same == motion.oscillations.end()) return motion.oscillations.push_back(one);
  same->amplitude = sum(same->amplitude, 1, amplitude);
}

using Drives = std::array<std::optional<DatboxDrive>, 6>;

// The function of time of some drives, 0 along the others.
void add_functions(const DatboxBody& body, const Drives& drives, double start, Index dimension, Motion& motion) {
  std::array<Course, 6> courses;
  std::set<double> times;
  Vector3 first = Vector3::Zero();
  Vector3* const axis = &drives == &body.forces ? nullptr : &first;
  for (std::size_t k = 0; k < drives.size(); ++k) {
    courses[k] = {{0, 0}};
    if (!drives[k]) continue;
    const DatboxDrive& drive = *drives[k];
    courses[k] = drive.table.empty() ? formula_of(drive, start) : table_of(drive, start);
    for (const auto& point : courses[k]) times.insert(point[0]);
    if (drive.amplitude == 0 || drive.omega == 0) continue;
    std::array<double, 6> amplitude{};
    amplitude[k] = drive.amplitude;
    add_oscillation(motion, drive, start, velocity_of(body, dimension, amplitude, axis));
  }
  for (const double t : times) {
    motion.time.push_back(t);
    std::array<double, 6> v{};
    for (std::size_t k = 0; k < v.size(); ++k) v[k] = value_at(courses[k], t);
    motion.velocity.push_back(velocity_of(body, dimension, v, axis));
  }
}

// The motion of a body along its driven degrees of freedom, `start` after the origin of the time of its drives, s.
// Throws Error for a driven body that turns about more than one axis.
Motion datbox_motion(const DatboxBody& body, double start, Index dimension) {
  Motion motion;
  motion.centre = {body.position[0], body.position[1], dimension == 3 ? body.position[2] : 0};
  require_known_axes(body);
  const Vector3 spin = body.frame * body.spin, &v0 = body.velocity;
  motion.initial = dimension == 2 ? RigidVelocity{v0[0], v0[1], v0[2]}
                                  : RigidVelocity{v0[0], v0[1], spin[2], v0[2], spin[0], spin[1]};
  add_functions(body, body.drives, start, dimension, motion);
  return motion;
}

// A hollow cylinder has no ends here. LMGC90 has contacts at wrong distances beyond the ends of a DNLYC.
void set_wall(const DatboxBody& body, const DatboxContactor& shape, bool space, BoundarySpec& wall) {
  const Vector3 middle = body.place_of(shape, space);
  const Matrix3 frame = body.frame * shape.frame;
  const double angle = body.position[2];
  const bool round = shape.radius > 0;
  wall.shape = round ? BoundaryShape::cylinder : BoundaryShape::plank;
  wall.radius = round ? shape.radius : shape.thickness;
  if (round) {
    wall.ends = shape.wall == "CYLND";
    wall.side = wall.ends ? CylinderSide::outside : CylinderSide::inside;
  }
  if (round || !space) {
    const Vector3 along = space ? Vector3(frame.col(2)) : Vector3(std::cos(angle), std::sin(angle), 0);
    Vector3::Map(wall.from.data()) = middle - shape.length * along;
    Vector3::Map(wall.to.data()) = middle + shape.length * along;
    return;
  }
  Vector3::Map(wall.point.data()) = middle;
  Vector3::Map(wall.axis.data()) = frame.col(0);
  Vector3::Map(wall.normal.data()) = frame.col(2);
  wall.length = 2 * shape.length;
  wall.width = 2 * shape.width;
}

// The shapes of a body whose first disk or sphere has number `first` in the packing: these, then its walls.
void add_shapes(const DatboxBody& body, bool space, Index first, BoundarySpec boundary,
                std::vector<BoundarySpec>& boundaries) {
  BoundarySpec part;
  part.name = boundary.name;
  part.part = true;
  part.dimension = boundary.dimension;
  const auto add = [&](const auto& set) { set(boundaries.emplace_back(std::exchange(boundary, part))); };
  if (const Index grains = body.grains(); grains > 0)
    add([&](BoundarySpec& spec) {
      spec.shape = BoundaryShape::grains;
      spec.first = first;
      spec.last = first + grains - 1;
    });
  for (const DatboxContactor& shape : body.contactors)
    if (!shape.wall.empty()) add([&](BoundarySpec& spec) { set_wall(body, shape, space, spec); });
}

// The colour of its walls, or that of its first grain.
std::string colour_of_boundary(const Datbox& datbox, const DatboxBody& body) {
  const DatboxContactor* wall = nullptr;
  for (const DatboxContactor& one : body.contactors) {
    if (one.wall.empty()) continue;
    if (wall != nullptr && colour_of(datbox, *wall) != colour_of(datbox, one))
      refuse(one.place, "expected one kind and colour of all walls of a body, {} as before, met {}",
             colour_of(datbox, *wall), colour_of(datbox, one));
    wall = &one;
  }
  return colour_of(datbox, wall != nullptr ? *wall : body.contactors[0]);
}

void require_one_drive(const DatboxBody& body) {
  for (std::size_t k = 0; k < body.drives.size(); ++k)
    if (body.drives[k] && body.forces[k])
      refuse(body.forces[k]->place, "expected a velocity or a force of degree of freedom {}, met both", k + 1);
}

// What moves a body along the degrees of freedom that are not driven.
FreeBody free_body(const Datbox& datbox, const DatboxBody& body) {
  const bool space = datbox.space();
  FreeBody result;
  const double density = density_of(datbox, body), radius = body.average_radius, gyration = body.gyration_radius;
  result.mass = density * std::numbers::pi * (space ? 4.0 / 3 * radius : 1) * radius * radius;
  result.inertia = {density * body.inertia[0], density * body.inertia[1], density * body.inertia[2]};
  if (!space) result.inertia[2] = result.mass * gyration * gyration;
  bool turns = false;
  for (std::size_t k = 0; k < (space ? 6 : 3); ++k) {
    if (body.drives[k]) continue;
    const bool spin = k >= at(datbox.dimension);
    turns = turns || spin;
    result.directions[space ? k : spin ? 5 : k] = true;
    result.torque_turns |= space && spin && body.forces[k] && !body.forces[k]->none();
  }
  const bool inertia = std::ranges::all_of(space ? std::span(result.inertia) : std::span(result.inertia).last(1),
                                           [](double one) { return one > 0; });
  if (!(result.mass > 0) || (turns && !inertia))
    refuse(body.place,
           "avrd and {}: expected numbers above 0 of a body that is not driven, met 0, which is computed of "
           "disks, spheres and planks, and of cylinders in space",
           space ? "I1 to I3" : "gyrd");
  if (space && turns) result.axes = Eigen::Quaterniond(body.frame).normalized();
  add_functions(body, body.forces, datbox.start, datbox.dimension, result.load);
  return result;
}

// The boundary from which free grains come one by one, that of body `first` on.
void add_source(const Datbox& datbox, std::vector<BoundarySpec>& boundaries) {
  const DatboxSource& source = *datbox.command.source;
  Index grains = 0, first = -1;
  for (Index k = 0; k < count(datbox.bodies); ++k) {
    const DatboxBody& body = datbox.bodies[at(k)];
    if (k + 1 >= source.first && !is_free_grain(body, datbox.space()))
      refuse(body.place, "expected a free {} as the source point of {}:{} releases, met another body",
             shape_of_grains(datbox.dimension), source.place.file, source.place.line);
    if (k + 1 == source.first) first = grains;
    grains += body.grains();
  }
  if (first < 0)
    refuse(source.place, "expected a source point of one of the {} bodies, met body {}", datbox.bodies.size(),
           source.first);
  BoundarySpec& boundary = boundaries.emplace_back();
  boundary.name = "source";
  boundary.dimension = datbox.dimension;
  boundary.shape = BoundaryShape::grains;
  boundary.first = first;
  boundary.last = grains - 1;
  boundary.source = source.at;
}

}  // namespace

void require_known_axes(const DatboxBody& body) {
  const auto turns = [](const auto& drive) { return drive && !drive->none(); };
  const auto spins = std::span(body.drives).last(3);
  const auto driven = std::ranges::count_if(spins, [](const auto& drive) { return drive.has_value(); });
  if (body.own_axes && (body.read_axes || !body.spin.isZero(0) || driven % 3 > 0 || std::ranges::any_of(spins, turns) ||
                        std::ranges::any_of(std::span(body.forces).last(3), turns)))
    refuse(body.place,
           "expected I1 to I3 of a body with several contactors that turns, has a moment or axes of its own, or is "
           "driven in one or two rotations, met 0: LMGC90 takes its principal axes, which are in no file");
}

std::vector<BoundarySpec> boundaries_of_datbox(const Datbox& datbox, bool coloured) {
  std::vector<BoundarySpec> boundaries;
  Index grains = 0;
  for (std::size_t k = 0; k < datbox.bodies.size(); ++k) {
    const DatboxBody& body = datbox.bodies[k];
    const Index first = std::exchange(grains, grains + body.grains());
    if (is_free_grain(body, datbox.space())) continue;
    BoundarySpec boundary;
    boundary.name = fmt::format("body {}", k + 1);
    boundary.dimension = datbox.dimension;
    boundary.colour = coloured ? colour_of_boundary(datbox, body) : "";
    boundary.motion = datbox_motion(body, datbox.start, datbox.dimension);
    require_one_drive(body);
    if (!body.fully_driven(datbox.dimension)) boundary.body = free_body(datbox, body);
    add_shapes(body, datbox.space(), first, std::move(boundary), boundaries);
  }
  if (datbox.command.source) add_source(datbox, boundaries);
  return boundaries;
}

}  // namespace nscdd
