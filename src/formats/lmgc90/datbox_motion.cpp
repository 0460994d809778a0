// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/lmgc90/datbox.hpp"

#include <set>

namespace nscdd {
namespace {

using Vector3 = Eigen::Vector3d;

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
// the beginning only if it turns about one `axis`.
RigidVelocity velocity_of(const DatboxBody& body, Index dimension, const std::array<double, 6>& v, Vector3& axis) {
  if (dimension == 2) return {v[0], v[1], v[2]};
  const Vector3 own(v[3], v[4], v[5]), spin = body.frame * own;
  if (axis.isZero(0)) axis = own;
  if (axis.cross(own).norm() > 1e-5 * axis.norm() * own.norm())
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
  const std::size_t dofs = dimension == 2 ? 3 : 6;
  std::array<Course, 6> courses;
  std::set<double> times;
  Vector3 axis = Vector3::Zero();
  for (std::size_t k = 0; k < dofs; ++k) {
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
    for (std::size_t k = 0; k < dofs; ++k) v[k] = value_at(courses[k], t);
    motion.velocity.push_back(velocity_of(body, dimension, v, axis));
  }
}

}  // namespace

Motion datbox_motion(const DatboxBody& body, double start, Index dimension) {
  Motion motion;
  motion.centre = {body.position[0], body.position[1], dimension == 3 ? body.position[2] : 0};
  const auto turns = [](const auto& drive) { return drive && !drive->none(); };
  if (dimension == 3 && body.contactors.size() > 1 && body.own_axes &&
      (body.read_axes || !body.spin.isZero(0) || std::any_of(body.drives.begin() + 3, body.drives.end(), turns)) &&
      body.fully_driven(dimension))
    refuse(body.place,
           "expected I1 to I3 of a cluster that turns or has axes of its own, met 0: LMGC90 takes its principal axes, "
           "which are in no file");
  const Vector3 spin = body.frame * body.spin, &v0 = body.velocity;
  motion.initial = dimension == 2 ? RigidVelocity{v0[0], v0[1], v0[2]}
                                  : RigidVelocity{v0[0], v0[1], spin[2], v0[2], spin[0], spin[1]};
  add_functions(body, body.drives, start, dimension, motion);
  return motion;
}

Motion datbox_load(const DatboxBody& body, double start, Index dimension) {
  Motion load;
  add_functions(body, body.forces, start, dimension, load);
  return load;
}

}  // namespace nscdd
